"""A bank of evaders: many of them simulated once, met by the teams of all methods."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from discretize import WallGrid
from geomsim.pursuit import HELD_UP
from geomsim.quarry import Quarry
from geomsim.seeds import Streams
from geomsim.trials.experiment import Experiment, Row
from geomsim.trials.teamruns import TeamRun
from geomsim.walking import Routes

if TYPE_CHECKING:
    from geomsim.trials.kernels import Looked, Lookers

__all__ = ["Bank", "Meetings", "Reel", "meet"]

#: physics steps between two looks at who is still free
_REEL = 600


@dataclass(frozen=True, slots=True)
class Reel:
    """Where K evaders were at T successive physics steps.

    Attributes
    ----------
    first : int
        Physics step of the first row.
    trials : ndarray of intp, shape (K,)
        Whose evaders.
    positions : ndarray of float32, shape (T, K, 2)
        Metres.
    cells : ndarray of int32, shape (T, K)
        Counted from 0.
    """

    first: int
    trials: NDArray[np.intp]
    positions: NDArray[np.float32]
    cells: NDArray[np.int32]


class Bank:
    """The evaders of some trials, each moving as it would in an episode of its own.

    It is read reel by reel, and goes on with those evaders only that are still of interest; so what it keeps does not
    grow with time.

    Parameters
    ----------
    experiment : Experiment
        Whose evaders.
    trials : sequence of int
        Of which trials.
    """

    def __init__(self, experiment: Experiment, trials: Sequence[int]) -> None:
        self._experiment = experiment
        self.trials = np.array(trials, dtype=np.intp)
        hideouts = [experiment.hideouts[k] for k in trials]
        chance = [Streams(experiment.seeds[k]).moving for k in trials]
        cells = experiment.cells
        self._quarry = Quarry(cells.plan.walls, Routes(cells), experiment.evader, hideouts, chance)
        self._steps = 0
        self.held_up: set[int] = set()

    def reel(self, steps: int) -> Reel:
        """Go on by some physics steps; the first row is where the evaders are before, the last where they end."""
        quarry, k = self._quarry, len(self.trials)
        positions, cells = np.empty((steps + 1, k, 2), np.float32), np.empty((steps + 1, k), np.int32)
        positions[0], cells[0] = quarry.positions, quarry.cells
        idle = np.zeros(k)
        for t in range(1, steps + 1):
            quarry.step(self._experiment.timing.physics_step)
            positions[t], cells[t] = quarry.positions, quarry.cells
            np.maximum(idle, quarry.idle, out=idle)
        self.held_up.update(self.trials[idle >= HELD_UP].tolist())
        first, self._steps = self._steps, self._steps + steps
        return Reel(first, self.trials, positions, cells)

    def keep(self, which: NDArray[np.bool_]) -> None:
        """Go on with some of the evaders only; shape (K,)."""
        if not which.all():
            kept = np.flatnonzero(which)
            self.trials = self.trials[kept]
            self._quarry.keep(kept)


@dataclass(slots=True)
class Meetings:
    """What became of some evaders.

    Attributes
    ----------
    rows : list of Row
        Captures.
    crossings : int
        Moves through walls, which must be none.
    held_up : set of int
        Trials whose evader made no progress for 10 s.
    evader_steps : int
        Physics steps of all evaders together.
    """

    rows: list[Row] = field(default_factory=list)
    crossings: int = 0
    held_up: set[int] = field(default_factory=set)
    evader_steps: int = 0


def meet(
    experiment: Experiment, runs: Mapping[int, Sequence[TeamRun]], free: Mapping[int, Sequence[int]], steps: int
) -> Meetings:
    """Let the teams of several methods look for the evaders of some trials.

    Parameters
    ----------
    experiment : Experiment
        What is compared.
    runs : mapping
        For each method the runs of its team, of at least ``steps`` physics steps: one, or those that the trials meet.
    free : mapping
        For each method the trials that it has not captured yet.
    steps : int
        How far, from the beginning.
    """
    from geomsim.trials.kernels import Lookers, blocked_moves

    sensors, timing = experiment.team.sensors, experiment.timing
    grid = WallGrid.of(experiment.cells.plan.walls)
    lookers = Lookers(
        np.array([sensor.range for sensor in sensors]),
        np.array([sensor.field_of_view for sensor in sensors]) / 2,
        np.array([sensor.attention for sensor in sensors]) * timing.physics_step,
    )
    trials = sorted(set().union(*free.values()))
    passes = [_Pass(experiment, grid, lookers, m, runs[m], free[m]) for m in free]
    bank, found, done = Bank(experiment, trials), Meetings(), 0
    while done < steps and len(bank.trials):
        length = min(_REEL, steps - done)
        reel = bank.reel(length)
        found.crossings += blocked_moves(grid, reel.positions)
        found.evader_steps += length * len(reel.trials)
        for one in passes:
            found.rows += one.look(reel)
        done += length
        bank.keep(np.isin(bank.trials, [k for one in passes for k in one.free]))
    found.held_up = bank.held_up
    return found


class _Pass:
    """One method's pass over the bank."""

    def __init__(
        self,
        experiment: Experiment,
        grid: WallGrid,
        lookers: Lookers,
        method: int,
        runs: Sequence[TeamRun],
        free: Sequence[int],
    ) -> None:
        from geomsim.trials.kernels import Looked

        self._experiment, self._grid, self._lookers, self._method = experiment, grid, lookers, method
        self._runs = {run.run: run for run in runs}
        self._single = runs[0].run if len(runs) == 1 and not runs[0].drew else None
        self.free = set(free)
        patience = np.ones((experiment.trials, experiment.team.pursuers))
        if any(sensor.detection < 1 for sensor in experiment.team.sensors):
            patience[list(free)] = experiment.patience(np.array(free, dtype=np.intp))
        self._looked = Looked(patience, np.zeros_like(patience))

    def look(self, reel: Reel) -> list[Row]:
        """Find who is captured in a reel."""
        from geomsim.trials.kernels import Looked

        rows: list[Row] = []
        looked = Looked(self._looked.patience[reel.trials], self._looked.paid[reel.trials])
        meets: dict[int, list[int]] = {}
        for column, trial in enumerate(reel.trials.tolist()):
            if trial in self.free:
                meets.setdefault(self._run_of(trial), []).append(column)
        for number, columns in meets.items():
            rows += self._meet(reel, self._runs[number], np.array(columns, dtype=np.intp), looked)
        self._looked.paid[reel.trials] = looked.paid
        self.free -= {row.trial for row in rows}
        return rows

    def _run_of(self, trial: int) -> int:
        return trial % self._experiment.team_runs if self._single is None else self._single

    def _meet(self, reel: Reel, run: TeamRun, columns: NDArray[np.intp], looked: Looked) -> list[Row]:
        from geomsim.trials.kernels import first_looks, first_meetings

        # the first row of a reel is the last of the one before, which has been looked at
        skip = 1 if reel.first else 0
        part = slice(reel.first + skip, reel.first + len(reel.cells))
        if self._experiment.capture == "cell":
            when, who = first_meetings(self._lookers, run.cells[part], reel.cells[skip:], columns, looked)
        else:
            eyes, headings = run.eyes[part], run.headings[part]
            when, who = first_looks(self._grid, self._lookers, eyes, headings, reel.positions[skip:], columns, looked)
        rows = []
        for column in columns[when[columns] >= 0].tolist():
            t = int(when[column]) + skip
            x, y = reel.positions[t, column].tolist()
            rows.append(
                self._experiment.row(
                    self._method,
                    int(reel.trials[column]),
                    reel.first + t,
                    captured=True,
                    pursuer=int(who[column]) + 1,
                    cell=int(reel.cells[t, column]) + 1,
                    x=round(x, 3),
                    y=round(y, 3),
                )
            )
        return rows
