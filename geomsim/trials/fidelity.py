"""What the cell model says of a method, to be held against what happens in the world."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geomsim.believing import believed_problem
from geomsim.seeds import Streams
from geomsim.trials.experiment import Experiment
from geomsim.trials.statistics import Survival
from planners import (
    Planner,
    Policy,
    Prediction,
    SearchProblem,
    TooLargeError,
    predict,
)

__all__ = ["Forecast", "forecast"]

#: a pursuit is followed until it has ended with all but this probability; beyond it goes on at the same rate
_RESIDUE = 1e-4

#: runs of a team in the cell model where its planner draws random numbers and its Markov chain is too large
_SAMPLES = 20


@dataclass(frozen=True, slots=True)
class _Unknown:
    """A planner whose kind is hidden, so that its decisions are followed whatever it is."""

    planner: Planner

    def solve(self, problem: SearchProblem, rng: np.random.Generator) -> Policy:
        return self.planner.solve(problem, rng)


@dataclass(frozen=True, slots=True)
class Forecast:
    """A predicted capture time.

    Attributes
    ----------
    mean : float
        Expected capture time, up to the time limit if the curve goes so far, seconds.
    free : ndarray, shape (T + 1,)
        Probability that the evader is free after each belief step.
    step : float
        Of the belief, seconds.
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


def forecast(experiment: Experiment, method: int) -> Forecast | None:
    """Predict a method in the cell model, with what its team believes; None where that has no finite answer.

    The answer is exact, but for a planner that draws random numbers and whose Markov chain is too large: then it is
    the mean of 20 runs, each exact. There is none where the team believes that it may never capture.
    """
    team, timing, starts = experiment.team_for(method), experiment.timing, experiment.starts
    roads, problem = believed_problem(experiment.cells, team, experiment.motion, timing.belief_step)
    belief = problem.first_belief(starts, int(roads.graph.component[starts[0]]))
    seed, steps = experiment.seeds[0], max(1, math.ceil(timing.limit / timing.belief_step))

    def ask(planner: Planner, rng: np.random.Generator, residue: float) -> Prediction:
        return predict(problem, planner, [starts], rng, belief=belief, residue=residue, longest=steps)[0]

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a linear system without a solution, seen below
        try:
            told = [ask(team.planner, Streams(seed).deciding, _RESIDUE)]
        except TooLargeError:
            chance = Streams(seed).deciding.spawn(_SAMPLES)
            told = [ask(_Unknown(team.planner), rng, 10 * _RESIDUE) for rng in chance]
        except (OverflowError, ValueError):
            return None
    mean = float(np.mean([one.expected_time for one in told]))
    if not math.isfinite(mean) or mean < 0:
        return None
    length = max(len(one.survival) for one in told)
    free = np.mean([np.pad(one.survival, (0, length - len(one.survival)), mode="edge") for one in told], axis=0)
    if length > steps:
        mean = float(free[:steps].sum()) * timing.belief_step
    return Forecast(mean, free, timing.belief_step)
