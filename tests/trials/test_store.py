"""Results outlive interruption, and belong to one experiment."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from discretize import CellMap
from geomsim import GeomsimError, Random, Stationary, Timing
from geomsim.trials import Trials, run_trials
from geomsim.trials.store import read_rows
from planners import Policy, SearchProblem

METHODS = {"still": Stationary(), "random": Random()}


def compare(cells: CellMap, folder: Path, **options: object) -> Trials:
    given = {"trials": 40, "workers": 1, "timing": Timing(limit=300.0), "capture": "cell", "seed": 5} | options
    return run_trials(cells.plan, METHODS, cells=cells, folder=folder, **given)


def test_what_is_written_is_what_came_out(house: CellMap, tmp_path: Path) -> None:
    trials = compare(house, tmp_path / "new" / "folder")
    assert tuple(read_rows(trials.files["trials"])) == trials.rows
    about = json.loads((tmp_path / "new" / "folder" / "experiment.json").read_text())
    assert (about["methods"], about["trials"], about["plan"]) == (["still", "random"], 40, "house")


def test_parquet(house: CellMap, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    trials = compare(house, tmp_path)
    table = parquet.read_table(trials.files["parquet"]).to_pydict()
    assert table["time"] == [row.time for row in trials.rows]


@pytest.mark.parametrize("cut", [0, 1, 20, 700, 2000, 3001])
def test_a_table_that_was_cut_off_is_completed(house: CellMap, tmp_path: Path, cut: int) -> None:
    whole = compare(house, tmp_path / "whole")
    text = whole.files["trials"].read_bytes()
    part = tmp_path / "part"
    compare(house, part)
    (part / "trials.csv").write_bytes(text[:cut])
    told: list[tuple[str, int, int]] = []
    again = compare(house, part, progress=lambda *said: told.append(said))
    assert again.rows == whole.rows
    assert again.files["trials"].read_bytes() == text
    kept = text[:cut].count(b"\n")
    assert sum(done for _, done, _ in told[:2]) == max(0, kept - 1)
    assert again.as_dict()["methods"][1]["predicted_mean"] == whole.as_dict()["methods"][1]["predicted_mean"]


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no kill -9 here")
def test_kill_9_at_any_moment(house: CellMap, tmp_path: Path) -> None:
    """Kill the program while it works, again and again, until it comes through; the table is that of one run."""
    program = (
        "import sys; from pathlib import Path; import geomsim as gs; from geomsim.trials import run_trials\n"
        "cells = gs.convex_cells(gs.load_plan('house'))\n"
        "run_trials(cells.plan, {'still': gs.Stationary(), 'random': gs.Random()}, cells=cells, workers=2,\n"
        "  trials=1000, timing=gs.Timing(limit=900.0), capture='cell', folder=sys.argv[1])\n"
    )

    def start(folder: Path) -> subprocess.Popen[bytes]:
        return subprocess.Popen([sys.executable, "-c", program, str(folder)], cwd=Path(__file__).parents[2])

    begun = time.monotonic()
    assert start(tmp_path / "whole").wait() == 0
    deaths, patience = 0, 0.4 * (time.monotonic() - begun)
    while True:
        process = start(tmp_path / "part")
        try:
            assert process.wait(timeout=patience) == 0
            break
        except subprocess.TimeoutExpired:
            os.kill(process.pid, signal.SIGKILL)
            process.wait()
            deaths, patience = deaths + 1, patience * 1.25
    assert deaths >= 2
    assert (tmp_path / "part" / "trials.csv").read_bytes() == (tmp_path / "whole" / "trials.csv").read_bytes()
    time.sleep(1.5)  # workers of the dead notice that they are alone


def test_a_foreign_folder_is_refused(house: CellMap, tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("x")
    with pytest.raises(GeomsimError, match=r"holds no results of trials but 'thesis\.tex'"):
        compare(house, tmp_path)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["thesis.tex"]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"seed": 6}, "another experiment: its seed is 5, not 6"),
        ({"trials": 41}, "its trials is 40, not 41"),
        ({"capture": "sight"}, "its capture is 'cell', not 'sight'"),
        ({"engine": "separate"}, "its engine is 'shared', not 'separate'"),
    ],
)
def test_another_experiment_is_refused(
    house: CellMap, tmp_path: Path, change: dict[str, object], sentence: str
) -> None:
    compare(house, tmp_path)
    with pytest.raises(GeomsimError, match=sentence):
        compare(house, tmp_path, **change)


def test_a_planner_of_ones_own_is_known_again(house: CellMap, tmp_path: Path) -> None:
    class Mine:
        def solve(self, problem: SearchProblem, rng: np.random.Generator) -> Policy:
            return Stationary().solve(problem, rng)

    for _ in range(2):
        options = {"cells": house, "trials": 5, "workers": 1, "capture": "cell", "timing": Timing(limit=100.0)}
        trials = run_trials(house.plan, {"mine": Mine(), "still": Stationary()}, folder=tmp_path, **options)
    assert [row.time for row in trials.rows[:5]] == [row.time for row in trials.rows[5:]]


def test_another_building_of_the_same_name_is_refused(house: CellMap, tmp_path: Path) -> None:
    from dataclasses import replace

    compare(house, tmp_path)
    other = replace(house, cells=(house.cells[0].buffer(-0.01), *house.cells[1:]))
    with pytest.raises(GeomsimError, match="its geometry is"):
        compare(other, tmp_path)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ('{"kind": "geomsim trials", "format": 0}', "is of format 0, but this version"),
        ('{"kind": "something else"}', "is of format None"),
        ("[1, 2]", "does not describe results"),
        ("not json", "does not describe results"),
    ],
)
def test_an_older_folder_is_refused(house: CellMap, tmp_path: Path, text: str, sentence: str) -> None:
    (tmp_path / "experiment.json").write_text(text)
    with pytest.raises(GeomsimError, match=sentence):
        compare(house, tmp_path)


@pytest.mark.parametrize("line", ["random,1", "random,x,1,1,1,True,3.0,1,1,0,0", "random,1,1,1,1,maybe,3.0,1,1,0,0"])
def test_a_damaged_table_is_refused(house: CellMap, tmp_path: Path, line: str) -> None:
    compare(house, tmp_path)
    with (tmp_path / "trials.csv").open("a") as file:
        file.write(line + "\n")
    with pytest.raises(GeomsimError, match="line 82, is no row of a table of trials"):
        compare(house, tmp_path)


def test_a_folder_that_cannot_be_written(house: CellMap, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    with pytest.raises(GeomsimError, match="Cannot write"):
        compare(house, tmp_path / "file")
