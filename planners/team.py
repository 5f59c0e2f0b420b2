"""Plans of the whole team for some time ahead, followed until it is time to plan anew."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from maps import GeomsimError
from planners.clock import Clock
from planners.policy import Decision, SearchState
from planners.simulation import SearchModel

__all__ = ["PlannerError", "TeamPolicy", "TeamSearch", "at_least", "at_most"]

# The belief may differ from what the plan foresaw by this much, in total, before the team plans anew: times in the
# world are not whole belief steps.
SURPRISE = 0.05


class PlannerError(GeomsimError):
    """A planner that does not exist, or a parameter that it cannot take."""


def at_least(least: int, **parameters: int | float) -> None:
    """Raise PlannerError for the first parameter that is below ``least``, or no number."""
    for name, value in parameters.items():
        if not value >= least:
            raise PlannerError(f"A planner's {name} must be at least {least}; got {value}.")


def at_most(most: int, **parameters: int | float) -> None:
    """Raise PlannerError for the first parameter that is above ``most``, or no number."""
    for name, value in parameters.items():
        if not value <= most:
            raise PlannerError(f"A planner's {name} must be at most {most}; got {value}.")


class TeamSearch(Protocol):
    """Plans for all pursuers at once."""

    def __call__(
        self,
        belief: NDArray[np.float64],
        moves: Sequence[int],
        done: Sequence[int],
        announced: Sequence[Sequence[int]],
        clock: Clock,
    ) -> Sequence[Sequence[int]]:
        """Return the moves that each pursuer begins.

        Parameters
        ----------
        belief : ndarray, shape (N,)
            Probability of each state now.
        moves, done : sequence of int
            The move that each pursuer is on, and how many of its steps are done.
        announced : sequence of sequence of int
            Moves that each pursuer means to begin, from an earlier plan.
        clock : Clock
            Ends the search: it returns the best plan that it has.
        """
        ...


class TeamPolicy:
    """Follows a plan for ``patience`` belief steps, or until the belief is not what it foresaw, then plans anew.

    "Not caught yet" is all that a team learns, and its plan has taken that into account; so there is nothing to plan
    anew for but a better plan, a measurement, and the times that things take in the world. A plan may take ``seconds``.
    """

    def __init__(self, model: SearchModel, search: TeamSearch, patience: int, seconds: float) -> None:
        self.model, self.search, self.patience, self.seconds = model, search, patience, seconds
        self._searched = -np.inf
        self._foreseen: NDArray[np.float64] = np.empty((0, model.states))

    def decide(self, state: SearchState) -> Sequence[Decision | None]:
        """Return for each pursuer at a checkpoint the rest of its plan."""
        plans = [list(plan) for plan in state.plans]
        if self._due(state):
            plans = self._plan(state)
        return [
            Decision(tuple(plan) or (p.cell,)) if p.target is None else None
            for p, plan in zip(state.pursuers, plans, strict=True)
        ]

    def _due(self, state: SearchState) -> bool:
        if any(p.target is None and not plan for p, plan in zip(state.pursuers, state.plans, strict=True)):
            return True
        elapsed = (state.time - self._searched) / self.model.step
        if not 0 <= round(min(elapsed, 1e9)) < min(self.patience, len(self._foreseen)):
            return True
        return bool(np.abs(state.belief[1:] - self._foreseen[round(elapsed)]).sum() > SURPRISE)

    def _plan(self, state: SearchState) -> list[list[int]]:
        clock = Clock(self.seconds)
        under_way = [self.model.under_way(i, pursuer) for i, pursuer in enumerate(state.pursuers)]
        moves, done = [move for move, _ in under_way], [k for _, k in under_way]
        announced = [self._moves(i, moves[i], plan) for i, plan in enumerate(state.plans)]
        plans = self.search(state.belief[1:], moves, done, announced, clock)
        self._searched = state.time
        self._foreseen = self.model.foresee(state.belief[1:], moves, done, plans, self.patience)
        return [[int(t) for t in self.model.moves[i].target[list(plan)]] for i, plan in enumerate(plans)]

    def _moves(self, pursuer: int, move: int, path: Sequence[int]) -> list[int]:
        cell = int(self.model.moves[pursuer].target[move])
        moves = []
        for target in path:
            moves.append(self.model.move(cell, target))
            cell = target
        return moves
