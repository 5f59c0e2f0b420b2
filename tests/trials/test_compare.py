"""``geomsim compare``: the table as text and JSON, files, and sentences for bad input."""

import json
import re
from pathlib import Path

import pytest

from geomsim.cli import main

FAST = ["--methods", "stationary,random,decoupled-entropy-1", "--trials", "30", "--capture", "cell", "--workers", "1"]


def run(capsys: pytest.CaptureFixture[str], *argv: str) -> tuple[int, str, str]:
    with pytest.raises(SystemExit) as end:
        main(list(argv))
    out, err = capsys.readouterr()
    return int(end.value.code or 0), out, err


@pytest.fixture
def done(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> dict:
    code, out, err = run(capsys, "compare", "house", *FAST, "--json", "--out", str(tmp_path / "new"))
    assert (code, err) == (0, "")
    return json.loads(out)


def test_json(done: dict) -> None:
    assert [m["name"] for m in done["methods"]] == ["stationary", "random", "decoupled-entropy-1"]
    for m in done["methods"]:
        assert set(m) >= {"mean", "sem", "median", "captured_share", "censored", "trials", "predicted_mean", "seconds"}
        assert (m["trials"], m["censored"], m["captured_share"]) == (30, 0, 1.0)
        assert 0 < m["sem"] < m["mean"] < 200
        assert 0 < m["curve_gap"] < 1
        assert m["predicted_ratio"] == pytest.approx(m["predicted_mean"] / m["mean"])
    assert done["reference"] == "stationary"
    assert [p["name"] for p in done["paired"]] == ["random", "decoupled-entropy-1"]
    for p in done["paired"]:
        mean = next(m["mean"] for m in done["methods"] if m["name"] == p["name"])
        assert p["difference"] == pytest.approx(mean - done["methods"][0]["mean"])
        assert p["low"] < p["difference"] < p["high"]
    assert (done["wall_crossings"], done["engine"]) == (0, "shared")
    assert done["wall_seconds"] > 0
    assert done["scenario"]["seed"] == 0


def test_files(done: dict) -> None:
    assert set(done["files"]) >= {"trials", "means", "curves", "fidelity", "summary"}
    assert "heuristics" not in done["files"]  # with one cost there is nothing to set side by side
    for kind, path in done["files"].items():
        data = Path(path).read_bytes()
        assert len(data) > 500, kind
        assert path.endswith(".png") == data.startswith(b"\x89PNG")
    saved = json.loads(Path(done["files"]["summary"]).read_text())
    assert saved == done


def test_figures_in_vectors_group_heuristics_and_are_the_same_again(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    methods = "random,decoupled-entropy-1,decoupled-probability-1,decoupled-entropy-2"
    argv = ["compare", "house", "--methods", methods, "--trials", "20", "--capture", "cell", "--workers", "1", "--json"]
    kinds = ["means", "heuristics", "curves", "fidelity"]
    drawn = []
    for _ in range(2):
        told = json.loads(run(capsys, *argv, "--figures-format", "svg", "--out", str(tmp_path))[1])
        assert [Path(told["files"][kind]).name for kind in kinds] == [f"{kind}.svg" for kind in kinds]
        drawn.append([Path(told["files"][kind]).read_text() for kind in kinds])
    assert drawn[0] == drawn[1]
    assert all(text.startswith("<?xml") for text in drawn[0])
    code, _, err = run(capsys, *argv, "--figures-format", "bmp")
    assert (code, "bmp" in err) == (2, True)


def test_by_sight_too(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    argv = ["house", "--capture", "sight", "--time-limit", "500", "--json"]
    more = ["--methods", "decoupled-entropy-1", "--trials", "30", "--workers", "1", "--no-figures"]
    m = json.loads(run(capsys, "compare", *argv, *more, "--out", str(tmp_path))[1])["methods"][0]
    told = json.loads(run(capsys, "predict", *argv, "--cost", "entropy", "--depth", "1")[1])
    assert m["predicted_mean"] == pytest.approx(told["expected_time"], rel=0.02)


def test_text_and_resumption(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    argv = ["compare", "house", *FAST, "--out", str(tmp_path), "--reference", "random", "--no-figures"]
    code, out, _ = run(capsys, *argv)
    assert code == 0
    assert re.search(r"^stationary +\d+\.\d +\d+\.\d\d .* 100\.0% +\d+\.\d  [+-]\d+\.\d \[", out, re.M)
    assert "against random" in out
    again = run(capsys, *argv)[1]
    assert re.sub(r"engine, .* s\n", "", again) == re.sub(r"engine, .* s\n", "", out)


def test_defaults_are_those_of_figure_5() -> None:
    from geomsim.trials import default_methods, parse_method

    names = default_methods()
    assert names[:2] == ("stationary", "random")
    for cost in ("distance-over-probability", "probability", "target-probability", "entropy"):
        assert {f"decoupled-{cost}-1", f"decoupled-{cost}-5"} <= set(names)
    assert [parse_method(name).name for name in names] == list(names)


@pytest.mark.parametrize(
    ("argv", "sentence"),
    [
        (["--trials", "0"], "at least one trial, but 0"),
        (["--methods", "random,random"], "'random' is named twice"),
        (["--methods", "rendom"], "did you mean 'random'"),
        (["--reference", "beamm"], "none of the methods"),
        (["--planner", "random"], "compare takes --methods"),
        (["--workers", "0"], "at least one worker"),
        (["--engine", "fast"], "There is no engine 'fast'"),
        (["--start", "4", "--evader-start", "4", "--capture", "sight"], "sees the evader from where it starts"),
        (["--evader", "fleeing", "--engine", "shared"], "reacts to robots"),
    ],
)
def test_bad_input(capsys: pytest.CaptureFixture[str], tmp_path: Path, argv: list[str], sentence: str) -> None:
    given = dict(zip(FAST[::2], FAST[1::2], strict=True)) | dict(zip(argv[::2], argv[1::2], strict=True))
    flags = [word for pair in given.items() for word in pair]
    code, out, err = run(capsys, "compare", "house", *flags, "--out", str(tmp_path / "o"))
    assert (code, out) == (2, "")
    assert sentence in err
    assert "Traceback" not in err


def test_nobody_answers(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    code, _, err = run(capsys, "compare", "house", *FAST, "--out", str(tmp_path), "--dask", "tcp://127.0.0.1:9")
    assert code == 2
    assert "No Dask scheduler answers at 'tcp://127.0.0.1:9'" in err
