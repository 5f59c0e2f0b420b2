"""The command line as a person meets it: what it prints, what it writes, how it refuses."""

import errno
import inspect
import json
import os
import shlex
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
from geomsim.cli.flags import PlanFlags, ScenarioFlags
from geomsim.scenario import Scenario
from planners import Decoupled

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
    assert set(files) == {"scenario", "record", "snapshots", "replay", "video", "frames"}
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

    again = call(
        "run",
        "--scenario",
        files["scenario"],
        "--json",
        "--no-video",
        "--no-snapshots",
        "--no-replay",
        "--out",
        "again",
    )
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
    code, out, _ = call("render", "run/episode.npz", "--no-video", "--no-replay", "--out", "again", "--json")
    assert code == 0
    assert json.loads(out)["files"] == {"snapshots": "again/snapshots.png"}
    assert Path("again/snapshots.png").read_bytes() == Path("run/snapshots.png").read_bytes()


def test_render_draws_the_cells_of_a_record(call) -> None:
    call("run", "house", "--no-video", "--no-replay", "--no-snapshots", "--out", "run")
    call("discretize", "house", "--out", "cut")
    few = ["--no-video", "--no-replay", "--no-snapshots", "--cells-picture"]
    assert call("render", "run/episode.npz", *few)[0] == 0
    assert Path("run/cells.png").read_bytes() == Path("cut/cells.png").read_bytes()
    assert call("render", "run/episode.npz", *few, "--snapshots-format", "svg")[0] == 0
    assert "</svg>" in Path("run/cells.svg").read_text()


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
    assert told["scenario"]["plan"] == str(tmp_path / "mine.geojson")  # holds in any folder


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
        (["run", "house", "--evader-start", "12"], "numbered from 1 to 9"),
        (["run", "house", "--speed", "50"], "might miss a wall"),
        (["run", "house", "--evader-speed", "1e308"], "might miss a wall"),
        (["run", "house", "--radius", "1e-308"], "might miss a wall"),
        (["run", "house", "--speed", "1e-308"], "belief steps"),
        (["run", "house", "--time-limit", "1e308"], "recorded positions"),
        (["run", "house", "--physics-step", "1e-9"], "recorded positions"),
        (["run", "house", "--belief-step", "1e308"], "multiple of the physics step"),
        (["run", "house", "--physics-step", "1e-308"], "recorded positions"),
        (["run", "a\nb\x1b[31m"], "a b\\x1b[31m"),
        (["run", "house", "--out", "a\0b"], "output folder"),
        (["run", "house", "--out", "new/" + "x" * 300], "output folder"),
        (["discretize", "house", "--out", "new/" + "x" * 300], "output folder"),
        (["run", "house", "--pursuers", "9" * 5000], "--pursuers"),
        (["run", "house", "--depth", "50"], "the largest depth that would do is"),
        (["run", "house", "--planner", "coupled", "--depth", "50"], "joint paths"),
        (["run", "house", "--radius", "1e308"], "at most 100"),
        (["discretize", "house", "--radius", "1e308"], "at most 100"),
        (["discretize", "x" * 5000], "file name too long"),
        (["run", "house", "--pursuers", "1.5"], "--pursuers"),
        (["run", "house", "--seed", "0.5"], "--seed"),
        (["discretize", "offise"], "office"),
        (["discretize"], "plan"),
        (["render", "none.npz"], "none.npz"),
        (["run", "house", "--video-format", "avi"], "--video-format is not 'avi'"),
        (["run", "house", "--snapshots-format", "gif"], "--snapshots-format is not 'gif'"),
        (["run", "house", "--theme", "dimmed"], "dimmed"),
        (["run", "house", "--size", "1280"], "--size takes width and height"),
        (["run", "house", "--size", "99999x2"], "at most 8192"),
        (["run", "house", "--size", "8x8"], "too small"),
        (["run", "house", "--times", "0,soon"], "--times takes seconds"),
        (["run", "house", "--fps", "0"], "--fps must be above 0"),
        (["run", "house", "--speedup", "nan"], "--speedup must be above 0"),
        (["run", "house", "--speedup", "2", "--length", "9"], "give one of them"),
        (["convert", "house", "house.xyz"], "house.xyz"),
        (["predict", "house", "--start", "12"], "numbered from 1 to 9"),
        (["export", "none.npz"], "none.npz"),
        (["export", "none.npz", "--seed", "2"], "leave out --seed"),
        (["export", "house", "--duration", "0"], "must be positive"),
        (["export", "house", "--duration", "1e308"], "recorded positions"),
        (["export", "house", "--pixel", "1e-9"], "resolution"),
        (["export", "offise"], "office"),
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


@pytest.mark.parametrize("name", ["../../outside", "/outside", "..", "a\nb", "x" * 300, "\u00e9" * 200, ""])
def test_a_plans_name_leads_nowhere_else(call, tmp_path: Path, name: str) -> None:
    Path("mine").mkdir()
    Path("mine/plan.geojson").write_text(json.dumps(TWO_ROOMS | {"name": name}))
    code, out, err = call("discretize", "mine/plan.geojson", "--no-picture", "--json")
    assert (code, err) == (0, "")
    folder = Path(json.loads(out)["files"]["cells"]).parent
    assert folder.parent == Path("geomsim-output")
    assert not folder.name.startswith(".")
    assert {p.name for p in tmp_path.iterdir()} == {"mine", "geomsim-output"}


def test_room_numbers_that_do_not_count_are_told(call) -> None:
    label = {
        "type": "Feature",
        "properties": {"kind": "label", "number": 7},
        "geometry": {"type": "Point", "coordinates": [1, 1]},
    }
    rooms = {"type": "Feature", "properties": {}, "geometry": TWO_ROOMS}
    Path("mine.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": [rooms, label]}))
    sentence = "Room numbers that the plan gives are not those of the cells"
    _, out, _ = call("discretize", "mine.geojson", "--no-picture", "--json")
    assert [note.partition(":")[0] for note in json.loads(out)["notes"]] == [sentence]
    _, out, _ = call("discretize", "mine.geojson", "--no-picture")
    assert sentence in out


def test_a_full_disk_is_told_with_the_name_of_the_file(call, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_text", full)
    code, out, err = call("discretize", "house", "--out", "new/cells")
    assert (code, out) == (2, "")
    assert err == "geomsim: Cannot write new/cells/cells.geojson: No space left on device.\n"
    assert list(Path().iterdir()) == []


@pytest.mark.parametrize(
    "arguments",
    [["run", "--scenario", "pipe"], ["predict", "pipe.json"], ["discretize", "pipe.json"], ["render", "pipe"]],
)
def test_what_may_never_end_is_not_opened(call, arguments: list[str]) -> None:
    os.mkfifo(arguments[-1])
    code, out, err = call(*arguments)
    assert (code, out) == (2, "")
    assert arguments[-1] in err
    assert err.count("\n") == 1


def test_a_scenario_may_begin_with_a_byte_order_mark(call) -> None:
    Path("s.toml").write_bytes(b"\xef\xbb\xbfplan = 'house'\r\ntime_limit = 1\r\n")
    code, _, err = call("run", "--scenario", "s.toml", "--no-video", "--json")
    assert (code, err) == (0, "")


def test_help_waits_for_no_library() -> None:
    """What takes long to load is loaded by the command that needs it; so ``geomsim --help`` is there at once."""
    code = "import sys; from geomsim.cli import main\ntry: main(['--help'])\nexcept SystemExit: pass\n"
    code += (
        "print(sorted({m.partition('.')[0] for m in sys.modules} & set('numpy cv2 shapely maps scipy numba'.split())))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert done.stdout.endswith("\n[]\n")


@pytest.mark.parametrize("command", ["--help", "run --help"])
def test_help_may_be_cut_off(command: str, tmp_path: Path) -> None:
    python = f"{shlex.quote(sys.executable)} -c 'from geomsim.cli import main; main()' {command}"
    done = subprocess.run(
        ["bash", "-c", f"set -o pipefail; {python} | head -c 0"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("text", ["a = " + "[" * 20_000, "seed = " + "1" * 5000, "seed = 1\nseed = 2", "plan = 'hou"])
def test_what_is_no_toml_is_refused(call, text: str) -> None:
    Path("s.toml").write_text(text)
    code, out, err = call("run", "--scenario", "s.toml")
    assert (code, out) == (2, "")
    assert err.startswith("geomsim: s.toml is not valid TOML: ")
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    ("redirection", "code", "sentence"),
    [
        ("| head -c 0", 0, ""),
        (">&-", 0, ""),
        ("> /dev/full", 2, "geomsim: Cannot write to the standard output: No space left on device.\n"),
        ("2>&- > out", 0, ""),
    ],
)
@pytest.mark.parametrize("command", ["maps --json", "discretize office --json --no-picture", "maps"])
def test_a_stdout_that_takes_nothing(tmp_path: Path, command: str, redirection: str, code: int, sentence: str) -> None:
    python = f"{shlex.quote(sys.executable)} -c 'from geomsim.cli import main; main()' {command}"
    done = subprocess.run(
        ["bash", "-c", f"set -o pipefail; {python} {redirection}"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert (done.returncode, done.stderr, done.stdout) == (code, sentence, "")


def test_signs_that_the_terminal_lacks_are_escaped(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", "from geomsim.cli import main; main()", "discretize", "house", "--out", "caf\u00e9"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path), "PYTHONIOENCODING": "ascii"},
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert "caf\\xe9" in done.stdout


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
            (
                "import signal; signal.signal(signal.SIGINT, signal.default_int_handler);"  # a parent may ignore it
                "from geomsim.cli import main; main()"
            ),
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
    try:
        while not (tmp_path / "out").exists():  # it is made just before the pursuit begins
            time.sleep(0.05)
        time.sleep(1.0)
        process.send_signal(getattr(signal, name))
        out, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 130, err
    assert err.startswith("geomsim: Interrupted after ")
    assert err.count("\n") == 1
    assert "interrupted" in out
    episode = Episode.load(tmp_path / "out" / "episode.npz")
    assert episode.outcome.status.name == "INTERRUPTED"
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["episode.npz", "scenario.toml"]


def test_interruption_while_the_record_is_written_keeps_it(call, monkeypatch: pytest.MonkeyPatch) -> None:
    save, calls = Episode.save, []

    def interrupted_once(episode: Episode, path: Path) -> Path:
        calls.append(path)
        if len(calls) == 1:
            raise KeyboardInterrupt
        return save(episode, path)

    monkeypatch.setattr(Episode, "save", interrupted_once)
    code, out, err = call("run", "house", "--json", "--out", "out")
    assert code == 130
    assert err.startswith("geomsim: Interrupted while drawing; what was finished is in out.")
    assert json.loads(out)["captured"]
    assert sorted(p.name for p in Path("out").iterdir()) == ["episode.npz", "scenario.toml"]


@pytest.mark.parametrize("command", ["discretize", "run"])
def test_interruption_before_anything_is_done(call, monkeypatch: pytest.MonkeyPatch, command: str) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("maps.read_plan", interrupted)
    monkeypatch.setattr("geomsim.scenario.read_plan", interrupted)
    assert call(command, "house", "--json") == (130, "", "geomsim: Interrupted.\n")
    assert list(Path().iterdir()) == []


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


# what a person must give, or what has no default to tell
NO_DEFAULT = {"plan", "resolution", "units", "options", "cells"}


@pytest.mark.parametrize("key", [key for key in Scenario.model_fields if key not in NO_DEFAULT])
def test_help_tells_defaults(key: str) -> None:
    docs = "\n".join(inspect.cleandoc(flags.__doc__ or "") for flags in (PlanFlags, ScenarioFlags))
    doc = " ".join(docs.split(f"\n{key}\n", 1)[1].split())
    default = Scenario.model_fields[key].default
    words = {"start": "the plan's own", "range": "without limit", "evader_start": "a random one"}
    words |= {"communication_range": "without limit", "range_noise": "they measure nothing"}
    words |= {"level": "the largest", "structure": "if it is plainly a scan"}
    words |= {"motion_speed": "as fast as it is", "clearance": "the largest radius"}
    words |= {"cost": Decoupled().cost, "depth": str(Decoupled().depth)}
    told = words.get(key, f"{default:g}" if isinstance(default, float) else str(default))
    assert doc[: doc.index("]") + 1].endswith(f" [default: {told}]"), doc


def test_the_package_runs_as_a_module() -> None:
    done = subprocess.run([sys.executable, "-m", "geomsim", "maps"], capture_output=True, text=True, check=True)
    assert "office" in done.stdout
