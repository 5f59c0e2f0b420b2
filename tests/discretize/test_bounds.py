"""The certificate: bounds on the number of convex cells, and sight within cells."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings

from discretize import certify, convex_cells, exact_cells
from discretize.bounds import hidden_set, mutual_sight, reflex_bound
from discretize.triangulation import door_edges
from maps import FloorPlan
from tests.discretize.plans import grid_of_rooms, pixel_plans, shard_plans, two_halls

ELL = shapely.box(0, 0, 2, 2).difference(shapely.box(1, 1, 2, 2))
PLUS = shapely.box(0, 1, 3, 2).union(shapely.box(1, 0, 2, 3))
FRAME = shapely.box(0, 0, 3, 3).difference(shapely.box(1, 1, 2, 2))


@pytest.mark.parametrize(
    ("space", "reflex", "hidden"),
    [
        (shapely.box(0, 0, 1, 1), 1, 1),
        (ELL, 2, 2),
        (PLUS, 3, 2),
        (FRAME, 2, 4),
        (shapely.MultiPolygon([ELL, shapely.box(5, 5, 6, 6)]), 3, 3),
    ],
)
def test_bounds_of_small_shapes(space, reflex, hidden):
    plan = FloorPlan("shape", space)
    assert reflex_bound(plan) == reflex
    assert hidden <= len(hidden_set(plan, exact_cells(plan))) <= len(exact_cells(plan))


def test_doors_need_edges():
    assert reflex_bound(two_halls()) == 2
    square = FloorPlan("square", shapely.box(0, 0, 2, 2), doors=(shapely.LineString([(1, 0), (1, 2)]),))
    assert reflex_bound(square) == 2


def test_bundled_house_cannot_be_cut_into_fewer_cells(house):
    certificate = certify(house)
    assert certificate.reflex_bound == certificate.hidden_bound == certificate.exact == len(house) == 9
    assert certificate.mutual_sight == 1.0


@settings(max_examples=60, deadline=None)
@given(pixel_plans())
def test_no_bound_is_above_a_cut_of_bitmaps(plan):
    check_bounds(plan)


@settings(max_examples=60, deadline=None)
@given(shard_plans())
def test_no_bound_is_above_a_cut_of_shards(plan):
    check_bounds(plan)


def check_bounds(plan):
    cells = exact_cells(plan)
    hidden = hidden_set(plan, cells)
    assert len(plan.parts) <= reflex_bound(plan) <= len(cells)
    assert len(plan.parts) <= len(hidden) <= len(cells)
    space = shapely.set_precision(plan.space, 0)
    doors = shapely.linestrings(door_edges(plan))
    for a, b in combinations(hidden, 2):
        line = shapely.LineString([a, b])
        assert not space.covers(line) or any(line.crosses(door) for door in doors)


def joined(cellmap):
    """The map with its first two rooms and the doorway between them made one cell."""
    low, high = cellmap.plan.bounds[1], cellmap.plan.bounds[3]
    first = shapely.box(0, low, 8.1, high).intersection(shapely.set_precision(cellmap.plan.space, 0))
    return replace(cellmap, cells=(first, *(c for c in cellmap.cells if c.bounds[0] > 8)))


def test_sight_is_whole_in_convex_cells_and_less_in_two_rooms():
    cellmap = convex_cells(grid_of_rooms(2, 1))
    assert (mutual_sight(cellmap) == 1).all()
    share = mutual_sight(joined(cellmap))
    assert share[0] < 1
    assert (share[1:] == 1).all()


def test_sight_in_an_ell():
    """Of pairs of points of an L, those in its two arms see each other where their line passes the corner."""
    plan = FloorPlan("ell", ELL)
    cellmap = replace(convex_cells(plan, radius=0.1), cells=(ELL,))
    rng = np.random.default_rng(5)
    points = rng.uniform(0, 2, (4000, 2))
    points = points[~((points > 1).all(axis=1))][:2000].reshape(-1, 2, 2)
    expected = shapely.covers(ELL, shapely.linestrings(points)).mean()
    assert mutual_sight(cellmap) == pytest.approx([expected], abs=0.05)


def test_certificate_of_a_map_by_rooms_names_the_darkest_cell():
    cellmap = joined(convex_cells(grid_of_rooms(3, 1)))
    certificate = certify(cellmap)
    assert certificate.darkest == 1
    assert certificate.mutual_sight < 0.9
