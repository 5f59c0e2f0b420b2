"""Strictly convex cells: cover, overlap, convexity and doors, on hostile plans."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from discretize import exact_cells
from maps import FloorPlan
from tests.discretize.plans import grid_of_rooms, pixel_plans, shard_plans, two_halls

SHAPES = {
    "square": shapely.box(0, 0, 4, 4),
    "collinear vertices": shapely.Polygon([(0, 0), (1, 0), (2, 0), (4, 0), (4, 2), (4, 4), (0, 4)]),
    "ring": shapely.box(0, 0, 4, 4).difference(shapely.box(1, 1, 3, 3)),
    "hole that touches the shell": shapely.Polygon(
        [(0, 0), (4, 0), (4, 4), (0, 4)], [[(0, 2), (1, 1), (2, 2), (1, 3)]]
    ),
    "holes that touch": shapely.Polygon(
        [(0, 0), (4, 0), (4, 4), (0, 4)], [[(1, 1), (2, 1), (2, 2), (1, 2)], [(2, 2), (3, 2), (3, 3), (2, 3)]]
    ),
    "two parts": shapely.MultiPolygon([shapely.box(0, 0, 1, 1), shapely.box(2, 0, 5, 1)]),
    "parts that touch": shapely.MultiPolygon([shapely.box(0, 0, 1, 1), shapely.box(1, 1, 2, 2)]),
    "sliver": shapely.Polygon([(0, 0), (50, 0), (50, 0.001)]),
    "far away": shapely.box(5e4, 5e4, 5e4 + 2, 5e4 + 2).difference(shapely.box(5e4 + 1, 5e4 + 1, 5e4 + 2, 5e4 + 2)),
}
REFLEX = {"square": 0, "collinear vertices": 0, "ring": 4, "two parts": 0, "sliver": 0, "far away": 1}


def check_partition(plan, cells):
    """Cells fill the plan once and are convex; sums of areas, no unions that could hide a gap behind a move."""
    shapes = np.array(cells)
    assert shapely.is_valid(shapes).all()
    assert shapely.area(shapes).sum() == pytest.approx(plan.area, rel=1e-9)
    i, j = shapely.STRtree(shapes).query(shapes, predicate="intersects")
    twice = shapely.area(shapely.intersection(shapes[i[i < j]], shapes[j[i < j]])).sum()
    assert twice <= 1e-9 * plan.area
    assert shapely.area(shapely.difference(shapes, plan.space)).sum() <= 1e-9 * plan.area
    hulls = shapely.area(shapely.convex_hull(shapes))
    assert (hulls - shapely.area(shapes) <= 1e-12 * np.maximum(hulls, 1.0)).all()


@pytest.mark.parametrize("name", SHAPES)
def test_covers_once_and_is_convex(name):
    plan = FloorPlan(name, SHAPES[name])
    cells = exact_cells(plan)
    check_partition(plan, cells)
    if name in REFLEX:
        parts = len(plan.parts)
        assert parts <= len(cells) <= parts + 2 * REFLEX[name]


@settings(max_examples=200, deadline=None)
@given(pixel_plans())
def test_bitmaps(plan):
    check_partition(plan, exact_cells(plan))


@settings(max_examples=200, deadline=None)
@given(shard_plans())
def test_shards_with_doors_anywhere(plan):
    check_partition(plan, exact_cells(plan))


@settings(max_examples=50, deadline=None)
@given(pixel_plans(), st.integers(0, 40), st.integers(-3000, 3000))
def test_same_after_renumbering_and_shifting(plan, turn, shift):
    def moved(ring):
        xy = shapely.get_coordinates(ring)[:-1]
        return np.roll(xy, turn % len(xy), axis=0) + shift

    parts = [
        shapely.Polygon(moved(p.exterior), [moved(r) for r in reversed(p.interiors)]) for p in reversed(plan.parts)
    ]
    other = FloorPlan("moved", shapely.MultiPolygon(parts))

    def shapes(cells, by):
        return {shapely.normalize(shapely.transform(c, lambda xy: np.round(xy - by, 6))).wkb for c in cells}

    assert shapes(exact_cells(plan), 0) == shapes(exact_cells(other), shift)


def test_no_cell_reaches_across_a_door():
    plan = grid_of_rooms(4, 3)
    cells = exact_cells(plan)
    check_partition(plan, cells)
    for door in plan.doors:
        assert not any(shapely.crosses(door, cell) or shapely.contains_properly(cell, door.centroid) for cell in cells)


def test_door_that_bridges_walls_without_parting_the_space():
    space = shapely.box(0, 0, 6, 6).difference(shapely.box(2, 2, 4, 4))
    door = shapely.LineString([(0, 3), (2, 3)])
    cells = exact_cells(FloorPlan("ring", space, doors=(door,)))
    check_partition(FloorPlan("ring", space), cells)
    assert not any(shapely.contains_properly(cell, door.centroid) for cell in cells)
    assert sum(cell.touches(door.centroid) for cell in cells) == 2


def test_rooms_that_touch_along_a_door_stay_whole():
    cells = exact_cells(two_halls())
    assert len(cells) == 2


@pytest.mark.parametrize("angle", [0.1, 0.7, 1.3])
def test_door_between_slanted_walls(angle):
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    space = shapely.transform(shapely.box(0, 0, 8, 3), lambda xy: np.round(xy @ turn.T, 3))
    door = shapely.transform(shapely.LineString([(3, 0), (3, 3)]), lambda xy: np.round(xy @ turn.T, 3))
    plan = FloorPlan("slanted", space, doors=(door,))
    cells = exact_cells(plan)
    check_partition(plan, cells)
    assert len(cells) == 2


def test_a_door_that_reaches_no_wall_cuts_nothing():
    plan = FloorPlan("hall", shapely.box(0, 0, 9, 9), doors=(shapely.LineString([(4, 4), (5, 5)]),))
    assert len(exact_cells(plan)) == 1


def test_few_cells():
    """A comb of n teeth has 2 (n - 1) reflex vertices in pairs, so n + 1 cells are enough; at most twice as many."""
    n = 20
    comb = shapely.union_all([shapely.box(0, 0, 2 * n, 1), *(shapely.box(2 * k, 1, 2 * k + 1, 4) for k in range(n))])
    assert len(exact_cells(FloorPlan("comb", comb))) == n + 1
