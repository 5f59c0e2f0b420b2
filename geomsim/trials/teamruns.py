"""Runs of a team without an evader: each serves every evader."""

from __future__ import annotations

import time as clock
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from discretize import WallGrid
from geomsim.pursuit import HELD_UP
from geomsim.seeds import Streams
from geomsim.teamwork import Teamwork
from geomsim.trials.experiment import Experiment

__all__ = ["TeamRun", "run_team"]


@dataclass(frozen=True, slots=True)
class TeamRun:
    """What P robots did in S physics steps.

    Attributes
    ----------
    run : int
        Its number, counted from 0.
    eyes : ndarray, shape (S + 1, P, 2)
        Where they were, metres.
    headings : ndarray, shape (S + 1, P)
        Where they looked, radians.
    cells : ndarray of int32, shape (S + 1, P)
        The cells in which they were, counted from 0.
    drew : bool
        Whether the planner drew random numbers; if not, every run of this team is the same.
    decisions : int
        How many there were.
    seconds : float
        What the run took to compute.
    held_up : tuple of int
        Robots, counted from 0, that made no progress for 10 s.
    crossings : int
        Moves through walls, which must be none.
    """

    run: int
    eyes: NDArray[np.float64]
    headings: NDArray[np.float64]
    cells: NDArray[np.int32]
    drew: bool
    decisions: int
    seconds: float
    held_up: tuple[int, ...]
    crossings: int

    @property
    def steps(self) -> int:
        """Physics steps."""
        return len(self.cells) - 1

    def cut(self, steps: int, *, sight: bool) -> TeamRun:
        """Return the first ``steps`` physics steps, without what the capture rule does not ask for."""
        nothing, rows = np.empty((0,)), slice(0, steps + 1)
        return replace(
            self,
            eyes=self.eyes[rows] if sight else nothing,
            headings=self.headings[rows] if sight else nothing,
            cells=self.cells[rows],
        )


def run_team(experiment: Experiment, method: int, runs: Sequence[int], steps: int) -> list[TeamRun]:
    """Run the team of a method for some physics steps.

    Parameters
    ----------
    experiment : Experiment
        What is compared.
    method : int
        Which of its methods.
    runs : sequence of int
        Numbers of the runs; each draws from a seed of its own.
    steps : int
        How far.
    """
    from geomsim.trials.kernels import blocked_moves

    begun, grid = clock.perf_counter(), WallGrid.of(experiment.cells.plan.walls)
    timing, team = experiment.timing, experiment.team_for(method)
    deciding = [Streams(experiment.seeds[run]).deciding for run in runs]
    fresh = [rng.bit_generator.state for rng in deciding]
    work = Teamwork(experiment.cells, team, experiment.starts, experiment.motion, timing.belief_step, deciding)
    eyes, headings, cells = [work.positions], [work.headings], [work.cells]
    held_up = work.idle >= HELD_UP
    for k in range(steps):
        work.step(k * timing.physics_step, timing.physics_step)
        eyes.append(work.positions)
        headings.append(work.headings)
        cells.append(work.cells)
        held_up |= work.idle >= HELD_UP
        if (k + 1) % timing.steps_per_belief == 0:
            work.learn()
    tracks, looks, places = np.array(eyes), np.array(headings), np.array(cells)
    chosen = np.bincount([choice.run for choice in work.choices], minlength=len(runs))
    spent = (clock.perf_counter() - begun) / len(runs)
    return [
        TeamRun(
            run=run,
            eyes=np.ascontiguousarray(tracks[:, r]),
            headings=np.ascontiguousarray(looks[:, r]),
            cells=np.ascontiguousarray(places[:, r]),
            drew=deciding[r].bit_generator.state != fresh[r],
            decisions=int(chosen[r]),
            seconds=spent,
            held_up=tuple(np.flatnonzero(held_up[r]).tolist()),
            crossings=blocked_moves(grid, tracks[:, r]),
        )
        for r, run in enumerate(runs)
    ]
