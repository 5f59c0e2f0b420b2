"""Teams that believe in places."""

import json
from pathlib import Path

import numpy as np
import pytest

from discretize import CellMap
from geomsim import Evader, GeomsimError, Sensor, Team, run_episode
from geomsim.believing import believed_problem
from geomsim.cli import main
from geomsim.scenario import Scenario, describe
from geomsim.team import place_team
from geomsim.trials import run_trials
from geomsim.trials.methods import parse_method
from planners import (
    AreaSpeedDegree,
    Beam,
    BestResponse,
    Coupled,
    Decoupled,
    Planner,
    Rollout,
    Sequential,
    StationaryMotion,
    UniformMotion,
    check_transition,
    predict,
)

PLANNERS = [
    Decoupled("entropy", 2),
    Decoupled("distance-over-probability", 1),
    Coupled("target-probability", 1),
    BestResponse(horizon=12),
    Sequential(horizon=12),
    Beam(width=10, horizon=20),
    Rollout((Decoupled(depth=1), Decoupled("probability", 1)), horizon=60),
]


@pytest.mark.parametrize("planner", PLANNERS, ids=lambda planner: type(planner).__name__)
def test_planners_plan_on_places(house: CellMap, planner: Planner) -> None:
    team = Team(believes="places")
    _, problem = believed_problem(house, team, AreaSpeedDegree(1.0), 1.0)
    check_transition(problem.motion.matrix(problem.graph, 1.0))
    start = place_team(house, team)
    told = predict(problem, planner, [start], np.random.default_rng(0), longest=200)[0]
    assert told.survival[0] < 1  # a first look from the start
    assert (np.diff(told.survival) <= 1e-12).all()
    assert told.survival[-1] < 0.05


@pytest.mark.parametrize("sensor", [Sensor(), Sensor(4.0, 2.0, 0.5)])
def test_an_episode_with_a_belief_over_places(house: CellMap, sensor: Sensor) -> None:
    team = Team(believes="places", sensor=sensor, planner=Decoupled(depth=2))
    episode = run_episode(house.plan, house, team, Evader(), seed=3)
    assert episode.beliefs.shape[1] == len(house) + 1  # what is recorded and shown are cells
    assert np.allclose(episode.beliefs.sum(axis=1), 1)
    assert (np.diff(episode.beliefs[:, 0]) >= -1e-12).all()


def test_the_belief_needs_a_speed(house: CellMap) -> None:
    with pytest.raises(GeomsimError, match="UniformMotion"):
        believed_problem(house, Team(believes="places"), UniformMotion(), 1.0)


def test_robots_do_not_plan_on_particles(house: CellMap) -> None:
    with pytest.raises(GeomsimError, match="particles"):
        believed_problem(house, Team(believes="particles"), AreaSpeedDegree(1.0), 1.0)


def test_who_stands_is_not_believed_to_move(house: CellMap) -> None:
    _, problem = believed_problem(house, Team(believes="places"), StationaryMotion(), 1.0)
    assert (problem.motion.matrix(problem.graph, 1.0).diagonal() == 1).all()


@pytest.mark.parametrize(
    ("given", "name"),
    [
        ("decoupled-entropy-3-places", "decoupled-entropy-3-places"),
        ("decoupled-places", "decoupled-entropy-5-places"),
        ("best-response-places", "best-response-60-places"),
        ("best-response-12-places", "best-response-12-places"),
        ("random-places", "random-places"),
    ],
)
def test_methods_on_places(given: str, name: str) -> None:
    method = parse_method(given)
    assert (method.name, method.belief) == (name, "places")
    assert parse_method(given.removesuffix("-places")).belief == "cells"


@pytest.mark.parametrize("name", ["places", "-places", "decoupled-entropy-3-place", "decoupled-places-3"])
def test_methods_that_are_none(name: str) -> None:
    with pytest.raises(GeomsimError, match="no method"):
        parse_method(name)


def test_compare_tells_the_belief_of_each_method(house: CellMap) -> None:
    methods = ["decoupled-entropy-1", "decoupled-entropy-1-places", "best-response-places"]
    told = run_trials(house.plan, methods, cells=house, trials=300, workers=1).as_dict()["methods"]
    assert [m["belief"] for m in told] == ["cells", "places", "places"]
    assert all(m["curve_gap"] < 0.11 for m in told)


def test_a_scenario_with_places() -> None:
    scenario = Scenario(belief="places")
    assert scenario.team().believes == "places"
    assert Scenario(belief_capture="sight").team().believes == "sight"
    plan, cells = Scenario(plan="house", belief="places").place()
    told = describe(plan, cells, Team(believes="places"), Evader(), 0, "sight", None, scenario.timing())
    assert told["belief"] == "places"


def test_the_flag(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    argv = ["run", "house", "--belief", "places", "--json", "--no-video", "--out", str(tmp_path)]
    with pytest.raises(SystemExit) as end:
        main(argv)
    assert not end.value.code
    assert json.loads(capsys.readouterr()[0])["scenario"]["belief"] == "places"
    with pytest.raises(SystemExit) as end:
        main(["run", "house", "--belief", "place"])
    assert end.value.code == 2
    assert "places" in capsys.readouterr()[1]
