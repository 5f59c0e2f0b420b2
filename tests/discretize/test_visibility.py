"""Conservative visibility cells against what they promise: in one cell the same gaps are seen from everywhere."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings

from discretize import DiscretizeError, check_cells, convex_cells, visibility_cells, visibility_count
from discretize.visibility import visibility_rays
from maps import FloorPlan, read_plan
from tests.discretize.plans import grid_of_rooms, pixel_plans, shard_plans
from tests.discretize.test_exact import check_partition

ELL = shapely.box(0, 0, 2, 2).difference(shapely.box(1, 1, 2, 2))
PLUS = shapely.box(0, 1, 3, 2).union(shapely.box(1, 0, 2, 3))
FRAME = shapely.box(0, 0, 3, 3).difference(shapely.box(1, 1, 2, 2))
TEE = shapely.box(0, 0, 5, 1).union(shapely.box(2, 1, 3, 3))


@pytest.mark.parametrize(("space", "cells"), [(shapely.box(0, 0, 1, 1), 1), (ELL, 3), (PLUS, 5), (FRAME, 8), (TEE, 4)])
def test_small_shapes(space, cells):
    plan = FloorPlan("shape", space)
    assert len(visibility_cells(plan)) == visibility_count(plan) == cells


def corners_of(space):
    """Reflex corners with their neighbours, told by whether the triangle at the corner is free."""
    rows = []
    for ring in shapely.get_rings(shapely.get_parts(space)):
        xy = shapely.get_coordinates(ring)[:-1]
        for a, v, b in zip(np.roll(xy, 1, axis=0), xy, np.roll(xy, -1, axis=0), strict=True):
            u, w = (a - v) / np.hypot(*(a - v)), (b - v) / np.hypot(*(b - v))
            if abs(u[0] * w[1] - u[1] * w[0]) > 1e-9 and not space.covers(shapely.Point(v + 1e-5 * (u + w))):
                rows.append((v, a, b))
    return rows


def gaps(space, corners, point):
    """Reflex corners behind which something is hidden from a point."""
    seen = set()
    for k, (v, a, b) in enumerate(corners):
        way = v - point
        sides = [way[0] * (c - v)[1] - way[1] * (c - v)[0] for c in (a, b)]
        if min(sides) >= 0 or max(sides) <= 0:
            short = shapely.LineString([point, point + way * (1 - 1e-7)])
            if space.covers(short):
                seen.add(k)
    return seen


def check_gaps(plan, limit):
    rng = np.random.default_rng(3)
    space = shapely.set_precision(plan.space, 0)
    corners = corners_of(space)
    for cell in visibility_cells(plan)[:limit]:
        inner = cell.buffer(-0.01)
        if inner.area > 0.01:
            x0, y0, x1, y1 = inner.bounds
            points = rng.uniform((x0, y0), (x1, y1), (20, 2))
            points = points[shapely.contains_xy(inner, points[:, 0], points[:, 1])][:3]
            kinds = {frozenset(gaps(space, corners, p)) for p in points}
            assert len(kinds) <= 1, (cell.wkt, kinds)


@pytest.mark.parametrize(
    "plan", [FloorPlan("ell", ELL), FloorPlan("frame", FRAME), grid_of_rooms(2, 2), read_plan("house")]
)
def test_same_gaps_are_seen_from_all_of_a_cell(plan):
    check_gaps(plan, 150)


@settings(max_examples=25, deadline=None)
@given(shard_plans())
def test_same_gaps_in_shards(plan):
    check_gaps(plan, 40)


@settings(max_examples=60, deadline=None)
@given(pixel_plans(side=6))
def test_bitmaps_are_covered_once(plan):
    check_partition(plan, visibility_cells(plan))


def test_doors_are_cut_along():
    door = shapely.LineString([(1, 0), (1, 2)])
    assert len(visibility_cells(FloorPlan("square", shapely.box(0, 0, 2, 2), doors=(door,)))) == 2


def test_house_has_far_more_visibility_cells_than_rooms(house):
    cellmap = convex_cells(house.plan, method="visibility")
    assert check_cells(cellmap).problems == ()
    assert len(cellmap) > 20 * len(house)


def test_too_many_cells_are_counted_only():
    pillars = [
        shapely.box(3 * i + j % 3, 3 * j + i % 2, 3 * i + j % 3 + 1, 3 * j + i % 2 + 1)
        for i in range(9)
        for j in range(9)
    ]
    plan = FloorPlan("pillars", shapely.box(-1, -1, 30, 30).difference(shapely.union_all(pillars)))
    count = visibility_count(plan)
    assert count > 20_000
    with pytest.raises(DiscretizeError, match=f"'pillars' has about {count} visibility cells"):
        visibility_cells(plan)


def test_rays_end_at_walls():
    plan = grid_of_rooms(3, 2)
    rays = visibility_rays(plan)
    ends = shapely.points(rays[:, 1])
    assert shapely.distance(plan.space.boundary, ends).max() < 1e-5
    inner = shapely.linestrings(
        rays + 1e-4 * (rays[:, ::-1] - rays) / np.hypot(*(rays[:, 1] - rays[:, 0]).T)[:, None, None]
    )
    assert shapely.covers(shapely.set_precision(plan.space, 0), inner).all()
