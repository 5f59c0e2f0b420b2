"""The command line as a person meets it: what it prints, what it writes, how it refuses."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import av
import cv2
import pytest

from geomsim import Episode
from geomsim.cli import main

TWO_ROOMS = {
    "type": "Polygon",
    "coordinates": [
        [
            [0, 0],
            [5, 0],
            [5, 1.5],
            [5.2, 1.5],
            [5.2, 0],
            [10, 0],
            [10, 4],
            [5.2, 4],
            [5.2, 2.5],
            [5, 2.5],
            [5, 4],
            [0, 4],
            [0, 0],
        ]
    ],
}


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    """Run a command in an empty folder; returns exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: object) -> tuple[int, str, str]:
        before = signal.getsignal(signal.SIGTERM)
        with pytest.raises(SystemExit) as stop:
            main([str(a) for a in arguments])
        signal.signal(signal.SIGTERM, before)
        out, err = capsys.readouterr()
        return stop.value.code, out, err

    return run


def test_run_house(call) -> None:
    code, out, err = call("run", "house", "--seed", "3", "--json", "--frames")
    assert (code, err) == (0, "")
    told = json.loads(out)
    assert out.count("\n") == 1
    assert told["captured"] is True
    assert told["capture_time"] > 0
    assert told["captured_by"] in (1, 2)
    assert len(told["capture_position"]) == 2
    assert 0 <= told["predicted_capture_probability"] <= 1
    assert (told["cells"], told["seed"]) == (9, 3)
    assert told["scenario"]["plan"] == "house"
    files = {kind: Path(path) for kind, path in told["files"].items()}
    assert set(files) == {"scenario", "record", "snapshots", "video", "frames"}
    episode = Episode.load(files["record"])
    assert episode.outcome.time == told["capture_time"]
    assert cv2.imread(str(files["snapshots"])).std() > 10
    with av.open(str(files["video"])) as video:
        stream = video.streams.video[0]
        assert (stream.codec_context.name, stream.codec_context.pix_fmt) == ("h264", "yuv420p")
        shown = sum(1 for _ in video.decode(stream))
    pictures = sorted(files["frames"].glob("*.png"))
    assert len(pictures) == shown - 50  # the video holds its last picture for two seconds
    assert cv2.imread(str(pictures[-1])).shape == (720, 1280, 3)
    assert not list(files["record"].parent.rglob("*part*"))

    again = call("run", "--scenario", files["scenario"], "--json", "--no-video", "--no-snapshots", "--out", "again")
    told_again = json.loads(again[1])
    for key in ("capture_time", "captured_by", "capture_position", "predicted_capture_probability", "scenario"):
        assert told_again[key] == told[key]
    assert Path("again/episode.npz").read_bytes() == files["record"].read_bytes()
    assert not Path("again/pursuit.mp4").exists()


def test_run_tells_a_person(call) -> None:
    code, out, err = call("run", "house", "--no-video", "--out", "here")
    assert (code, err) == (0, "")
    for phrase in ("captured after", "by pursuer", "in cell", "belief", "here/episode.npz", "here/snapshots.png"):
        assert phrase in out


def test_render_draws_the_same_again(call) -> None:
    call("run", "house", "--no-video", "--out", "run")
    code, out, _ = call("render", "run/episode.npz", "--no-video", "--out", "again", "--json")
    assert code == 0
    assert json.loads(out)["files"] == {"snapshots": "again/snapshots.png"}
    assert Path("again/snapshots.png").read_bytes() == Path("run/snapshots.png").read_bytes()


def test_discretize_house(call) -> None:
    code, out, err = call("discretize", "house", "--json")
    assert (code, err) == (0, "")
    told = json.loads(out)
    edges = [[1, 4], [1, 8], [2, 8], [2, 9], [3, 4], [4, 5], [4, 6], [4, 9], [5, 7], [6, 7]]
    assert (told["cells"], told["portals"], told["edges"]) == (9, 10, edges)
    assert told["coverage"] == pytest.approx(1.0, abs=1e-9)
    assert told["overlap"] == pytest.approx(0.0, abs=1e-9)
    assert told["convexity"] == pytest.approx(1.0, abs=1e-9)
    assert (told["free_components"], told["graph_components"]) == (1, 1)
    assert (told["repairs"], told["problems"]) == ([], [])
    assert told["area"] > 100
    assert told["seconds"] > 0
    cells = json.loads(Path(told["files"]["cells"]).read_text())
    assert cells["type"] == "FeatureCollection"
    assert cv2.imread(told["files"]["picture"]) is not None
    assert json.loads(Path(told["files"]["report"]).read_text()) == told


def test_a_plan_of_a_persons_own(call, tmp_path: Path) -> None:
    Path("mine.geojson").write_text(json.dumps(TWO_ROOMS))
    code, out, _ = call("run", "mine.geojson", "--pursuers", "1", "--json", "--no-video")
    assert code == 0
    told = json.loads(out)
    assert told["captured"]
    assert told["scenario"]["plan"] == "mine.geojson"


@pytest.mark.parametrize("command", ["maps", "planners"])
def test_listings(call, command: str) -> None:
    code, out, err = call(command, "--json")
    assert (code, err) == (0, "")
    named = [entry["name"] for entry in json.loads(out)[command]]
    assert {"maps": {"house", "office"}, "planners": {"decoupled", "random", "stationary"}}[command] <= set(named)
    code, out, _ = call(command)
    assert all(name in out for name in named)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["run", "offise"], "office"),
        (["run", "no/such/plan.geojson"], "no/such/plan.geojson"),
        (["run", "house", "--planner", "decopled"], "did you mean 'decoupled'?"),
        (["run", "house", "--cost", "entropi"], "entropy"),
        (["run", "house", "--start", "12"], "numbered from 1 to 9"),
        (["run", "house", "--start", "1,2,3"], "3 start cells are given for 2 pursuers"),
        (["run", "house", "--start", "one"], "--start takes cell numbers"),
        (["run", "house", "--radius", "0.6"], "fits through no door"),
        (["run", "house", "--capture", "smell"], "did you mean 'cell'?"),
        (["run", "house", "--pursuers", "0"], "--pursuers"),
        (["run", "house", "--pursuers", "many"], "--pursuers"),
        (["run", "house", "--seeed", "1"], "--seed"),
        (["run", "house", "--scenario", "none.toml"], "none.toml"),
        (["run", "house", "--out", "/dev/null/there"], "/dev/null/there"),
        (["run", "house", "--method", "exakt"], "exact"),
        (["run", "house", "--planner", "random", "--depth", "3"], "depth"),
        (["discretize", "offise"], "office"),
        (["discretize"], "plan"),
        (["render", "none.npz"], "none.npz"),
        (["dance"], "dance"),
    ],
)
@pytest.mark.parametrize("extra", [[], ["--json"]])
def test_bad_input_gets_one_sentence(call, arguments: list[str], sentence: str, extra: list[str]) -> None:
    code, out, err = call(*arguments, *extra)
    assert code == 2
    assert out == ""
    assert sentence.lower() in err.lower()
    assert err.startswith("geomsim: ")
    assert err.count("\n") == 1
    assert "Traceback" not in err
    assert list(Path().iterdir()) == []


def test_bad_scenario_files_are_named(call) -> None:
    Path("s.toml").write_text("colour = 3")
    code, out, err = call("run", "--scenario", "s.toml")
    assert (code, out) == (2, "")
    assert err.startswith("geomsim: s.toml: unknown key 'colour'")


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
def test_interruption_keeps_what_was_finished(tmp_path: Path, name: str) -> None:
    """A team that will not find its evader, stopped in mid-run."""
    arguments = ["run", "house", "--planner", "stationary", "--start", "7", "--evader", "still", "--evader-start", "3"]
    process = subprocess.Popen(
        [
            sys.executable,
            "-c",
            "from geomsim.cli import main; main()",
            *arguments,
            "--time-limit",
            "100000",
            "--out",
            "out",
        ],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
    )
    while not (tmp_path / "out").exists():  # it is made just before the pursuit begins
        time.sleep(0.05)
    time.sleep(1.0)
    process.send_signal(getattr(signal, name))
    out, err = process.communicate(timeout=30)
    assert process.returncode == 130, err
    assert err.startswith("geomsim: Interrupted after ")
    assert err.count("\n") == 1
    assert "interrupted" in out
    episode = Episode.load(tmp_path / "out" / "episode.npz")
    assert episode.outcome.status.name == "INTERRUPTED"
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["episode.npz", "scenario.toml"]


def test_a_foreign_package_of_our_names_is_refused(tmp_path: Path) -> None:
    (tmp_path / "planners.py").write_text("")
    code = "import sys; sys.path.insert(0, '.'); import geomsim"
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(p for p in sys.path if p)},
    )
    assert done.returncode != 0
    assert "geomsim needs its own package 'planners'" in done.stderr
