"""Baselines of Section V: robots that wander, and robots that stand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from planners.graph import SearchGraph
from planners.policy import Decision, SearchProblem, SearchState

__all__ = ["Random", "Stationary"]


@dataclass(frozen=True, slots=True)
class Random:
    """Every pursuer goes to a uniformly random neighbour of its cell (Section V-A, the random method)."""

    def solve(self, problem: SearchProblem, rng: np.random.Generator) -> RandomPolicy:
        """Prepare a policy that draws from ``rng``."""
        return RandomPolicy(problem.graph, rng)


@dataclass(frozen=True, slots=True)
class RandomPolicy:
    """The policy of :class:`Random` for one problem."""

    graph: SearchGraph
    rng: np.random.Generator = field(repr=False)

    def decide(self, state: SearchState) -> Sequence[Decision | None]:
        """Return one random hop for each pursuer at a checkpoint; it stays where there is no neighbour."""
        return [self._hop(p.cell) if p.target is None else None for p in state.pursuers]

    def _hop(self, cell: int) -> Decision:
        ways = self.graph.neighbours(cell)
        return Decision((int(self.rng.choice(ways)) if len(ways) else cell,))


@dataclass(frozen=True, slots=True)
class Stationary:
    """Every pursuer remains in its starting cell (Section V-A, the stationary pursuer method)."""

    def solve(self, problem: SearchProblem, rng: np.random.Generator) -> StationaryPolicy:  # noqa: ARG002  (no chance)
        """Prepare a policy; nothing in it is random."""
        return StationaryPolicy()


@dataclass(frozen=True, slots=True)
class StationaryPolicy:
    """The policy of :class:`Stationary`."""

    def decide(self, state: SearchState) -> Sequence[Decision | None]:
        """Return the pursuer's own cell for each pursuer at a checkpoint."""
        return [Decision((p.cell,)) if p.target is None else None for p in state.pursuers]
