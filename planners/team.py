"""A plan of the whole team for a long time ahead, kept and improved while it is carried out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planners.beam import BeamSearch
from planners.lookahead import PlannerError
from planners.policy import Decision, SearchProblem, SearchState
from planners.simulation import SearchModel

__all__ = ["Beam"]

# The belief may differ from what the plan foresaw by this much, in total, before the team plans anew: times in the
# world are not whole belief steps.
SURPRISE = 0.05


@dataclass(frozen=True, slots=True)
class Beam:
    """The team plans jointly, for a long time ahead, to be expected to capture as soon as possible.

    What is minimised is the mission's own aim, the expected time to capture: the sum over time of the probability
    of no capture, which does not favour short hops as a sum over hops does. The search is a beam search, see
    :class:`planners.beam.BeamSearch`. The team keeps to its plan for ``patience`` steps, or until the belief is not
    what the plan foresaw, and then searches anew; the plan that it has announced competes, so that E[T] never rises.

    Attributes
    ----------
    width : int
        Plans that are pursued at a time; more is better and proportionally slower.
    horizon : int
        Longest time to plan for, belief steps.
    patience : int
        Time between two searches, belief steps.
    alike : int
        Plans of the same joint position that are pursued at a time.

    Raises
    ------
    PlannerError
        If one of them is below 1.
    """

    width: int = 100
    horizon: int = 120
    patience: int = 10
    alike: int = 1

    def __post_init__(self) -> None:
        for name in ("width", "horizon", "patience", "alike"):
            if getattr(self, name) < 1:
                raise PlannerError(f"A beam search's {name} must be at least 1; got {getattr(self, name)}.")

    def solve(self, problem: SearchProblem, rng: np.random.Generator) -> BeamPolicy:  # noqa: ARG002  (no chance)
        """Prepare a policy; nothing in it is random."""
        model = SearchModel(problem)
        search = BeamSearch(model, width=self.width, alike=self.alike, horizon=self.horizon)
        return BeamPolicy(model, search, self.patience)


class BeamPolicy:
    """The policy of :class:`Beam` for one problem; it remembers when it searched last and what it foresaw."""

    def __init__(self, model: SearchModel, search: BeamSearch, patience: int) -> None:
        self.model, self.search, self.patience = model, search, patience
        self._searched = -np.inf
        self._foreseen: NDArray[np.float64] = np.empty((0, model.states))

    def decide(self, state: SearchState) -> Sequence[Decision | None]:
        """Return for each pursuer at a checkpoint the rest of its plan."""
        team = state.pursuers
        plans = [list(plan) for plan in state.plans]
        if self._due(state):
            plans = self._search(state)
        return [
            Decision(tuple(plan) or (p.cell,)) if p.target is None else None
            for p, plan in zip(team, plans, strict=True)
        ]

    def _due(self, state: SearchState) -> bool:
        if any(p.target is None and not plan for p, plan in zip(state.pursuers, state.plans, strict=True)):
            return True
        elapsed = round((state.time - self._searched) / self.model.step) if np.isfinite(self._searched) else -1
        if not 0 <= elapsed < min(self.patience, len(self._foreseen)):
            return True
        return bool(np.abs(state.belief[1:] - self._foreseen[elapsed]).sum() > SURPRISE)

    def _search(self, state: SearchState) -> list[list[int]]:
        under_way = [self.model.under_way(i, pursuer) for i, pursuer in enumerate(state.pursuers)]
        moves, done = [move for move, _ in under_way], [k for _, k in under_way]
        announced = [self._moves(i, moves[i], plan) for i, plan in enumerate(state.plans)]
        plan = self.search.run(state.belief[1:], moves, done, announced)
        self._searched = state.time
        self._foreseen = self.model.foresee(state.belief[1:], moves, done, plan.moves, self.patience)
        return [[int(t) for t in self.model.moves[i].target[list(path)]] for i, path in enumerate(plan.moves)]

    def _moves(self, pursuer: int, move: int, path: Sequence[int]) -> list[int]:
        cell = int(self.model.moves[pursuer].target[move])
        moves = []
        for target in path:
            moves.append(self.model.move(cell, target))
            cell = target
        return moves
