"""Scenario files: every key is checked, flags override, and what is given back repeats the run."""

import math
import tomllib
from dataclasses import fields
from pathlib import Path

import pytest

from geomsim import Decoupled, Evader, Random, Scenario, Sensor, Team, Timing, read_scenario, run_episode
from geomsim.cli.flags import ScenarioFlags
from geomsim.scenario import ScenarioError


def write(folder: Path, text: str) -> Path:
    path = folder / "scenario.toml"
    path.write_text(text)
    return path


def test_every_key_is_a_flag() -> None:
    assert {f.name for f in fields(ScenarioFlags)} | {"plan"} == set(Scenario.model_fields)


def test_flags_override_the_file(tmp_path: Path) -> None:
    path = write(tmp_path, 'plan = "house"\nseed = 3\nstart = [1, 2]\ncost = "target-probability"\n')
    told = read_scenario(path, {"seed": 9, "pursuers": 3, "start": (1, 2, 3)})
    assert (told.plan, told.seed, told.pursuers, told.start, told.cost) == (
        "house",
        9,
        3,
        (1, 2, 3),
        "target-probability",
    )


def test_what_is_given_back_is_a_scenario_file(tmp_path: Path) -> None:
    told = Scenario(plan="house", seed=4, start=(1, 2), range=5.0, planner="random", evader_start=7)
    again = read_scenario(write(tmp_path, told.as_toml()), {})
    assert again == told
    assert tomllib.loads(told.as_toml()) == told.as_dict()


def test_defaults_of_the_planner_are_told() -> None:
    told = Scenario().as_dict()
    assert (told["planner"], told["cost"], told["depth"]) == ("decoupled", "entropy", 5)
    assert "range" not in told  # TOML and JSON have no plain word for no limit
    assert "cost" not in Scenario(planner="random").as_dict()


@pytest.mark.parametrize(
    "scenario",
    [
        Scenario(plan="house", start=(4, 4)),
        Scenario(plan="house", start=(1, 2), planner="random", seed=3, range=4.0, fov_degrees=90.0, motion="uniform"),
        Scenario(plan="house", start=(1,), pursuers=1, capture="cell", evader="still", evader_start=7, time_limit=60.0),
    ],
)
def test_a_run_from_python_tells_the_same_as_its_scenario(scenario: Scenario) -> None:
    plan, cells = scenario.place()
    episode = run_episode(
        plan,
        cells,
        scenario.team(),
        scenario.quarry(),
        seed=scenario.seed,
        capture=scenario.capture,
        motion=scenario.belief_motion(),
        timing=scenario.timing(),
    )
    assert episode.scenario == scenario.as_dict()


def test_defaults_in_python_are_those_of_the_scenario() -> None:
    scenario = Scenario()
    assert scenario.team() == Team()
    assert scenario.quarry() == Evader()
    assert scenario.timing() == Timing()
    assert Scenario(fov_degrees=90.0, range=3.0, planner="random").team() == Team(
        planner=Random(), sensor=Sensor(3.0, math.pi / 2)
    )
    assert Scenario(cost="probability", depth=1).team().planner == Decoupled(cost="probability", depth=1)


def test_a_plan_beside_the_scenario_is_found(tmp_path: Path) -> None:
    (tmp_path / "mine.geojson").write_text('{"type": "Polygon", "coordinates": [[[0,0],[9,0],[9,4],[0,4],[0,0]]]}')
    told = read_scenario(write(tmp_path, 'plan = "mine.geojson"'), {})
    assert Path(told.plan) == tmp_path / "mine.geojson"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("pursuer = 2", "unknown key 'pursuer'; did you mean 'pursuers'?"),
        ("[team]\npursuers = 2", "unknown key 'team'"),
        ("pursuers = 'two'", "pursuers should be a valid integer, but is 'two'."),
        ("pursuers = 0", "pursuers should be greater than or equal to 1, but is 0."),
        ("pursuers = 2.5", "pursuers should be a valid integer"),
        ("seed = -1", "seed should be greater than or equal to 0"),
        ("speed = nan", "speed should be a finite number"),
        ("speed = inf", "speed should be a finite number"),
        ("radius = 0", "radius should be greater than 0"),
        ("fov_degrees = 400", "fov_degrees should be less than or equal to 360"),
        ("start = [1, 'x']", "start should be a valid integer"),
        ("capture = 'sihgt'", "capture is not 'sihgt': did you mean 'sight'?"),
        ("motion = 'none'", "motion is not 'none': choose one of"),
        ("evader = 'stil'", "did you mean 'still'?"),
        ("time_limit = 0.0", "time_limit should be greater than 0"),
        ("plan = 7", "plan should be a valid string"),
        ("plan = ", "is not valid TOML"),
    ],
)
def test_wrong_files_are_refused(tmp_path: Path, text: str, sentence: str) -> None:
    path = write(tmp_path, text)
    with pytest.raises(ScenarioError) as caught:
        read_scenario(path, {})
    assert sentence in str(caught.value)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_wrong_flag_is_named_as_a_flag() -> None:
    with pytest.raises(ScenarioError, match="--fov-degrees should be less than or equal to 360, but is 400"):
        read_scenario(None, {"fov_degrees": 400.0})


@pytest.mark.parametrize("content", [None, b"\xff\xfe\x00"])
def test_unreadable_files_are_refused(tmp_path: Path, content: bytes | None) -> None:
    path = tmp_path / "scenario.toml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(ScenarioError, match=r"scenario\.toml"):
        read_scenario(path, {})
