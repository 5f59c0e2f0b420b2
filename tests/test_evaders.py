"""How evaders move: every model keeps to the ways of the building, and does what it is called after."""

import itertools

import numpy as np
import pytest

from discretize import CellMap
from geomsim import Evader, Sensor, Stationary, Team, Timing, run_episode
from geomsim.evaders import EVADERS, make_evader_model
from geomsim.quarry import Quarry
from geomsim.walking import Route, Routes
from geomsim.world import count_wall_crossings
from maps import GeomsimError


def nobody() -> np.ndarray:
    return np.empty((0, 2))


def tour(name: str, routes: Routes, cell: int, hops: int, robots: np.ndarray | None = None) -> list[Route]:
    lookout = nobody if robots is None else lambda: robots
    walk = make_evader_model(name).walk(routes, cell, np.random.default_rng(4), lookout)
    return list(itertools.islice(walk, hops))


@pytest.mark.parametrize("name", EVADERS)
def test_routes_hang_together(house: CellMap, name: str) -> None:
    routes = Routes(house)
    for start in range(len(house)):
        at = start
        for route in tour(name, routes, start, 40):
            assert route.cells[0] == at
            assert route.length > 0
            assert route.cells[1] in (at, *routes.neighbours[at])
            at = route.cells[1]
    assert [r.cells for r in tour(name, routes, 0, 30)] == [r.cells for r in tour(name, routes, 0, 30)]


def test_shortest_paths_go_far(house: CellMap) -> None:
    routes = Routes(house)
    visited = [2, *(r.cells[1] for r in tour("shortest-paths", routes, 2, 400))]
    way = routes.distances(2)
    goal = next(k for k, c in enumerate(visited) if way[c] >= way.max() / 2)
    assert sum(routes.between(a, b).length for a, b in itertools.pairwise(visited[: goal + 1])) == pytest.approx(
        way[visited[goal]]
    )
    assert set(visited) == set(range(9))


def test_hiding_stays_in_dead_ends_only(house: CellMap) -> None:
    routes = Routes(house)
    stays = [r for r in tour("hiding", routes, 7, 300) if r.cells[0] == r.cells[1]]
    assert {r.cells[0] for r in stays} == {c for c in range(9) if len(routes.neighbours[c]) == 1}
    assert 30 < np.mean([r.length for r in tour("hiding", routes, 2, 2000)]) < 90


def test_fleeing_runs_from_what_it_sees(house: CellMap) -> None:
    routes = Routes(house)
    robot = routes.checkpoint(3)[np.newaxis]
    for start in routes.neighbours[3]:
        for route in tour("fleeing", routes, start, 5, robot):
            before, after = (np.hypot(*(robot[0] - routes.checkpoint(c))) for c in route.cells)
            assert after >= before
    unseen = [r.cells for r in tour("fleeing", routes, 0, 20)]
    assert unseen == [r.cells for r in tour("centroid-boundary", routes, 0, 20)]


def test_fleeing_looks_through_doors_not_walls(house: CellMap) -> None:
    quarry = Quarry(
        house.plan.walls, Routes(house), Evader(model=make_evader_model("fleeing")), [3], [np.random.default_rng(1)]
    )
    quarry.robots = np.array([house.checkpoints[3] + 0.5, house.checkpoints[1]])
    assert np.array_equal(quarry._lookout(0), quarry.robots[:1])


@pytest.mark.parametrize("name", EVADERS)
def test_an_evader_of_each_kind_in_the_world(house: CellMap, name: str) -> None:
    episode = run_episode(
        house.plan,
        house,
        Team(pursuers=1, planner=Stationary(), start=(7,)),
        Evader(model=make_evader_model(name), start=1),
        seed=2,
        timing=Timing(limit=60.0),
        capture="cell",
    )
    assert count_wall_crossings(episode.evader[:, np.newaxis], house.plan.walls) == 0
    assert (np.ptp(episode.evader, axis=0).max() < 1e-9) == (name == "still")
    assert episode.outcome.notes == ()


def test_an_unknown_evader_is_refused() -> None:
    with pytest.raises(GeomsimError, match="did you mean 'fleeing'"):
        make_evader_model("fleeling")


def test_a_robot_that_notices_slowly_captures_later(house: CellMap) -> None:
    """Seconds in view before it is noticed are exponential: of many, the mean is that of the rate."""
    waits = []
    for seed in range(150):
        team = Team(pursuers=1, planner=Stationary(), start=(4,), sensor=Sensor(detection=0.4))
        episode = run_episode(
            house.plan,
            house,
            team,
            Evader(model=make_evader_model("still"), start=4),
            seed=seed,
            timing=Timing(limit=200.0),
        )
        waits.append(episode.outcome.time)
    expected = 1 / -np.log(0.6)
    assert abs(np.mean(waits) - expected) < 4 * expected / np.sqrt(len(waits))  # false alarm about once in 16,000
