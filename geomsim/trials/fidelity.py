"""What the cell model says of a method, to be held against what happens in the world."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from geomsim.curves import lengthened, mean_time
from geomsim.team import Evader
from geomsim.trials.experiment import Experiment
from geomsim.trials.statistics import Survival
from geomsim.trials.teamruns import TeamRun
from planners import DwellTime, MotionModel, SearchGraph, uniform_belief

if TYPE_CHECKING:
    from planners.motion import Sparse

__all__ = ["Forecast", "forecast"]


@dataclass(frozen=True, slots=True)
class Forecast:
    """A predicted capture time.

    Attributes
    ----------
    mean : float
        Expected capture time, where an evader still free at the time limit counts with that; seconds.
    free : ndarray, shape (T + 1,)
        Probability that the evader is free after each step.
    step : float
        Of physics, or of looks by sight, seconds.
    begin : float
        Time of the first one, seconds.
    """

    mean: float
    free: NDArray[np.float64]
    step: float
    begin: float = 0.0

    def gap(self, observed: Survival, limit: float) -> float:
        """Return the largest difference between the predicted and an observed curve, up to the time limit."""
        at = self.begin + self.step * np.arange(len(self.free))
        at = at[at <= limit]
        seen = observed.free[np.searchsorted(observed.time, at + 1e-9, side="right") - 1]
        return float(np.abs(seen - self.free[: len(at)]).max())


def forecast(experiment: Experiment, runs: Sequence[TeamRun]) -> Forecast:
    """Predict how long a team takes: exactly, in cells.

    Until capture a team's run does not depend on the evader, so its way through the cells is known; the evader is a
    Markov chain on them. Its probability of being free after each physics step is a product of matrices (Eq. 3), with
    robots that enter a cell when they do, and without sampling. Several runs, where chance has a part in the team's
    decisions, are averaged. After its end a run is taken to go on at the rate of its last half.

    The evader dwells in each cell as long as one that walks from checkpoint to checkpoint does on average
    (:class:`planners.DwellTime`), unless its model tells otherwise (its ``in_cells``). That time has two halves, before
    and after the checkpoint; it begins at one. A team that counts on sight is taken at its word instead: the prediction
    is what it believes at each belief step of its run. Otherwise capture is in the same cell, as likely as the sensor
    notices, and of several evaders the last one counts, for a team that goes on as if none had been captured.

    Parameters
    ----------
    experiment : Experiment
        What is compared.
    runs : sequence of TeamRun
        Those of one method.
    """
    step, limit = experiment.timing.physics_step, experiment.timing.limit
    curves = _free(experiment, runs)
    mean = float(np.mean([mean_time(curve, step, limit) for curve in curves]))
    length = max(map(len, curves))
    free = np.mean([lengthened(curve, length) for curve in curves], axis=0)
    return Forecast(mean, free, step)


def _free(experiment: Experiment, runs: Sequence[TeamRun]) -> list[NDArray[np.float64]]:
    """Return for each run the probability that the evader is free after each of its physics steps."""
    graph, starts, step = SearchGraph.from_cells(experiment.cells), experiment.starts, experiment.timing.physics_step
    transposed = _halved(_motion(experiment.evader).matrix(graph, step)[1:, 1:]).T.tocsr()
    kept = np.exp([-sensor.attention * step for sensor in experiment.team.sensors])
    first = uniform_belief(graph, exclude=starts, component=int(graph.component[starts[0]]))[1:]
    states = np.tile(np.concatenate([np.zeros_like(first), first])[:, np.newaxis], len(runs))
    longest, column = max(run.steps for run in runs), np.arange(len(runs))
    free = np.empty((longest + 1, len(runs)))
    free[0] = 1.0
    # a run that has ended stands still; what comes out for it is cut off
    cells = np.stack([np.pad(run.cells, ((0, longest - run.steps), (0, 0)), mode="edge") for run in runs], axis=1)
    for k in range(1, longest + 1):
        states = transposed @ states
        for i, share in enumerate(kept):
            for half in (0, len(graph)):
                states[cells[k, :, i] + half, column] *= share
        free[k] = states.sum(axis=0)
    free = 1.0 - (1.0 - free) ** experiment.evader.count
    return [free[: run.steps + 1, r] for r, run in enumerate(runs)]


def _motion(evader: Evader) -> MotionModel:
    in_cells = getattr(evader.model, "in_cells", DwellTime)
    return cast(MotionModel, in_cells(evader.speed))


def _halved(dispersion: Sparse) -> Sparse:
    """Split each cell into its time before and after the checkpoint, each left twice as fast; shape (2 N, 2 N)."""
    from scipy.sparse import block_array, csr_array, diags_array

    leaves = 1.0 - dispersion.diagonal()
    faster = np.minimum(1.0, 2.0 * leaves)
    share = np.divide(faster, leaves, out=np.zeros_like(leaves), where=leaves > 0)
    moves = diags_array(share) @ (dispersion - diags_array(dispersion.diagonal()))
    stays, turns = diags_array(1.0 - faster), diags_array(faster)
    return csr_array(block_array([[stays, turns], [moves, stays]]))
