"""Robots that plan for themselves: like one planner if all hear all, and never counting a look twice if not."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from discretize import CellMap
from geomsim import Communication, Decoupled, Episode, GeomsimError, Random, Stationary, Team, Timing, run_episode
from geomsim.crew import Crew
from geomsim.drawing import FrameStyle, draw_frame
from geomsim.drawing.theme import DrawingError
from geomsim.world import World
from planners import (
    PLANNERS,
    AreaSpeedDegree,
    PursuerState,
    SameCell,
    SearchGraph,
    SearchProblem,
    UniformMotion,
    advance,
    uniform_belief,
)

RING = SearchGraph.from_edges(8, [(k, (k + 1) % 8) for k in range(8)])


def limited(name: str):
    entry = PLANNERS[name]
    limits = {"horizon": 12} if "horizon" in entry.parameters else {}
    return entry.make(**limits)


@pytest.mark.parametrize("name", PLANNERS)
def test_with_full_communication_robots_do_what_one_planner_would_do(house: CellMap, name: str) -> None:
    planner, timing = limited(name), Timing(limit=25.0)
    one, many = (
        run_episode(
            house.plan,
            house,
            Team(pursuers=3, planner=planner, communication=Communication(links)),
            seed=4,
            capture="cell",
            timing=timing,
        )
        for links in ("central", "full")
    )
    assert len(one.times) > 30
    for field in ("times", "pursuers", "headings", "beliefs", "decision_times", "decision_pursuers"):
        np.testing.assert_array_equal(getattr(one, field), getattr(many, field))
    assert [p.tolist() for p in one.decision_paths] == [p.tolist() for p in many.decision_paths]
    assert one.own_beliefs.shape == (len(one.beliefs), 0, 10)
    assert many.own_beliefs.shape == (len(one.beliefs), 3, 10)
    np.testing.assert_array_equal(many.own_beliefs, np.repeat(many.beliefs[:, np.newaxis], 3, axis=1))


def crew_of(team: int, **options) -> Crew:
    problem = SearchProblem(RING, UniformMotion(), SameCell(0.8), (1.0,) * team)
    belief = uniform_belief(RING)
    return Crew(problem, Stationary(), belief, [0] * team, np.random.default_rng(0), central=False, **options)


@settings(max_examples=30)
@given(seed=st.integers(0, 9999), team=st.integers(2, 4), steps=st.integers(1, 12))
def test_a_belief_is_that_of_every_look_heard_of_counted_once(seed: int, team: int, steps: int) -> None:
    rng = np.random.default_rng(seed)
    crew, P = crew_of(team), UniformMotion().matrix(RING, 1.0)
    looks: dict[tuple[int, int], np.ndarray] = {}
    known: list[set[tuple[int, int]]] = [set() for _ in range(team)]
    for t in range(steps):
        rows = 0.8 * np.eye(8)[rng.integers(0, 8, team)]
        contacts = np.eye(team, dtype=bool)
        links = rng.random((team, team)) < 0.2
        contacts |= links | links.T
        for via in range(team):
            contacts |= contacts[:, [via]] & contacts[[via]]
        crew.learn(rows, contacts)
        for j in range(team):
            looks[j, t] = rows[j]
            known[j].add((j, t))
        known = [set().union(*(known[j] for j in range(team) if contacts[i, j])) for i in range(team)]
        for i in range(team):
            belief = uniform_belief(RING)
            for step in range(t + 1):
                seen = [looks[j, step] for j in range(team) if (j, step) in known[i]]
                belief = advance(belief, P, np.array(seen).reshape(-1, 8))
            np.testing.assert_allclose(crew.own_beliefs[i], belief, atol=1e-12)
    crew.learn(np.zeros((team, 8)), np.ones((team, team), dtype=bool))
    np.testing.assert_allclose(crew.own_beliefs, np.repeat(crew.belief[np.newaxis], team, axis=0), atol=1e-12)


def test_who_is_not_heard_is_taken_to_end_its_hop_and_stand() -> None:
    asked: list[tuple[PursuerState, ...]] = []

    @dataclasses.dataclass(frozen=True)
    class Spy:
        def solve(self, problem, rng):
            class Policy:
                def decide(self, state):
                    asked.append(state.pursuers)
                    return Random().solve(problem, rng).decide(state)

            return Policy()

    problem = SearchProblem(RING, UniformMotion(), SameCell(), (1.0, 1.0))
    crew = Crew(problem, Spy(), uniform_belief(RING), [0, 4], np.random.default_rng(0), central=False)
    together, apart = np.ones((2, 2), dtype=bool), np.eye(2, dtype=bool)
    on_its_way = PursuerState(4, 5, 3.0)
    crew.decide(0.0, [PursuerState(0), on_its_way], [True, False], together)
    assert asked[-2:] == [(PursuerState(0), on_its_way)] * 2
    crew.decide(1.0, [PursuerState(1), PursuerState(5, 5, 2.0)], [True, False], apart)
    assert asked[-1] == (PursuerState(1), PursuerState(4, 5, 2.0))
    crew.decide(9.0, [PursuerState(2), PursuerState(7, 0, 0.5)], [True, False], apart)
    assert asked[-1] == (PursuerState(2), PursuerState(5))


def test_contacts_reach_over_others_and_end_at_walls(house: CellMap) -> None:
    world = World(house.plan.walls, house.checkpoints[:1], np.array([0.2]))
    line = np.array([[1.0, 1.0], [1.0, 4.0], [1.0, 7.0], [1.0, 14.0]])
    heard = Communication("range", 3.5).contacts(world, line)
    np.testing.assert_array_equal(heard, np.kron([[1, 0], [0, 0]], np.ones((3, 3)))[:4, :4] + np.diag([0, 0, 0, 1]))
    assert Communication("full").contacts(world, line).all()
    seen = Communication("sight").contacts(world, house.checkpoints)
    free = [[world.sees(a, b) for b in house.checkpoints] for a in house.checkpoints]
    assert seen[np.array(free)].all()
    assert seen.sum() >= np.sum(free)
    apart = Communication("sight").contacts(world, house.checkpoints[[0, 5]])
    assert apart.tolist() == [[True, False], [False, True]]


@pytest.fixture(scope="module")
def scattered(office: CellMap) -> Episode:
    team = Team(pursuers=2, start=(1, 60), communication=Communication("range", 4.0))
    return run_episode(office.plan, office, team, seed=2, capture="cell", timing=Timing(limit=20.0))


def test_beliefs_part_out_of_reach(scattered: Episode) -> None:
    own, pooled = scattered.own_beliefs, scattered.beliefs
    np.testing.assert_allclose(own.sum(axis=2), 1.0)
    apart = np.hypot(*(scattered.pursuers[:, 0] - scattered.pursuers[:, 1]).T)
    assert apart.min() > 4.0
    assert (own[-1, :, 0] < pooled[-1, 0]).all()
    P = AreaSpeedDegree().matrix(SearchGraph.from_cells(scattered.cells), 1.0)
    belief = own[0, 1]
    for k in range(1, len(own)):
        row = np.eye(len(scattered.cells))[scattered.pursuer_cells[10 * k, 1]]
        belief = advance(belief, P, row[np.newaxis])
        np.testing.assert_allclose(own[k, 1], belief, atol=1e-12)


def test_an_own_belief_is_drawn_when_asked(scattered: Episode, tmp_path) -> None:
    first, second, all_looks = (
        draw_frame(scattered, 15.0, FrameStyle(size=(640, 360), belief_of=who)) for who in (1, 2, None)
    )
    assert (first != second).any()
    assert (first != all_looks).any()
    with pytest.raises(DrawingError, match="no robot 3; robots are numbered from 1 to 2"):
        draw_frame(scattered, 0.0, FrameStyle(belief_of=3))
    again = Episode.load(scattered.save(tmp_path / "episode.npz"))
    np.testing.assert_array_equal(again.own_beliefs, scattered.own_beliefs)


def test_where_one_planned_for_all_there_is_no_own_belief(pursuit: Episode) -> None:
    with pytest.raises(DrawingError, match="one planner planned for all"):
        draw_frame(pursuit, 0.0, FrameStyle(belief_of=1))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (("everyone",), "no communication 'everyone'"),
        (("range",), "needs to know the range"),
        (("full", 3.0), "'full' has no range, but 3 m are given"),
        (("sight", -1.0), "must be positive, but is -1 m"),
    ],
)
def test_communication_that_cannot_be_is_refused(given: tuple[object, ...], message: str) -> None:
    with pytest.raises(GeomsimError, match=message):
        Communication(*given)
    assert Communication("sight").range == math.inf


def test_a_team_that_hears_nothing_still_searches(office: CellMap) -> None:
    team = Team(pursuers=2, planner=Decoupled(depth=2), communication=Communication("sight", 0.5))
    episode = run_episode(office.plan, office, team, seed=5, capture="cell", timing=Timing(limit=30.0))
    assert set(episode.decision_pursuers.tolist()) == {0, 1}
