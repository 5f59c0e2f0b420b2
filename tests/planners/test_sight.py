"""Capture by sight on cells: what is seen is counted once, and comes back as fast as the evader moves."""

import gc
import math

import numpy as np
import pytest
import shapely

from discretize import CellMap, convex_cells
from maps import FloorPlan
from planners import (
    PLANNERS,
    AreaSpeedDegree,
    CaptureError,
    GraphError,
    LineOfSight,
    MotionInParts,
    OwnCell,
    Roads,
    SearchGraph,
    SearchProblem,
    SightMap,
    StateSpace,
    StationaryMotion,
    check_policy,
    check_transition,
    predict,
)
from planners.simulation import SearchModel


def two_rooms() -> CellMap:
    """Return two rooms of 6 m x 6 m, and a passage of 1 m x 1 m between them: three cells in a row."""
    rooms = [shapely.box(0, 0, 6, 6), shapely.box(6, 2.5, 7, 3.5), shapely.box(7, 0, 13, 6)]
    return convex_cells(FloorPlan("two rooms", shapely.union_all(rooms)), method="exact")


@pytest.fixture(scope="module")
def rooms() -> CellMap:
    return two_rooms()


def in_order(cells: CellMap) -> list[int]:
    """Return the numbers of the left room, the passage and the right room."""
    return np.argsort([cell.centroid.x for cell in cells.cells]).tolist()


def sight_problem(cells: CellMap, motion, spacing=0.25, **eye) -> SearchProblem:
    roads = Roads.of(cells)
    sights = SightMap.of(cells, roads, spacing=spacing)
    moving = MotionInParts(motion, roads.graph, sights.space)
    return SearchProblem(roads.graph, moving, LineOfSight(sights, **eye), (1.0,), 1.0, sights.space)


# From the middle of the left room, (3, 3), the corners of the passage at x = 7 leave a cone of slope 1/8: in the right
# room it is 1 m to 2.5 m wide and 6 m long.
SEEN = 6 * (1.0 + 2.5) / 2 / 36


def stand(problem: SearchProblem, cell: int, belief: np.ndarray, steps: int) -> np.ndarray:
    """Return p0 after each step of a robot that stands."""
    model = SearchModel(problem)
    wait = model.move(cell, cell)
    return 1.0 - model.foresee(belief[1:], [wait], [1], [[wait] * steps], steps).sum(axis=1)


def test_a_still_robot_sees_its_share_of_a_room_once(rooms):
    left, _, right = in_order(rooms)
    problem = sight_problem(rooms, StationaryMotion())
    there = np.zeros(4)
    there[right + 1] = 1.0
    captured = stand(problem, left, problem.states.spread(there), 500)
    assert captured[1] == pytest.approx(SEEN, abs=0.01)
    np.testing.assert_array_equal(captured[1:], captured[1])


def test_what_was_seen_fills_up_as_fast_as_the_evader_moves(rooms):
    left, _, right = in_order(rooms)
    motion = AreaSpeedDegree(speed=0.5)
    problem = sight_problem(rooms, motion)
    P = motion.matrix(problem.graph, 1.0).toarray()[1:, 1:]
    there = np.zeros(4)
    there[right + 1] = 1.0
    captured = stand(problem, left, problem.states.spread(there), 2)
    # After the first step: seen is all of the other two cells, and the seen share of the room.
    seen = captured[1]
    unseen = P[right, right] * (1 - SEEN)
    assert seen == pytest.approx(1 - unseen, abs=0.01)
    # The unseen part of the room loses to the neighbours what leaves the room, and to the seen part the seen share of
    # what moves about the room.
    stay = P[right, right]
    lost = unseen * ((1 - stay) + stay * (1 - stay) * SEEN)
    assert captured[2] - captured[1] == pytest.approx(lost, abs=0.005)


def test_a_look_that_may_fail_finds_the_rest_later_but_not_what_is_hidden(rooms):
    left, _, right = in_order(rooms)
    problem = sight_problem(rooms, StationaryMotion(), detection=0.5)
    there = np.zeros(4)
    there[right + 1] = 1.0
    captured = stand(problem, left, problem.states.spread(there), 40)
    np.testing.assert_allclose(captured[1:4] / captured[-1], [0.5, 0.75, 0.875], atol=1e-6)
    assert captured[-1] == pytest.approx(SEEN, abs=0.01)


def test_range_and_field_of_view(rooms):
    left, passage, right = in_order(rooms)
    graph = Roads.of(rooms).graph
    whole = sight_problem(rooms, StationaryMotion())
    cell, share = whole.states.cell, whole.states.share

    def shares(capture: LineOfSight, view: int) -> np.ndarray:
        return np.bincount(cell, weights=capture.table(graph)[[view]].toarray()[0] * share, minlength=3)

    near = sight_problem(rooms, StationaryMotion(), range=2.0).capture
    assert shares(near, left)[left] == pytest.approx(math.pi * 4 / 36, abs=0.02)
    assert shares(near, left)[right] == 0.0
    narrow = sight_problem(rooms, StationaryMotion(), field_of_view=math.pi / 2).capture
    going = int(narrow.viewpoints(graph, graph.edge(left, passage), np.array([1.0]))[0])
    back = int(narrow.viewpoints(graph, graph.edge(passage, left), np.array([3.0]))[0])
    # Half a metre and more on, the room ahead lies in the field of view, the way back does not.
    assert shares(narrow, going)[right] > 0.25
    assert shares(narrow, back)[right] == 0.0
    assert 0.0 < shares(narrow, back)[left] < 0.6
    # In a room with one door a robot always came by that, and so looks away from it where it waits.
    assert shares(narrow, left)[right] == 0.0
    assert shares(narrow, left)[left] == pytest.approx(0.25, abs=0.04)


def test_everything_in_a_convex_cell_is_in_sight_of_every_station_in_it(office):
    roads = Roads.of(office)
    sights = SightMap.of(office, roads)
    capture = LineOfSight(sights)
    table = capture.table(roads.graph)
    for edge, line in enumerate(roads.lines[:40]):
        tail, way = int(roads.tails[edge]), np.array([0.4 * float(roads.graph.leave[edge])])
        view = int(capture.viewpoints(roads.graph, edge, way)[0])
        seen = table[[view]].toarray()[0]
        assert seen[sights.space.cell == tail].all(), (edge, line)


def test_what_is_in_sight_is_kept_as_long_as_the_map():
    import planners.sight

    cells = two_rooms()
    roads = Roads.of(cells)
    assert SightMap.of(cells, roads) is SightMap.of(cells, Roads.of(cells))
    assert SightMap.of(cells, roads) is not SightMap.of(cells, roads, 5.0)
    kept = len(planners.sight._KEPT)
    del cells
    gc.collect()
    assert len(planners.sight._KEPT) == kept - 2


@pytest.mark.parametrize("motion", [AreaSpeedDegree(), StationaryMotion()], ids=repr)
def test_motion_in_parts_keeps_the_probabilities_of_cells(office, motion):
    graph = SearchGraph.from_cells(office)
    space = SightMap.of(office, Roads.of(office)).space
    split = MotionInParts(motion, graph, space).matrix(graph, 1.0)
    check_transition(split)
    rng = np.random.default_rng(0)
    belief = rng.dirichlet(np.ones(len(space) + 1))
    whole = motion.matrix(graph, 1.0)
    np.testing.assert_allclose(space.gather(belief @ split), space.gather(belief) @ whole, atol=1e-12)


@pytest.mark.parametrize("name", PLANNERS)
def test_every_planner_plans_with_sight(name):
    entry = PLANNERS[name]
    limits = {"horizon": 6} if "horizon" in entry.parameters else {}
    check_policy(entry.make(**limits), house_problem("centroids"), np.random.default_rng(1), rounds=3)


def house_problem(checkpoints: str) -> SearchProblem:
    from maps import read_plan

    cells = convex_cells(read_plan("house"))
    roads = Roads.of(cells, checkpoints)
    sights = SightMap.of(cells, roads)
    moving = MotionInParts(AreaSpeedDegree(), SearchGraph.from_cells(cells), sights.space)
    eyes = LineOfSight(sights), LineOfSight(sights, 2.0, math.pi, 0.8)
    return SearchProblem(roads.graph, moving, eyes, (1.0, 0.5), 1.0, sights.space)


@pytest.mark.parametrize("name", PLANNERS)
def test_every_planner_plans_on_boundaries(name):
    entry = PLANNERS[name]
    limits = {"horizon": 6} if "horizon" in entry.parameters else {}
    check_policy(entry.make(**limits), house_problem("boundaries"), np.random.default_rng(1), rounds=3)


def test_boundaries_are_checkpoints_between_centroids(rooms):
    left, passage, right = in_order(rooms)
    roads = Roads.of(rooms, "boundaries")
    whole = SearchGraph.from_cells(rooms)
    assert len(roads.graph) == 3 + 2
    for k, (a, b) in enumerate(rooms.edges):
        np.testing.assert_array_equal(np.sort(roads.graph.neighbours(3 + k)), np.sort([a, b]))
        half = roads.graph.length[roads.graph.edge(a, 3 + k)] + roads.graph.length[roads.graph.edge(3 + k, b)]
        assert half == pytest.approx(whole.length[whole.edge(a, b)])
        assert roads.cell[3 + k] == min(a, b)
    space = StateSpace.of_cells(3)
    own = OwnCell(roads, space)
    problem = SearchProblem(roads.graph, MotionInParts(AreaSpeedDegree(), whole, space), own, (1.0,), 1.0, space)
    belief = problem.first_belief([left])
    np.testing.assert_allclose(belief[[0, 1 + left, 1 + passage, 1 + right]], [0, 0, 0.5, 0.5])
    (result,) = predict(problem, PLANNERS["decoupled"].make(), [(left,)], np.random.default_rng(0))
    assert 1.0 < result.expected_time < 30.0


def test_unknown_checkpoints_are_named(rooms):
    with pytest.raises(GraphError, match="no checkpoints 'boundary'; did you mean 'boundaries'"):
        Roads.of(rooms, "boundary")


@pytest.mark.parametrize(
    ("eye", "message"),
    [
        ({"range": 0.0}, "must be above 0; got 0 m"),
        ({"field_of_view": -1.0}, "got inf m and -1 rad"),
        ({"detection": 1.5}, "at most 1; got 1.5"),
    ],
)
def test_eyes_that_cannot_be_are_named(rooms, eye, message):
    with pytest.raises(CaptureError, match=message):
        LineOfSight(SightMap.of(rooms, Roads.of(rooms)), **eye)


def test_one_capture_model_for_each_pursuer_or_one_for_all(house):
    eye = sight_problem(two_rooms(), StationaryMotion()).capture
    with pytest.raises(CaptureError, match="3 capture models for 2 pursuers"):
        SearchProblem(house, StationaryMotion(), (eye, eye, eye), (1.0, 1.0))
