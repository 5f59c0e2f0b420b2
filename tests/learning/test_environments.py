"""The environments pass the conformance tests of PettingZoo and Gymnasium, and planners in them do as in an episode."""

import warnings

import numpy as np
import pytest
import shapely

pytest.importorskip("gymnasium")
pytest.importorskip("pettingzoo")

import gymnasium
from gymnasium.utils.env_checker import check_env
from pettingzoo.test import parallel_api_test, parallel_seed_test

import geomsim as gs
from discretize import CellMap
from geomsim.learning import CentralEnv, PlannerAgents, PursuitEnv
from maps import GeomsimError

CONTROLS = ["checkpoint", "velocity"]
SHORT = {"plan": "house", "time_limit": 60.0}


@pytest.mark.parametrize("control", CONTROLS)
def test_pettingzoo_says_that_it_conforms(control: str) -> None:
    parallel_api_test(PursuitEnv(control, **SHORT), num_cycles=60)


@pytest.mark.parametrize("control", CONTROLS)
def test_pettingzoo_says_that_seeds_hold(control: str) -> None:
    parallel_seed_test(lambda: PursuitEnv(control, **SHORT), num_cycles=20)


@pytest.mark.parametrize("control", CONTROLS)
def test_gymnasium_says_that_it_conforms(control: str) -> None:
    made = gymnasium.make("geomsim/Pursuit-v0", control=control, render_mode="rgb_array", **SHORT)
    with warnings.catch_warnings():
        # asks for normalised actions and flat observations, which are matters of taste
        warnings.filterwarnings("ignore", message=".*(We recommend|not have any).*", category=UserWarning)
        check_env(made.unwrapped)
    made.close()


PLANNERS = [gs.Decoupled(), gs.Decoupled(cost="target-probability", depth=2), gs.Random(), gs.Stationary()]


@pytest.mark.parametrize("planner", PLANNERS, ids=repr)
@pytest.mark.parametrize("capture", ["cell", "sight"])
@pytest.mark.parametrize("seed", [1, 2])
def test_planners_capture_when_they_do_in_an_episode(house: CellMap, planner, capture: str, seed: int) -> None:
    team = gs.Team(pursuers=2, planner=planner)
    timing = gs.Timing(limit=200.0)
    episode = gs.run_episode(house.plan, house, team, seed=seed, capture=capture, timing=timing)
    keys = {"plan": "house", "pursuers": 2, "capture": capture, "time_limit": 200.0}

    parallel = PursuitEnv(**keys)
    parallel.reset(seed=seed)
    agents, total = PlannerAgents(parallel, planner), 0.0
    while parallel.agents:
        _, rewards, terminated, truncated, infos = parallel.step(agents.acts())
        total += rewards["robot_1"]
    assert infos["robot_1"]["time"] == episode.outcome.time
    assert infos["robot_2"]["captured_by"] == episode.outcome.pursuer
    assert (terminated["robot_1"], truncated["robot_1"]) == (episode.outcome.captured, not episode.outcome.captured)
    assert total == pytest.approx(-episode.outcome.time)
    assert np.array_equal(parallel.hunt.episode().evader, episode.evader)
    assert np.array_equal(parallel.hunt.episode().pursuers, episode.pursuers)

    central = CentralEnv(**keys)
    central.reset(seed=seed)
    agent, over = PlannerAgents(central, planner), False
    while not over:
        _, _, terminated, truncated, info = central.step(agent.act())
        over = terminated or truncated
    assert info["time"] == episode.outcome.time


def test_one_planner_acts_in_one_pursuit_after_another(house: CellMap) -> None:
    env = PursuitEnv(plan="house", capture="cell")
    agents = PlannerAgents(env, gs.Random())
    for seed in (4, 5, 4):
        env.reset(seed=seed)
        while env.agents:
            _, _, _, _, infos = env.step(agents.acts())
        expected = gs.run_episode(
            house.plan, house, gs.Team(pursuers=2, planner=gs.Random()), seed=seed, capture="cell"
        )
        assert infos["robot_1"]["time"] == expected.outcome.time


def test_gymnasium_runs_several_at_once() -> None:
    several = gymnasium.make_vec("geomsim/Pursuit-v0", num_envs=3, vectorization_mode="sync", **SHORT)
    seen, _ = several.reset(seed=7)
    assert seen["belief"].shape == (3, 10)
    several.action_space.seed(1)
    for _ in range(5):
        seen, rewards, _, _, _ = several.step(several.action_space.sample())
        assert rewards.shape == (3,)
        assert (rewards <= 0).all()
    several.close()


def test_observations_are_of_what_happens() -> None:
    env = PursuitEnv(plan="house", pursuers=3, start=(1, 4, 7))
    seen, _ = env.reset(seed=3)
    places = env.hunt.work.positions[0]
    for k, agent in enumerate(env.agents):
        view = seen[agent]
        assert env.observation_space(agent).contains(view)
        assert view["places"][0] == pytest.approx(places[k], abs=1e-5)
        assert view["cells"][0] == (0, 3, 6)[k]
        assert view["seen"][view["cells"][0]] == 1
        assert 0 < view["seen"].sum() < len(env.hunt.cells)
        assert view["belief"].sum() == pytest.approx(1, abs=1e-5)
        assert view["action_mask"].sum() == 1 + len(env.hunt.work.routes.neighbours[view["cells"][0]])


def test_a_robot_on_its_way_has_no_choice_and_is_not_turned_round() -> None:
    env = PursuitEnv(plan="house", start=(1, 7), evader="still", evader_start=5, capture="cell")
    env.reset(seed=3)
    seen, _, _, _, _ = env.step({"robot_1": 0, "robot_2": 1})
    assert seen["robot_2"]["action_mask"].tolist()[:2] == [1, 0]
    goal = env.hunt.work.goals[0, 1]
    env.step({"robot_1": 0, "robot_2": 2})
    assert env.hunt.work.goals[0, 1] == goal


def test_velocities_move_robots_and_walls_stop_them() -> None:
    env = PursuitEnv("velocity", plan="house", pursuers=1, start=(1,), evader="still", evader_start=5, capture="cell")
    env.reset(seed=1)
    before = env.hunt.work.positions[0, 0]
    env.step({"robot_1": np.array([0.3, -0.4], np.float32)})
    assert env.hunt.work.positions[0, 0] - before == pytest.approx([0.3, -0.4], abs=0.06)
    for _ in range(12):
        env.step({"robot_1": np.array([1.0, 1.0], np.float32)})
    assert env.hunt.cells.plan.space.contains(shapely.Point(env.hunt.work.positions[0, 0]))
    moved = np.hypot(*np.diff(env.hunt.episode().pursuers[:, 0], axis=0).T)
    assert moved.max() <= 0.1 + 1e-9


def test_pictures_are_drawn() -> None:
    env = PursuitEnv(plan="house", render_mode="rgb_array")
    env.reset(seed=2)
    env.step(dict.fromkeys(env.agents, 1))
    image = env.render()
    assert image.shape == (720, 1280, 3)
    assert image.std() > 10
    assert PursuitEnv(plan="house").render() is None


@pytest.mark.parametrize(
    ("keys", "sentence"),
    [
        ({"control": "checkpoints"}, "did you mean 'checkpoint'"),
        ({"render_mode": "human"}, "rgb_array"),
        ({"plan": "hous"}, "house"),
        ({"pursuer": 2}, "pursuer"),
        ({"pursuers": 0}, "pursuers"),
    ],
)
@pytest.mark.parametrize("env", [PursuitEnv, CentralEnv])
def test_wrong_options_get_one_sentence(env, keys: dict, sentence: str) -> None:
    with pytest.raises(GeomsimError, match=sentence):
        env(**keys)


def test_planners_take_no_velocities() -> None:
    with pytest.raises(GeomsimError, match="choose checkpoints"):
        PlannerAgents(PursuitEnv("velocity", plan="house"), gs.Random())
