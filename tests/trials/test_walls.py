"""No body ever leaves the building."""

from pathlib import Path

import numpy as np
import pytest
import shapely

from discretize import WallGrid, convex_cells
from geomsim import Evader, Random, Team, Timing
from geomsim.trials.bank import Bank
from geomsim.trials.experiment import Experiment
from geomsim.trials.kernels import blocked_moves
from geomsim.trials.methods import Method
from geomsim.trials.teamruns import run_team
from geomsim.world import count_wall_crossings
from maps import read_plan
from planners import AreaSpeedDegree

REAL = ["geojson/westport_2.geojson", "ros/aws_bookstore.yaml", "ros/pal_office.yaml"]


def check(name: str, trials: int, seconds: float) -> None:
    cells = convex_cells(read_plan(name))
    experiment = Experiment(
        cells=cells,
        methods=(Method("random", Random()),),
        team=Team(pursuers=10),
        evader=Evader(),
        capture="sight",
        motion=AreaSpeedDegree(1.0),
        timing=Timing(limit=seconds),
        trials=trials,
        team_runs=1,
        seed=1,
    )
    grid, moves, held = WallGrid.of(cells.plan.walls), 0, 0
    inside = cells.plan.space
    shapely.prepare(inside)
    for first in range(0, trials, 250):
        bank = Bank(experiment, range(first, min(first + 250, trials)))
        for _ in range(round(seconds / 20)):
            reel = bank.reel(200)
            assert blocked_moves(grid, reel.positions) == 0
            moves += np.count_nonzero(np.any(np.diff(reel.positions, axis=0) != 0, axis=2))
            assert shapely.contains_xy(inside, *reel.positions[-1].T.astype(float)).all()
        # the compiled count against shapely's
        assert count_wall_crossings(reel.positions[:, :20].astype(float), cells.plan.walls) == 0
        held += len(bank.held_up)
    assert moves > 0.9 * trials * seconds / 0.1  # they do walk
    assert held == 0
    (run,) = run_team(experiment, 0, [0], round(seconds / 0.1))
    assert run.crossings == 0
    assert run.held_up == ()
    assert np.ptp(run.eyes, axis=0).max(axis=1).min() > 1.0


@pytest.mark.parametrize("name", ["house", "office"])
def test_nobody_leaves(name: str) -> None:
    check(name, 100, 60.0)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["house", "office", "museum"])
def test_a_thousand_evaders_and_ten_robots(name: str) -> None:
    check(name, 1000, 600.0)


@pytest.mark.slow
@pytest.mark.parametrize("name", REAL)
def test_a_thousand_evaders_and_ten_robots_in_real_buildings(floorplans: Path, name: str) -> None:
    check(str(floorplans / name), 1000, 600.0)
