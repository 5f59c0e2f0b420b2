"""The bundled plans are cut into exactly the intended cells."""

import json
from pathlib import Path

import numpy as np
import pytest

from discretize import check_cells, convex_cells
from maps import read_plan

GRAPHS = Path(__file__).resolve().parents[3] / "shared" / "graphs"
HOUSE = [(1, 4), (1, 8), (2, 8), (2, 9), (3, 4), (4, 5), (4, 6), (4, 9), (5, 7), (6, 7)]


@pytest.fixture(params=["house", "museum", "office", "school"])
def cells(request):
    return convex_cells(read_plan(request.param))


def test_one_sound_cell_a_room(cells):
    report = check_cells(cells)
    assert report.problems == ()
    assert len(cells) == len(cells.plan.labels)
    assert len(cells.portals) == len(cells.plan.doors)
    assert (report.free_components, report.graph_components, report.pockets) == (1, 1, ())
    for label in cells.plan.labels:
        assert cells.locate(np.array([label.point]))[0] + 1 == label.number
    assert cells.names == tuple(label.name for label in sorted(cells.plan.labels, key=lambda x: x.number))


def edges(name: str) -> set[tuple[int, int]]:
    return {(a + 1, b + 1) for a, b in convex_cells(read_plan(name)).edges}


def test_house_is_the_graph_of_the_paper():
    assert edges("house") == set(HOUSE)


def test_office_is_the_published_graph_vertex_for_vertex():
    if not GRAPHS.is_dir():
        pytest.skip("no shared graphs beside the project")
    published = json.loads((GRAPHS / "office-60.json").read_text())["edges"]
    assert edges("office") == {(min(e) + 1, max(e) + 1) for e in published}


def test_office_is_believable():
    plan = read_plan("office")
    widths = np.array([door.length for door in plan.doors])
    assert set(np.round(widths, 2)) <= {0.9, 1.6}  # doors, and openings between pieces of hallway
    assert plan.start == (43, 44)
    cells = convex_cells(plan)
    hallways = [cell for cell, name in zip(cells.cells, cells.names, strict=True) if name == "hallway"]
    narrow = [min(x1 - x0, y1 - y0) for x0, y0, x1, y1 in (c.bounds for c in hallways)]
    assert len(hallways) == 16
    assert np.array(narrow) == pytest.approx(2.0, abs=0.1)


def test_museum_has_many_cycles():
    joined = edges("museum")
    galleries = {c for pair in joined for c in pair}
    assert len(galleries) >= 60
    assert len(joined) - len(galleries) + 1 >= 20


def test_school_is_a_tree_of_its_rooms():
    joined = edges("school")
    assert len(joined) == 11
    assert {(1, 2), (2, 11), (11, 12), (10, 12)} <= joined
