"""Exact predictions from the command line: floor plans and edge lists."""

import json
from pathlib import Path

import pytest

from geomsim import Stationary, Team, Timing, run_episode
from geomsim.cli import main
from geomsim.prediction import predict_scenario
from maps import GeomsimError

PATH_OF_THREE = {"vertices": 3, "edges": [[0, 1], [1, 2]]}


@pytest.fixture
def graph(tmp_path: Path) -> str:
    path = tmp_path / "path.json"
    path.write_text(json.dumps(PATH_OF_THREE))
    return str(path)


def test_a_stationary_pursuer_by_hand(graph: str) -> None:
    """One pursuer at the end of a path of three cells; the evader starts in one of the other two.

    Let a, b be the expected times from the middle and the far end: a = 1 + (a + b) / 3, b = 1 + (a + b) / 2.
    """
    b = 7.0
    a = (1 + b / 3) * 3 / 2
    assert b == pytest.approx(1 + (a + b) / 2)
    told = predict_scenario(None, {"plan": graph, "planner": "stationary", "pursuers": 1, "start": (0,)})
    assert told.predictions[0].expected_time == pytest.approx((a + b) / 2, rel=1e-9)
    assert (told.first, told.unit) == (0, "steps")


@pytest.mark.parametrize(
    ("name", "planner", "expected"),
    [
        ("office-60", "stationary", 296.24),
        ("office-60", "random", 56.80),
        ("museum-70", "stationary", 404.77),
        ("museum-70", "random", 92.61),
    ],
)
def test_published_graphs(name: str, planner: str, expected: float) -> None:
    """Figures computed independently of this package; means over all common starts."""
    path = Path(__file__).resolve().parents[2] / "shared" / "graphs" / f"{name}.json"
    if not path.exists():
        pytest.skip("no shared graphs beside the project")
    told = predict_scenario(None, {"plan": str(path), "planner": planner}, everywhere=True)
    times = [p.expected_time for p in told.predictions]
    assert sum(times) / len(times) == pytest.approx(expected, rel=1e-3)


def test_json(graph: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main(["predict", graph, "--start", "all", "--pursuers", "1", "--json"])
    out, err = capsys.readouterr()
    assert (stop.value.code, err, out.count("\n")) == (0, "", 1)
    told = json.loads(out)
    assert {"expected_time", "captured_share", "plans", "seconds_per_plan", "per_start", "lower_bound"} <= set(told)
    assert [row["start"] for row in told["per_start"]] == [[0], [1], [2]]
    assert told["expected_time"] == pytest.approx(sum(row["expected_time"] for row in told["per_start"]) / 3)
    assert all(row["lower_bound"] <= row["expected_time"] + 1e-9 for row in told["per_start"])


def test_a_plan_counts_cells_from_1(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["predict", "house", "--start", "1,7", "--json"])
    told = json.loads(capsys.readouterr().out)
    assert told["per_start"][0]["start"] == [1, 7]
    assert told["plans"][0][0][0] in (4, 8)
    assert told["plans"][0][1][0] in (5, 6)


def test_the_prediction_is_the_beliefs_own(house) -> None:
    """A team that stands: what predict says is what the belief of a run says, second by second."""
    keys = {"plan": "house", "planner": "stationary", "start": (1, 3)}
    survival = predict_scenario(None, keys).predictions[0].survival
    team = Team(planner=Stationary(), start=(1, 3))
    for seed in range(20):
        episode = run_episode(house.plan, house, team, seed=seed, timing=Timing(limit=30.0))
        n = min(len(survival), len(episode.beliefs))
        assert 1 - episode.beliefs[:n, 0] == pytest.approx(survival[:n], abs=1e-9)


@pytest.mark.parametrize(
    ("content", "keys", "sentence"),
    [
        (PATH_OF_THREE, {"start": (3,)}, "There is no vertex 3: those of"),
        (PATH_OF_THREE, {"start": (0, 1, 2)}, "3 start vertices are given for 2 pursuers"),
        ({"vertices": 2, "edges": [[0, 2]]}, {}, "names a vertex outside 0 to 1"),
        ({"vertices": 4, "edges": [[0, 1], [2, 3]]}, {"start": (0,)}, "reach"),
        ({"vertices": 0, "edges": []}, {}, "'vertices' must be a whole number above 0"),
        ({"vertices": 2, "edges": "x"}, {}, "'edges' must be a list"),
    ],
)
def test_what_cannot_be_predicted_is_refused(
    tmp_path: Path, content: dict[str, object], keys: dict[str, object], sentence: str
) -> None:
    path = tmp_path / "graph.json"
    path.write_text(json.dumps(content))
    with pytest.raises(GeomsimError, match=sentence):
        predict_scenario(None, {"plan": str(path), "planner": "stationary", **keys})
