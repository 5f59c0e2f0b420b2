"""Numbers and names of cells."""

import pytest
import shapely

from discretize import check_cells, convex_cells
from discretize.numbering import ignored_numbers, number_cells
from maps import FloorPlan, Label

BOXES = {(i, j): shapely.box(2 * i, 2 * j, 2 * i + 2, 2 * j + 2) for i in range(3) for j in range(2)}
PAGE = [(0, 1), (1, 1), (2, 1), (0, 0), (1, 0), (2, 0)]


def test_reads_like_a_page_whatever_the_order():
    for order in (list(BOXES), list(BOXES)[::-1], sorted(BOXES, key=str)):
        cells, names = number_cells([BOXES[k] for k in order], ())
        assert [c.wkb for c in cells] == [BOXES[k].wkb for k in PAGE]
        assert names == ("",) * 6


def test_labels_number_and_name_cells():
    numbers = {key: n for n, key in enumerate(sorted(BOXES), 1)}
    labels = [Label((2 * i + 1, 2 * j + 1), f"room {i}{j}", numbers[i, j]) for i, j in BOXES]
    cells, names = number_cells(list(BOXES.values()), labels)
    assert [c.wkb for c in cells] == [BOXES[k].wkb for k in sorted(BOXES)]
    assert names == tuple(f"room {i}{j}" for i, j in sorted(BOXES))


def test_numbers_that_do_not_fit_do_not_count():
    missing = [Label((1, 1), "hall", 2)]
    twice = [Label((1, 1), number=n) for n in range(1, 7)]
    outside = [Label((2 * i + 1, 2 * j + 1), number=n) for n, (i, j) in enumerate([*PAGE[:5], (50, 50)], 1)]
    for labels in (missing, twice, outside):
        cells, _ = number_cells(list(BOXES.values()), labels)
        assert [c.wkb for c in cells] == [BOXES[k].wkb for k in PAGE]
    assert number_cells(list(BOXES.values()), missing)[1] == ("", "", "", "hall", "", "")


def test_label_outside_of_all_cells_names_none():
    labels = [Label((30, 30), "shed"), Label((6.001, 1), "porch")]
    cells, names = number_cells(list(BOXES.values()), labels)
    assert [(cell.bounds[:2], name) for cell, name in zip(cells, names, strict=True) if name] == [((4, 0), "porch")]


def test_label_close_to_a_boundary_names_its_own_cell():
    cells, names = number_cells(list(BOXES.values()), [Label((2.003, 1), "den")])
    assert [cell.bounds[:2] for cell, name in zip(cells, names, strict=True) if name] == [(2, 0)]


def test_rows_hold_cells_of_uneven_height():
    shapes = [shapely.box(0, 0, 3, 3.2), shapely.box(3, 0, 6, 3), shapely.box(6, 0, 9, 3.3), shapely.box(0, 4, 9, 7)]
    cells, _ = number_cells(shapes, ())
    assert [c.bounds[0] for c in cells] == [0, 0, 3, 6]


def test_cell_map_carries_numbers_and_names():
    space = shapely.box(0, 0, 8, 3)
    door = shapely.LineString([(4, 0), (4, 3)])
    labels = (Label((1, 1), "kitchen", 2), Label((6, 1), "hall", 1))
    cellmap = convex_cells(FloorPlan("flat", space, doors=(door,), labels=labels))
    assert cellmap.names == ("hall", "kitchen")
    assert cellmap.cells[0].bounds == (4, 0, 8, 3)
    assert check_cells(cellmap).notes == ()


@pytest.mark.parametrize(
    ("labels", "why"),
    [
        ([Label((1, 1), number=1), Label((6, 1), number=3)], "there are 2 cells, and the plan numbers 2 from 1 to 3"),
        ([Label((6, 1), number=1)], "there are 2 cells, and the plan numbers 1 from 1 to 1"),
        ([Label((1, 1), number=2), Label((2, 1), number=1)], "2 and 1 lie in one cell"),
    ],
)
def test_numbers_that_do_not_count_are_told(labels, why):
    space, door = shapely.box(0, 0, 8, 3), shapely.LineString([(4, 0), (4, 3)])
    cellmap = convex_cells(FloorPlan("flat", space, doors=(door,), labels=tuple(labels)))
    assert [cell.bounds[0] for cell in cellmap.cells] == [0, 4]
    assert check_cells(cellmap).notes == (f"Room numbers that the plan gives are not those of the cells: {why}.",)


def test_numbers_that_are_those_of_the_cells_anyway_need_no_word():
    space, door = shapely.box(0, 0, 8, 3), shapely.LineString([(4, 0), (4, 3)])
    labels = (Label((1, 1), number=1), Label((6, 1), "hall"))
    assert check_cells(convex_cells(FloorPlan("flat", space, doors=(door,), labels=labels))).notes == ()


def test_numbers_that_lie_in_no_cell_do_not_lie_in_one():
    cells = [shapely.box(0, 0, 4, 3), shapely.box(4, 0, 8, 3)]
    labels = [Label((20, 1), number=1), Label((30, 1), number=2)]
    (note,) = ignored_numbers(cells, labels)
    assert note.endswith("there are 2 cells, and the plan numbers 2 from 1 to 2.")
