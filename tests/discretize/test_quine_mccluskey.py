"""Minimum cover by prime implicants: against brute force, and as a method to cut plans."""

from itertools import combinations

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from discretize import check_cells, convex_cells, exact_cells
from discretize.implicants import CONVEXITY, Pieces, prime_implicants
from discretize.quine_mccluskey import minimum_cover, quine_mccluskey_cells
from discretize.rays import arrangement, extension_rays
from discretize.triangulation import door_edges
from maps import FloorPlan, bundled_names, read_plan
from tests.discretize.plans import grid_of_rooms, pixel_plans, shard_plans

ELL = shapely.box(0, 0, 4, 4).difference(shapely.box(2, 2, 4, 4))
PLUS = shapely.box(0, 2, 6, 4).union(shapely.box(2, 0, 4, 6))
FRAME = shapely.box(0, 0, 6, 6).difference(shapely.box(2, 2, 4, 4))


def pieces_of(plan):
    doors = door_edges(plan)
    return Pieces(tuple(arrangement(plan, extension_rays(plan, doors))), doors)


@pytest.mark.parametrize(
    ("space", "pieces", "primes", "cells"),
    [(shapely.box(0, 0, 4, 4), 1, 1, 1), (ELL, 3, 2, 2), (PLUS, 5, 2, 3), (FRAME, 8, 4, 4)],
)
def test_small_shapes(space, pieces, primes, cells):
    """Primes of rectilinear shapes are their maximal rectangles, as in a Karnaugh map."""
    plan = FloorPlan("shape", space)
    found = pieces_of(plan)
    assert len(found.shapes) == pieces
    implicants = prime_implicants(found)
    assert len(implicants) == primes
    assert all(found.shape(p).equals(shapely.box(*found.shape(p).bounds)) for p in implicants)
    assert len(quine_mccluskey_cells(plan)) == cells


@given(
    st.integers(1, 7).flatmap(
        lambda n: st.tuples(
            st.just(n), st.lists(st.frozensets(st.integers(0, n - 1), min_size=1), max_size=8, unique=True)
        )
    )
)
@settings(max_examples=100, deadline=None)
def test_cover_is_minimal(case):
    n, unions = case
    unions = [*unions, *(frozenset([k]) for k in range(n) if frozenset([k]) not in unions)]
    cover = minimum_cover(n, unions)
    assert frozenset().union(*cover) == frozenset(range(n))
    smaller = combinations(unions, len(cover) - 1)
    assert not any(frozenset().union(*some) == frozenset(range(n)) for some in smaller)


@settings(max_examples=40, deadline=None)
@given(pixel_plans(side=6))
def test_primes_are_implicants_that_no_neighbour_can_join(plan):
    found = pieces_of(plan)
    primes = prime_implicants(found)
    assert frozenset().union(*primes) == frozenset(range(len(found.shapes)))
    for prime in primes:
        shape = found.shape(prime)
        assert shape.geom_type == "Polygon"
        assert shape.area >= CONVEXITY * shape.convex_hull.area
        assert not any(prime < other for other in primes)


@settings(max_examples=40, deadline=None)
@given(st.one_of(pixel_plans(side=6), shard_plans()))
def test_cells_cover_hostile_plans_once(plan):
    cells = quine_mccluskey_cells(plan)
    assert sum(c.area for c in cells) == pytest.approx(plan.area, rel=1e-9)
    overlaps = [a.intersection(b).area for a, b in combinations(cells, 2)]
    assert sum(overlaps) <= 1e-9 * plan.area
    for cell in cells:
        assert cell.is_valid
        assert not cell.interiors
        assert cell.area >= CONVEXITY * cell.convex_hull.area - 1e-9


@pytest.mark.parametrize("name", bundled_names())
def test_bundled_plans_have_the_cells_intended(name):
    plan = read_plan(name)
    cellmap = convex_cells(plan, method="quine-mccluskey")
    assert check_cells(cellmap).problems == ()
    assert len(cellmap) == len(exact_cells(plan))


def test_doorways_join_a_room():
    """Strictly convex cells count each doorway on its own, nearly convex ones do not."""
    plan = grid_of_rooms(3, 2)
    cellmap = convex_cells(plan, method="quine-mccluskey")
    report = check_cells(cellmap)
    assert report.problems == ()
    assert report.convexity >= CONVEXITY
    assert len(cellmap) < len(exact_cells(plan))


def test_a_robot_map_is_sound(floorplans):
    plan = read_plan(floorplans / "ros/rmp_museum.yaml")
    cellmap = convex_cells(plan, method="quine-mccluskey")
    assert check_cells(cellmap).problems == ()
    assert len(cellmap) < len(exact_cells(plan))
