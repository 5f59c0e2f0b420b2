"""A plan that is never worse than the best of several simpler planners."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planners.clock import Clock
from planners.lookahead import Decoupled
from planners.policy import Planner, SearchProblem
from planners.running import Run, run_policy
from planners.simulation import SearchModel
from planners.team import TeamPolicy, at_least

__all__ = ["Rollout"]

BASES: tuple[Planner, ...] = (
    Decoupled("entropy", 1),
    Decoupled("target-probability", 1),
    Decoupled("distance-over-probability", 1),
    Decoupled("target-probability", 3),
)


@dataclass(frozen=True, slots=True)
class Rollout:
    """Every planner of a set is run to the end in the cell model; the team follows the one that ends best.

    Since the belief tells exactly what a plan achieves, nothing is sampled, and the expected time to capture is not
    more than that of the best of the set (parallel rollout, Bertsekas and Castanon 1999, with deterministic base
    policies). At every later search the rest of the plan, carried on by each of the set, competes with the set run
    anew from there; so the team may change over, and only gains.

    Attributes
    ----------
    bases : tuple of Planner
        The set.
    horizon : int
        Belief steps that each is run for at most; what is left then counts at the rate so far.
    patience : int
        Time between two searches, belief steps.
    seconds : float
        Thinking time for one decision; with a limit, results depend on the machine.

    Raises
    ------
    PlannerError
        If the set is empty, a number below 1 or the time below 0.
    """

    bases: tuple[Planner, ...] = BASES
    horizon: int = 300
    patience: int = 5
    seconds: float = float("inf")

    def __post_init__(self) -> None:
        at_least(1, bases=len(self.bases), horizon=self.horizon, patience=self.patience)
        at_least(0, seconds=self.seconds)

    def solve(self, problem: SearchProblem, rng: np.random.Generator) -> TeamPolicy:
        """Prepare a policy; each policy of the set gets a generator of its own."""
        model = SearchModel(problem)
        policies = [base.solve(problem, own) for base, own in zip(self.bases, rng.spawn(len(self.bases)), strict=True)]

        def search(
            belief: NDArray[np.float64],
            moves: Sequence[int],
            done: Sequence[int],
            announced: Sequence[Sequence[int]],
            clock: Clock,
        ) -> Sequence[Sequence[int]]:
            firsts = [announced, ()] if any(announced) else [()]
            runs: list[Run] = []
            for first, policy in itertools.product(firsts, policies):
                if runs and clock.over():
                    break
                run = run_policy(
                    model, policy, belief, moves, done, first=first, residue=1e-6, longest=self.horizon, clock=clock
                )
                runs.append(run)
            return min(runs, key=lambda run: run.expected_steps()).moves

        return TeamPolicy(model, search, self.patience, self.seconds)
