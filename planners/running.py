"""A policy carried out in the cell model."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planners.clock import FOREVER, Clock
from planners.policy import Policy, SearchState
from planners.simulation import SearchModel

__all__ = ["Run", "run_policy"]


@dataclass(frozen=True, slots=True)
class Run:
    """What a policy did and achieved.

    Attributes
    ----------
    survival : ndarray, shape (T + 1,)
        Probability of no capture after 0, 1, ..., T belief steps.
    moves : tuple of tuple of int
        The moves that each pursuer began, one after another; see :class:`planners.simulation.Moves`.
    seconds : tuple of float
        Time that each decision took, seconds.
    """

    survival: NDArray[np.float64]
    moves: tuple[tuple[int, ...], ...]
    seconds: tuple[float, ...]

    def expected_steps(self) -> float:
        """Return the expected steps to capture, if the curve goes on falling after its end as in its last half."""
        half = len(self.survival) // 2
        last = float(self.survival[-1])
        if last <= 0:
            return float(self.survival[:-1].sum())
        fall = float(np.log(self.survival[half] / last))
        rest = (len(self.survival) - 1 - half) / fall if fall > 0 else float("inf")
        return float(self.survival[:-1].sum()) + last * rest


def run_policy(
    model: SearchModel,
    policy: Policy,
    belief: NDArray[np.float64],
    moves: Sequence[int],
    done: Sequence[int],
    *,
    first: Sequence[Sequence[int]] = (),
    residue: float,
    longest: int,
    clock: Clock = FOREVER,
) -> Run:
    """Carry out a policy in belief steps until the evader is as good as caught.

    Parameters
    ----------
    model : SearchModel
        The problem.
    policy : Policy
        Decides.
    belief : ndarray, shape (N,)
        Probability of each state now, without the capture state.
    moves, done : sequence of int
        The move that each pursuer is on, and how many of its steps are done.
    first : sequence of sequence of int, optional
        Moves that each pursuer begins before the policy is asked.
    residue : float
        Ends when the probability of no capture is below this.
    longest : int
        Ends after this many belief steps.
    clock : Clock
        Ends it too, but not before the first step.
    """
    on, gone = list(moves), list(done)
    forced = [list(plan) for plan in first] if first else [[] for _ in on]
    begun: list[list[int]] = [[] for _ in on]
    plans: list[tuple[int, ...]] = [()] * len(on)
    free, curve, seconds = belief.copy(), [float(belief.sum())], []
    while curve[-1] > residue and len(curve) <= longest and not (len(curve) > 1 and clock.over()):
        waiting = [i for i, table in enumerate(model.moves) if gone[i] >= table.steps[on[i]]]
        for i in waiting:
            if forced[i]:
                on[i], gone[i] = forced[i].pop(0), 0
                begun[i].append(on[i])
        pursuers = tuple(model.pursuer_state(i, move, k) for i, (move, k) in enumerate(zip(on, gone, strict=True)))
        if any(p.target is None for p in pursuers):
            told = np.concatenate([[1.0 - free.sum()], free])
            asked = time.perf_counter()
            decisions = policy.decide(SearchState((len(curve) - 1) * model.step, told, pursuers, tuple(plans)))
            seconds.append(time.perf_counter() - asked)
            for i, decision in enumerate(decisions):
                if decision is not None:
                    on[i], gone[i] = model.move(pursuers[i].cell, decision.path[0]), 0
                    plans[i] = decision.path[1:]
                    begun[i].append(on[i])
        free = model.disperse(free[np.newaxis])[0]
        for i, move in enumerate(on):
            model.looks.take(free[np.newaxis], model.moves[i].views[move, [max(0, gone[i])]])
            gone[i] += 1
        curve.append(float(free.sum()))
    return Run(np.array(curve), tuple(map(tuple, begun)), tuple(seconds))
