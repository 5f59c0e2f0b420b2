"""Robots that differ from each other, and more than one evader."""

import math

import numpy as np
import pytest

from discretize import CellMap
from geomsim import (
    Episode,
    Evader,
    GeomsimError,
    Sensor,
    Stationary,
    Status,
    Still,
    Team,
    Timing,
    read_scenario,
    run_episode,
)
from geomsim.drawing.moment import Timeline
from geomsim.drawing.sight import Sight, eyes
from planners import Random


@pytest.fixture(scope="module")
def two(house: CellMap) -> Episode:
    return run_episode(house.plan, house, Team(start=(1, 7)), Evader(count=3), seed=3, capture="cell")


def test_every_evader_is_captured_once_and_then_stays(two: Episode) -> None:
    captures = two.outcome.captures
    assert two.outcome.status is Status.CAPTURED
    assert sorted(c.evader for c in captures) == [0, 1, 2]
    assert [c.time for c in captures] == sorted(c.time for c in captures)
    assert captures[-1].time == two.times[-1] == two.outcome.time
    for c in captures:
        k = round(c.time / 0.1)
        np.testing.assert_allclose(two.evaders[k, c.evader], c.position)
        np.testing.assert_array_equal(np.ptp(two.evaders[k:, c.evader], axis=0), 0.0)
        assert two.pursuer_cells[k, c.pursuer] == two.evaders_cells[k, c.evader] == c.cell
        before = two.pursuer_cells[:k] == two.evaders_cells[:k, [c.evader]]
        assert not before.any()
    assert str(two).startswith("3 of 3 evaders captured, the last one after")


def test_the_first_of_several_evaders_goes_as_it_would_alone(house: CellMap, two: Episode) -> None:
    alone = run_episode(house.plan, house, Team(start=(1, 7)), seed=3, capture="cell")
    steps = len(alone.times)
    np.testing.assert_array_equal(alone.evader, two.evader[:steps])
    first = next(c for c in two.outcome.captures if c.evader == 0)
    assert first.time == alone.outcome.time
    paths = {two.evaders[:, k].tobytes() for k in range(3)}
    assert len(paths) == 3


def test_some_may_be_left_at_the_time_limit(house: CellMap) -> None:
    team = Team(planner=Stationary(), start=(7,))
    episode = run_episode(
        house.plan, house, team, Evader(count=4, model=Still()), seed=1, capture="sight", timing=Timing(limit=3.0)
    )
    caught = len(episode.outcome.captures)
    assert 0 < caught < 4
    assert episode.outcome.status is Status.TIME_LIMIT
    assert str(episode) == f"{caught} of 4 evaders captured in 3.0 s"


def test_several_evaders_are_recorded_and_drawn(two: Episode, tmp_path) -> None:
    again = Episode.load(two.save(tmp_path / "two.npz"))
    assert again.outcome == two.outcome
    np.testing.assert_array_equal(again.evaders, two.evaders)
    first = two.outcome.captures[0]
    moment = Timeline(two).at(first.time)
    assert [c.evader for c in moment.captures] == [first.evader]
    assert not moment.captured
    assert two.save_replay(tmp_path / "two.html").read_text().count("E${k + 1}")


def test_robots_have_speeds_and_sensors_of_their_own(house: CellMap) -> None:
    team = Team(
        pursuers=2,
        planner=Random(),
        start=(1, 7),
        speed=(1.0, 0.4),
        sensor=(Sensor(range=0.5), Sensor(field_of_view=math.pi / 2)),
    )
    episode = run_episode(house.plan, house, team, Evader(start=3), seed=2, timing=Timing(limit=15.0))
    gone = np.hypot(*np.moveaxis(np.diff(episode.pursuers, axis=0), -1, 0)) / 0.1
    assert gone[:, 0].max() == pytest.approx(1.0, abs=1e-6)
    assert gone[:, 1].max() == pytest.approx(0.4, abs=1e-6)
    assert eyes(episode) == [(0.5, math.tau), (math.inf, pytest.approx(math.pi / 2))]
    moment = Timeline(episode).at(5.0)
    near, wide = (Sight(episode).area(moment, k) for k in (0, 1))
    assert np.hypot(*(near - moment.pursuers[0]).T).max() <= 0.5 + 1e-9
    assert np.hypot(*(wide - moment.pursuers[1]).T).max() > 0.5


def test_only_the_robot_that_can_see_captures(house: CellMap) -> None:
    """Two robots in one place before a still evader in view: whoever sees far enough is the captor."""
    for reach, captor in (((0.1, math.inf), 1), ((math.inf, 0.1), 0)):
        team = Team(start=(4,), planner=Stationary(), sensor=tuple(Sensor(range=r) for r in reach))
        episode = run_episode(house.plan, house, team, Evader(start=1), seed=0, timing=Timing(limit=60.0))
        assert episode.outcome.pursuer == captor


@pytest.mark.parametrize(
    "keys", [{"belief_capture": "cell"}, {"belief_capture": "sight"}, {"checkpoints": "boundaries"}]
)
def test_a_scenario_repeats_a_team_of_different_robots(house: CellMap, keys: dict[str, str], tmp_path) -> None:
    told = read_scenario(
        None, {"plan": "house", "speed": (1.0, 0.5), "range": (3.0, 8.0), "detection": 0.9, "evaders": 2, **keys}
    )
    file = tmp_path / "scenario.toml"
    file.write_text(told.as_toml())
    again = read_scenario(file, {})
    assert again == told.model_copy(update={"options": again.options, "cost": again.cost, "depth": again.depth})
    assert again.team() == told.team()
    episode = run_episode(house.plan, house, told.team(), told.quarry(), seed=1, timing=Timing(limit=20.0))
    assert episode.scenario["speed"] == [1.0, 0.5]
    assert episode.scenario["range"] == [3.0, 8.0]
    assert episode.scenario["detection"] == 0.9
    np.testing.assert_allclose(episode.beliefs.sum(axis=1), 1.0)
    assert (np.diff(episode.beliefs[:, 0]) >= -1e-12).all()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Team(pursuers=3, speed=(1.0, 2.0)), "2 speeds are given for 3 pursuers: give one, or one each"),
        (lambda: Team(sensor=(Sensor(),)), "1 sensors are given for 2 pursuers"),
        (lambda: Team(speed=(1.0, 0.0)), "speed of the pursuer must be positive"),
        (lambda: Team(believes="sigth"), "no believed capture 'sigth'; did you mean 'sight'"),
        (lambda: Team(checkpoints="doors"), "no kind of checkpoints 'doors'"),
        (lambda: Evader(count=0), "at least one evader, but 0"),
        (lambda: read_scenario(None, {"range": (1.0, 2.0)}).model_copy(update={"pursuers": 3}).team(), "range has 2"),
        (lambda: read_scenario(None, {"speed": (1.0, -2.0)}), "--speed should be greater than 0, but is -2"),
        (lambda: read_scenario(None, {"detection": (0.5, 2.0)}), "--detection should be less than or equal to 1"),
    ],
)
def test_what_cannot_be_is_refused(make, message: str) -> None:
    with pytest.raises(GeomsimError, match=message):
        make()
