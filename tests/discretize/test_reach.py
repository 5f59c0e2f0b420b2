"""Where a body can be, and its ways, against brute force."""

import numpy as np
import pytest
import shapely
from hypothesis import given, reject, settings

from discretize.reach import VOID, reach_of
from maps import FloorPlan
from tests.discretize.plans import on_grid, shard_plans

RING = on_grid(shapely.box(0, 0, 10, 10).difference(shapely.box(2, 2, 8, 8)))
RADIUS = 0.2


def length(way):
    return float(np.hypot(*np.diff(way, axis=0).T).sum())


def clearance(space, way):
    return shapely.set_precision(space, 0).boundary.distance(shapely.LineString(way))


def places(reach, rng, n):
    """Random places in the first part."""
    x0, y0, x1, y1 = reach.parts[0].bounds
    points = rng.uniform((x0, y0), (x1, y1), (50 * n, 2))
    return points[shapely.contains_xy(reach.parts[0], points[:, 0], points[:, 1])][:n]


@settings(max_examples=80, deadline=None)
@given(shard_plans())
def test_reach_keeps_its_distance(plan):
    reach = reach_of(plan.space, RADIUS)
    walls = shapely.set_precision(plan.space, 0).boundary
    for part in reach.parts:
        assert walls.distance(part) >= RADIUS - 1e-9
    loose = shapely.set_precision(plan.space, 0).buffer(-RADIUS - 0.002, quad_segs=64)
    for part in shapely.get_parts(loose):
        # a place cut off from a larger one may be left out where no body twice as wide can be: the inside of a wall
        hollow = part.area < VOID * RADIUS**2 and part.buffer(-RADIUS).is_empty
        assert hollow or part.difference(reach.area).area <= 0.05


@settings(max_examples=60, deadline=None)
@given(shard_plans())
def test_openings_are_what_lies_in_the_reach(plan):
    reach = reach_of(plan.space, RADIUS)
    if not reach.parts:
        reject()
    segments = np.random.default_rng(1).uniform(0, 5, (20, 2, 2))
    owner, stretches = reach.openings(segments)
    found = np.bincount(owner, weights=np.hypot(*(stretches[:, 1] - stretches[:, 0]).T), minlength=20)
    expected = shapely.length(shapely.intersection(shapely.linestrings(segments), reach.area))
    np.testing.assert_allclose(found, expected, atol=1e-4)


def by_all_corners(reach, start, goal):
    """Length of the shortest way by Floyd and Warshall over every vertex of the boundary."""
    from scipy.sparse.csgraph import shortest_path

    corners = shapely.get_coordinates(shapely.get_rings(list(reach.parts)))
    nodes = np.concatenate([[start, goal], np.unique(corners, axis=0)])
    i, j = np.triu_indices(len(nodes), 1)
    area = reach.area.buffer(1e-9)
    shapely.prepare(area)
    free = shapely.covers(area, shapely.linestrings(np.stack([nodes[i], nodes[j]], axis=1)))
    graph = np.full((len(nodes), len(nodes)), np.inf)
    graph[i[free], j[free]] = np.hypot(*(nodes[j[free]] - nodes[i[free]]).T)
    return shortest_path(np.minimum(graph, graph.T), directed=False, indices=0)[1]


def check_ways(space, reach, start, goal):
    shortest = by_all_corners(reach, start, goal)
    near, far = reach.way(start, goal, 1e3), reach.far_way(start, goal)
    for way in (near, far):
        assert way is not None
        np.testing.assert_array_equal(way[[0, -1]], [start, goal])
        assert clearance(space, way) >= RADIUS - 1e-6
    assert length(near) == pytest.approx(shortest, rel=1e-6)
    assert shortest - 1e-6 <= length(far) <= 1.5 * shortest + 0.5


@pytest.mark.parametrize(
    ("start", "goal"), [((1, 1), (9, 9)), ((5, 1), (5, 9)), ((1, 5), (1.5, 5.5)), ((1, 1), (1, 9))]
)
def test_ways_around_a_block(start, goal):
    check_ways(RING, reach_of(RING, RADIUS), np.array(start, float), np.array(goal, float))


@settings(max_examples=25, deadline=None)
@given(shard_plans())
def test_ways_in_shards(plan):
    reach = reach_of(plan.space, RADIUS)
    corners = shapely.get_num_coordinates(reach.area)
    ends = places(reach, np.random.default_rng(2), 2) if reach.parts and corners < 250 else ()
    if len(ends) < 2:
        reject()
    check_ways(plan.space, reach, *ends)


def test_no_way_between_parts():
    plan = FloorPlan("two", shapely.MultiPolygon([shapely.box(0, 0, 2, 2), shapely.box(3, 0, 5, 2)]))
    reach = reach_of(plan.space, RADIUS)
    start, goal = np.array([1.0, 1.0]), np.array([4.0, 1.0])
    assert reach.part_of(np.array([start, goal, [2.5, 1.0], [np.nan, 0.0]])).tolist() == [0, 1, -1, -1]
    assert reach.way(start, goal, 1e3) is None
    assert reach.far_way(start, goal) is None


def test_a_place_too_small_to_move_does_not_count_beside_a_larger_one():
    closet = shapely.box(6, 0, 6.5, 0.5)
    space = shapely.MultiPolygon([shapely.box(0, 0, 5, 5), closet])
    assert len(reach_of(space, RADIUS).parts) == 1
    assert len(reach_of(closet, RADIUS).parts) == 1


def test_the_inside_of_a_wall_is_no_place_beside_a_room():
    room, hollow, hall = shapely.box(0, 0, 5, 5), shapely.box(5.2, 0, 5.9, 4), shapely.box(6, 0, 6.7, 20)
    assert [part.bounds[0] > 5 for part in reach_of(shapely.MultiPolygon([room, hollow]), 0.2).parts] == [False]
    assert len(reach_of(shapely.MultiPolygon([room, hollow, hall]), 0.2).parts) == 2
    assert len(reach_of(hollow, 0.2).parts) == 1
