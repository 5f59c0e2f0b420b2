"""Places on checkpoint routes, and how one strolls over them."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from discretize import CellMap, Portal, convex_cells
from maps import FloorPlan, read_plan
from planners import MotionError, Roads, SearchGraph, check_transition
from planners.places import PlaceError, Places, StandingStill, Strolling


def two_rooms(near: float = 2.0, far: float = 1.5) -> CellMap:
    """Two rooms beside each other, their checkpoints ``near`` and ``far`` metres from the door."""
    left, right = shapely.box(0, 0, 4, 4), shapely.box(4, 0, 8, 4)
    door = np.array([[4.0, 1.5], [4.0, 2.5]])
    legs = (np.array([[4.0 - near, 2.0], [4.0, 2.0]]), np.array([[4.0 + far, 2.0], [4.0, 2.0]]))
    return CellMap(
        plan=FloorPlan("rooms", shapely.box(0, 0, 8, 4)),
        cells=(left, right),
        portals=(Portal((0, 1), door, np.array([4.0, 2.0]), legs),),
        checkpoints=np.array([[4.0 - near, 2.0], [4.0 + far, 2.0]]),
        radius=0.2,
        method="drawn",
        names=(),
    )


def test_two_rooms_by_hand() -> None:
    places = Places.of(Roads.of(two_rooms()), 1.0)
    # the way is 3.5 m long: places after 0, 1, 2, 3 m, both ways
    assert places.first.tolist() == [0, 4, 8]
    assert np.allclose(places.points[:, 0], [2, 3, 4, 5, 5.5, 4.5, 3.5, 2.5])
    assert np.allclose(places.points[:, 1], 2)
    assert np.allclose(np.cos(places.headings), [1, 1, 1, 1, -1, -1, -1, -1])
    assert places.space.cell.tolist() == [0, 0, 1, 1, 1, 1, 0, 0]
    assert places.space.share.tolist() == [1, 0, 0, 0, 1, 0, 0, 0]


def test_motion_in_two_rooms_by_hand() -> None:
    places = Places.of(Roads.of(two_rooms()), 1.0)
    matrix = Strolling(places, 1.0).matrix(places.roads.graph, 1.0)
    expected = np.zeros((9, 9))
    expected[0, 0] = 1
    for k in (1, 2, 3, 5, 6, 7):
        expected[k, k + 1] = 1
    # half a metre beyond the end: as often at the checkpoint as a metre behind it
    expected[4, [5, 6]] = 0.5
    expected[8, [1, 2]] = 0.5
    assert np.allclose(matrix.toarray(), expected)


def test_one_spacing_of_the_evaders_step_is_exact_where_ways_are_whole_steps() -> None:
    places = Places.of(Roads.of(two_rooms(2.0, 1.0)), 0.5)
    matrix = Strolling(places, 1.0).matrix(places.roads.graph, 0.5)
    assert set(matrix.data.tolist()) == {1.0}


@pytest.fixture(scope="module", params=["house", "office"])
def cells(request: pytest.FixtureRequest) -> CellMap:
    return convex_cells(read_plan(request.param))


@pytest.fixture(scope="module")
def places(cells: CellMap) -> Places:
    return Places.of(Roads.of(cells), 0.7)


def test_places_lie_in_their_cells(places: Places, cells: CellMap) -> None:
    polygons = np.array(cells.cells, dtype=object)[places.space.cell]
    assert shapely.distance(polygons, shapely.points(places.points)).max() < 1e-6


def test_every_cell_has_somewhere_to_set_out(places: Places) -> None:
    assert np.allclose(np.bincount(places.space.cell, weights=places.space.share), 1.0)


@pytest.mark.parametrize(("speed", "step"), [(1.0, 0.7), (1.0, 1.0), (0.3, 0.5), (9.0, 2.0)])
def test_probability_is_conserved(places: Places, speed: float, step: float) -> None:
    matrix = Strolling(places, speed).matrix(places.roads.graph, step)
    check_transition(matrix)
    belief = places.space.spread(np.concatenate([[0.0], np.full(places.space.cells, 1 / places.space.cells)]))
    for _ in range(50):
        belief = belief @ matrix
    assert belief.sum() == pytest.approx(1.0)
    assert belief[0] == 0
    assert places.space.gather(belief).sum() == pytest.approx(1.0)


@given(near=st.floats(0.3, 3.5), far=st.floats(0.3, 3.5), spacing=st.floats(0.1, 5.0), step=st.floats(0.05, 9.0))
def test_the_expected_way_is_exact(near: float, far: float, spacing: float, step: float) -> None:
    """Back and forth between two rooms there is one way only, so that the way gone has a mean to be compared."""
    places = Places.of(Roads.of(two_rooms(near, far)), spacing)
    matrix = Strolling(places, 1.0).matrix(places.roads.graph, step)[1:, 1:]
    check_transition(Strolling(places, 1.0).matrix(places.roads.graph, step))
    length = near + far
    at = (places.way + length * places.edge) % (2 * length)
    turn = np.exp(2j * np.pi * (at[np.newaxis] - at[:, np.newaxis] - step) / (2 * length))
    # how far each entry is from where it should be, within half a round
    off = np.angle(turn) / np.pi * length
    mean = np.asarray(matrix.multiply(off).sum(axis=1))
    assert np.abs(mean).max() < 1e-6 * length
    assert np.abs(off[matrix.toarray() > 0]).max() <= spacing + 1e-6


def test_a_cell_without_ways_is_a_place_where_one_stands() -> None:
    graph = SearchGraph.from_edges(3, [(0, 1)])
    line = np.array([[0.0, 0.0], [1.0, 0.0]])
    roads = Roads(graph, np.array([[0.0, 0.0], [1.0, 0.0], [7.0, 7.0]]), np.arange(3), (line, line[::-1]))
    places = Places.of(roads, 0.4)
    assert len(places) == 7
    assert places.edge[-1] == -1
    assert places.points[-1].tolist() == [7, 7]
    matrix = Strolling(places, 1.0).matrix(graph, 0.4)
    check_transition(matrix)
    assert matrix[7, 7] == 1


def test_who_stands_still_stays(places: Places) -> None:
    matrix = StandingStill(places).matrix(places.roads.graph, 1.0)
    check_transition(matrix)
    assert (matrix.diagonal() == 1).all()


@pytest.mark.parametrize("spacing", [0.0, -1.0, np.nan, np.inf])
def test_spacings_that_cannot_be(spacing: float) -> None:
    with pytest.raises(PlaceError, match="spacing"):
        Places.of(Roads.of(two_rooms()), spacing)


def test_speeds_that_cannot_be() -> None:
    with pytest.raises(MotionError, match="speed"):
        Strolling(Places.of(Roads.of(two_rooms()), 1.0), 0.0)
