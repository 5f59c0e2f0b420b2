"""Cells of any shape are parted where a body cannot cross them."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings

from discretize import check_cells, convex_cells, methods
from discretize.parting import part_cells
from discretize.partition import Partition
from discretize.reach import reach_of
from maps import FloorPlan
from tests.discretize.plans import on_grid, pixel_plans, two_halls

RADIUS = 0.2
NICHE = on_grid(
    shapely.union_all([shapely.box(0, 0, 6, 4), shapely.box(6, 1, 6.1, 1.3), shapely.box(6.1, 0.5, 7.3, 2)])
)
"""A room, and a closet behind a gap of 0.3 m."""


def places(cell, reach):
    """Connected places of a cell in which a body can be and hardly move at least."""
    return [p for p in shapely.get_parts(reach.within(cell)) if p.area > 0.05]


def test_closet_behind_a_narrow_gap_is_a_cell_of_its_own():
    pillar = shapely.box(2, 2, 2.5, 2.5)
    reach = reach_of(space := on_grid(NICHE.difference(pillar)), RADIUS)
    room, closet = part_cells([space], reach)
    assert len(room.interiors) == 1
    assert closet.area == pytest.approx(1.2 * 1.5, abs=0.05)


def test_cell_that_can_be_crossed_stays_as_it_is():
    assert part_cells([NICHE], reach_of(NICHE, 0.1)) == [NICHE]


def test_nook_goes_to_the_cell_from_which_a_body_gets_there():
    """A wall stub parts a nook from its own cell, but not from the next one."""
    space = on_grid(shapely.box(0, 0, 8, 4).difference(shapely.box(3.1, 0.95, 4, 1.05)))
    left = on_grid(shapely.box(0, 0, 8, 4).difference(shapely.box(3.9, 0, 8, 4)).intersection(space))
    cells = [left, on_grid(space.difference(left))]
    parted = part_cells(cells, reach_of(space, RADIUS))
    assert len(parted) == 2
    assert sum(cell.area for cell in parted) == pytest.approx(space.area)


@settings(max_examples=60, deadline=None)
@given(pixel_plans(pixel=0.45))
def test_every_piece_can_be_crossed(plan):
    reach = reach_of(plan.space, RADIUS)
    cells = part_cells(plan.parts, reach)
    assert all(cell.is_valid and cell.geom_type == "Polygon" for cell in cells)
    assert sum(cell.area for cell in cells) == pytest.approx(plan.area, rel=1e-9)
    assert shapely.union_all(np.array(cells)).area == pytest.approx(plan.area, rel=1e-9)
    assert all(len(places(cell, reach)) <= 1 for cell in cells)


def broken(_):
    raise shapely.errors.GEOSException("TopologyException: side location conflict")


def wanting(_):
    return Partition([shapely.box(0, 0, 1, 1)], 0.1)


@pytest.mark.parametrize(
    ("cut", "words"),
    [(broken, "side location conflict"), (wanting, "lie in no cell")],
)
def test_exact_cells_where_rooms_fail(monkeypatch, cut, words):
    monkeypatch.setattr(methods, "room_cells", cut)
    cellmap = convex_cells(two_halls())
    report = check_cells(cellmap)
    assert report.problems == ()
    assert report.convexity == pytest.approx(1)
    (note,) = report.notes
    assert note.startswith("Cells are those of the exact method")
    assert words in note


def test_graph_is_connected_as_the_free_space_is():
    hall = shapely.union(shapely.box(-0.1, 1, 0, 2), shapely.box(-4.1, 0, -0.1, 4))
    plan = FloorPlan("niche", on_grid(NICHE.union(hall)))
    report = check_cells(convex_cells(plan, radius=RADIUS))
    assert report.problems == ()
    assert report.free_components == report.graph_components == 2
