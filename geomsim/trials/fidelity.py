"""What the cell model says of a method, to be held against what happens in the world."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geomsim.pursuit import believed_capture
from geomsim.seeds import Streams
from geomsim.trials.experiment import Experiment
from geomsim.trials.statistics import Survival
from planners import SearchGraph, SearchProblem, TooLargeError, predict, uniform_belief

__all__ = ["Forecast", "forecast"]

#: a pursuit is followed until it has ended with all but this probability; beyond it goes on at the same rate
_RESIDUE = 1e-4


@dataclass(frozen=True, slots=True)
class Forecast:
    """The exact capture time in the cell model.

    Attributes
    ----------
    mean : float
        Expected capture time, up to the time limit if the curve goes so far, seconds.
    free : ndarray, shape (T + 1,)
        Probability that the evader is free after each belief step.
    step : float
        Of the belief, seconds.
    """

    mean: float
    free: NDArray[np.float64]
    step: float

    def gap(self, observed: Survival, limit: float) -> float:
        """Return the largest difference between the predicted and an observed curve, up to the time limit."""
        at = self.step * np.arange(len(self.free))
        at = at[at <= limit]
        seen = observed.free[np.searchsorted(observed.time, at + 1e-9, side="right") - 1]
        return float(np.abs(seen - self.free[: len(at)]).max())


def forecast(experiment: Experiment, method: int) -> Forecast | None:
    """Predict a method exactly, with what its team believes; None where the cell model has no finite answer.

    That is so where the team believes that it may never capture, or is too large a random walk for its Markov chain.
    """
    graph = SearchGraph.from_cells(experiment.cells)
    team, timing, starts = experiment.team_for(method), experiment.timing, experiment.starts
    speeds = (team.speed,) * team.pursuers
    problem = SearchProblem(graph, experiment.motion, believed_capture(team, timing), speeds, timing.belief_step)
    belief = uniform_belief(graph, exclude=starts, component=int(graph.component[starts[0]]))
    rng, steps = Streams.of(experiment.seeds[0]).deciding, math.ceil(timing.limit / timing.belief_step)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of a linear system without a solution, seen below
        try:
            (told,) = predict(
                problem, team.planner, [starts], rng, belief=belief, residue=_RESIDUE, longest=max(1, steps)
            )
        except (TooLargeError, OverflowError, ValueError):
            return None
    if not math.isfinite(told.expected_time) or told.expected_time < 0:
        return None
    whole = len(told.survival) > steps
    mean = float(told.survival[:steps].sum()) * timing.belief_step if whole else told.expected_time
    return Forecast(mean, told.survival, timing.belief_step)
