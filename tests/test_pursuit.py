"""The episode loop: what it does, that it repeats, and that belief, bodies and capture agree."""

import math

import numpy as np
import pytest
import shapely

from discretize import CellMap, convex_cells
from geomsim import (
    Decoupled,
    Evader,
    GeomsimError,
    Random,
    Sensor,
    Stationary,
    Status,
    Still,
    Team,
    Timing,
    run_episode,
)
from geomsim.world import count_wall_crossings
from maps import read_plan
from planners import AreaSpeedDegree, SearchGraph

PLANNERS = [Decoupled(), Decoupled(cost="target-probability", depth=3), Random(), Stationary()]


@pytest.mark.parametrize("planner", PLANNERS, ids=repr)
@pytest.mark.parametrize("capture", ["sight", "cell"])
def test_an_episode_holds_together(office: CellMap, planner: object, capture: str) -> None:
    team = Team(pursuers=3, planner=planner)
    timing = Timing(limit=120.0)
    episode = run_episode(office.plan, office, team, seed=3, capture=capture, timing=timing)
    n, t = len(office), len(episode.times)

    bodies = np.concatenate([episode.pursuers, episode.evader[:, np.newaxis]], axis=1)
    assert count_wall_crossings(bodies, office.plan.walls) == 0
    speed = np.hypot(*np.moveaxis(np.diff(bodies, axis=0), -1, 0)) / 0.1
    assert speed.max() <= 1.0 + 1e-6
    cells = np.concatenate([episode.pursuer_cells, episode.evader_cells[:, np.newaxis]], axis=1)
    for body in range(4):
        inside = [
            office.cells[c].distance(shapely.Point(p)) for c, p in zip(cells[:, body], bodies[:, body], strict=True)
        ]
        assert max(inside) < 0.11  # the cell changes within one physics step of the body's crossing

    assert episode.times == pytest.approx(0.1 * np.arange(t))
    assert episode.belief_times == pytest.approx(np.arange(math.floor(episode.times[-1] + 1e-9) + 1))
    assert episode.beliefs.shape == (len(episode.belief_times), n + 1)
    assert episode.beliefs.sum(axis=1) == pytest.approx(1.0)
    assert (np.diff(episode.beliefs[:, 0]) >= -1e-12).all()  # nobody escapes from the capture state
    assert episode.outcome.notes == ()

    out = episode.outcome
    assert out.time == episode.times[-1]
    assert out.predicted == episode.beliefs[-1, 0]
    if out.captured:
        assert out.cell == episode.evader_cells[-1]
        assert out.position == pytest.approx(episode.evader[-1])
        if capture == "cell":
            assert episode.pursuer_cells[-1, out.pursuer] == out.cell
            assert (episode.pursuer_cells[:-1] != episode.evader_cells[:-1, np.newaxis]).all()
        else:
            way = shapely.LineString([episode.pursuers[-1, out.pursuer], episode.evader[-1]])
            assert office.plan.space.covers(way)
    else:
        assert out.status is Status.TIME_LIMIT
        assert out.time == pytest.approx(120.0)


@pytest.mark.parametrize("planner", PLANNERS, ids=repr)
def test_the_same_seed_gives_the_same_episode(house: CellMap, planner: object) -> None:
    team = Team(planner=planner)
    once, again = (run_episode(house.plan, house, team, seed=5, timing=Timing(limit=60.0)) for _ in range(2))
    for name in ("pursuers", "headings", "evader", "beliefs", "pursuer_cells", "decision_times", "decision_pursuers"):
        assert np.array_equal(getattr(once, name), getattr(again, name))
    assert once.outcome == again.outcome
    other = run_episode(house.plan, house, team, seed=6, timing=Timing(limit=60.0))
    assert not np.array_equal(once.evader[: len(other.times)], other.evader[: len(once.times)])


def test_the_team_does_not_know_where_the_evader_is(office: CellMap) -> None:
    """Two evaders, one team: until the first capture the team does the same."""
    timing = Timing(limit=100.0)
    runs = [
        run_episode(office.plan, office, Team(), Evader(start=start), seed=2, timing=timing, capture="cell")
        for start in (1, 30)
    ]
    shortest = min(len(run.times) for run in runs)
    assert shortest > 40
    assert np.array_equal(runs[0].pursuers[:shortest], runs[1].pursuers[:shortest])


def test_the_belief_is_that_of_equation_3(office: CellMap) -> None:
    """Recompute it from the recorded cells of the pursuers with dense matrices."""
    episode = run_episode(office.plan, office, Team(), seed=4, capture="cell")
    transition = AreaSpeedDegree(1.0).matrix(SearchGraph.from_cells(office), 1.0).toarray()
    p = episode.beliefs[0]
    assert p[0] == 0
    assert set(np.flatnonzero(p == 0)) == {0, *(c + 1 for c in episode.pursuer_cells[0])}
    for k in range(1, len(episode.beliefs)):
        p = p @ transition
        for cell in episode.pursuer_cells[10 * k]:
            capture = np.eye(len(office) + 1)
            capture[cell + 1, cell + 1], capture[cell + 1, 0] = 0.0, 1.0
            p = p @ capture
        assert episode.beliefs[k] == pytest.approx(p, abs=1e-12)


def test_decisions_are_followed(house: CellMap) -> None:
    episode = run_episode(house.plan, house, Team(), seed=1, capture="cell")
    for who in range(2):
        visited = [
            c for k, c in enumerate(episode.pursuer_cells[:, who]) if k == 0 or c != episode.pursuer_cells[k - 1, who]
        ]
        chosen = [
            path[0] for path, i in zip(episode.decision_paths, episode.decision_pursuers, strict=True) if i == who
        ]
        assert visited[1:] == chosen[: len(visited) - 1]


def test_a_stationary_team_stays(house: CellMap) -> None:
    episode = run_episode(
        house.plan,
        house,
        Team(planner=Stationary(), start=(1, 7)),
        Evader(model=Still(), start=3),
        timing=Timing(limit=30),
    )
    assert np.ptp(episode.pursuers, axis=0) == pytest.approx(0.0)
    assert not episode.outcome.captured


def test_a_short_range_sees_later(house: CellMap) -> None:
    """With the same bodies, what a short-sighted robot sees a far-sighted one has seen."""
    times = {
        reach: run_episode(house.plan, house, Team(sensor=Sensor(range=reach), start=(7,)), Evader(start=1), seed=3)
        for reach in (math.inf, 3.0, 1.0)
    }
    captured = [times[reach].outcome.time for reach in (math.inf, 3.0, 1.0)]
    assert captured == sorted(captured)
    last = times[1.0]
    gap = np.hypot(*(last.pursuers[-1, last.outcome.pursuer] - last.evader[-1]))
    assert gap <= 1.0


def test_an_evader_in_sight_at_the_start_is_captured_at_once(house: CellMap) -> None:
    episode = run_episode(house.plan, house, Team(start=(4,)), Evader(start=4))
    assert (episode.outcome.time, episode.outcome.captured, len(episode.times)) == (0.0, True, 1)


def test_interruption_keeps_what_there_is(house: CellMap) -> None:
    def stop(time: float, _: float) -> None:
        if time >= 10:
            raise KeyboardInterrupt

    team = Team(planner=Stationary(), start=(7,))
    episode = run_episode(house.plan, house, team, Evader(model=Still(), start=3), progress=stop)
    assert episode.outcome.status is Status.INTERRUPTED
    assert episode.times[-1] == pytest.approx(10.0)
    assert len(episode.pursuers) == len(episode.times)


@pytest.mark.parametrize(
    ("team", "evader", "options", "sentence"),
    [
        ({"start": (10,)}, {}, {}, "There is no start cell 10: the cells of 'house' are numbered from 1 to 9."),
        ({"start": (0,)}, {}, {}, "There is no start cell 0"),
        ({"start": (1, 2, 3)}, {}, {}, "3 start cells are given for 2 pursuers"),
        ({"pursuers": 9, "start": tuple(range(1, 10))}, {}, {}, "no cell is left for the evader"),
        ({}, {"start": 12}, {}, "There is no evader's start cell 12"),
        ({"radius": 0.4}, {}, {}, "larger than the 0.2 m"),
        ({}, {}, {"capture": "sigth"}, "did you mean 'sight'"),
        ({"speed": 5.0}, {}, {}, "might miss a wall"),
    ],
)
def test_what_cannot_be_run_is_refused(
    house: CellMap, team: dict[str, object], evader: dict[str, object], options: dict[str, str], sentence: str
) -> None:
    with pytest.raises(GeomsimError, match=sentence.replace("(", r"\(")):
        run_episode(house.plan, house, Team(**team), Evader(**evader), **options)


@pytest.mark.parametrize("bad", [{"pursuers": 0}, {"speed": 0.0}, {"speed": math.nan}, {"radius": -1.0}])
def test_an_impossible_team_is_refused(bad: dict[str, float]) -> None:
    with pytest.raises(GeomsimError):
        Team(**bad)


@pytest.mark.parametrize("bad", [{"limit": 0.0}, {"physics_step": 0.3}, {"belief_step": 0.05}, {"limit": math.inf}])
def test_impossible_clocks_are_refused(bad: dict[str, float]) -> None:
    with pytest.raises(GeomsimError):
        Timing(**bad)


def test_parts_that_are_not_joined(tmp_path) -> None:
    """Two pairs of rooms with nothing between them."""
    rooms = [[0, 0, 4, 4], [4, 1.5, 8, 2.5], [20, 0, 23, 4], [23, 1.5, 26, 2.5]]
    file = tmp_path / "apart.geojson"
    file.write_text(shapely.to_geojson(shapely.union_all([shapely.box(*r) for r in rooms])))
    cells = convex_cells(read_plan(str(file)))
    assert sorted(set(cells.components.tolist())) == [0, 1]
    here, there = (int(np.flatnonzero(cells.components == c)[0]) + 1 for c in (0, 1))
    with pytest.raises(GeomsimError, match=f"Start cell {there} is in a part of the building that cannot be reached"):
        run_episode(cells.plan, cells, Team(start=(here, there)))
    with pytest.raises(GeomsimError, match=f"start cell {there} is in a part of the building that cannot be reached"):
        run_episode(cells.plan, cells, Team(start=(here,)), Evader(start=there))
    episode = run_episode(cells.plan, cells, Team(pursuers=1, start=(here,)), seed=1)
    assert cells.components[episode.evader_cells[0]] == cells.components[here - 1]
