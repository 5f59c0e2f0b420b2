"""A search problem as arrays: the belief's way under pursuers that go from checkpoint to checkpoint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from planners.graph import SearchGraph
from planners.policy import PursuerState, SearchProblem

if TYPE_CHECKING:
    from planners.motion import Sparse

__all__ = ["Looks", "PursuerHops", "SearchModel"]

# Up to here a dense product of many beliefs with the matrix is faster than a sparse one (measured, two cores).
DENSE_STATES = 192


@dataclass(frozen=True, slots=True)
class PursuerHops:
    """The hops of one pursuer in belief steps: what it looks from while it goes along each edge.

    Attributes
    ----------
    steps : ndarray of intp, shape (E,)
        Belief steps that each edge takes: ``max(1, round(time / time_step))``.
    views : ndarray of intp, shape (E, max(steps))
        Viewpoint after each step; the last one is repeated to the end of the row.
    """

    steps: NDArray[np.intp]
    views: NDArray[np.intp]

    @classmethod
    def of(cls, problem: SearchProblem, speed: float) -> PursuerHops:
        """Divide every edge into belief steps for a pursuer of this speed, metres a second."""
        length = problem.graph.length
        steps = np.maximum(1, np.rint(length / (speed * problem.time_step))).astype(np.intp)
        views = np.empty((len(steps), steps.max(initial=1)), dtype=np.intp)
        for edge, n in enumerate(steps):
            way = length[edge] * np.arange(1, n + 1) / n
            row = problem.capture.viewpoints(problem.graph, edge, way)
            views[edge, :n], views[edge, n:] = row, row[-1]
        return cls(steps, views)


class Looks:
    """Shares of the belief that stay unseen from each viewpoint, applied to many beliefs at once."""

    def __init__(self, table: Sparse) -> None:
        self.table = table
        self._start, self._count = table.indptr[:-1].astype(np.intp), np.diff(table.indptr).astype(np.intp)
        self._state, self._kept = table.indices, 1.0 - table.data

    def apply(self, beliefs: NDArray[np.float64], views: NDArray[np.intp]) -> None:
        """Take from row ``k`` of ``beliefs``, shape (K, N), what is seen from viewpoint ``views[k]``; in place."""
        count = self._count[views]
        row = np.repeat(np.arange(len(views)), count)
        first = np.repeat(self._start[views] - (np.cumsum(count) - count), count)
        entry = first + np.arange(len(row))
        beliefs[row, self._state[entry]] *= self._kept[entry]

    def chance(self, beliefs: NDArray[np.float64], views: NDArray[np.intp]) -> NDArray[np.float64]:
        """Return what viewpoint ``views[k]`` would see of row ``k`` of ``beliefs``, shape (K,)."""
        count = self._count[views]
        row = np.repeat(np.arange(len(views)), count)
        first = np.repeat(self._start[views] - (np.cumsum(count) - count), count)
        entry = first + np.arange(len(row))
        seen = beliefs[row, self._state[entry]] * (1.0 - self._kept[entry])
        return np.bincount(row, weights=seen, minlength=len(views)).astype(np.float64)

    def kept(self, views: NDArray[np.intp]) -> NDArray[np.float64]:
        """Return the share of each state that stays unseen from each viewpoint, shape (K, N)."""
        return np.asarray(1.0 - self.table[views].toarray())


class SearchModel:
    """What planners compute from a problem once.

    Beliefs here are without the capture state, shape (N,): its probability is what is missing to 1.

    Parameters
    ----------
    problem : SearchProblem
        The problem; its matrix and capture table are made here.
    """

    graph: SearchGraph
    dispersion: Sparse | NDArray[np.float64]

    def __init__(self, problem: SearchProblem) -> None:
        self.graph = problem.graph
        self.step = problem.time_step
        self.speeds = problem.speeds
        inner = problem.motion.matrix(problem.graph, problem.time_step)[1:, 1:]
        self.states = inner.shape[0]
        self.dispersion = inner.toarray() if self.states <= DENSE_STATES else inner.tocsr()
        self.looks = Looks(problem.capture.table(problem.graph))
        by_speed = {speed: PursuerHops.of(problem, speed) for speed in sorted(set(problem.speeds))}
        self.hops = tuple(by_speed[speed] for speed in problem.speeds)

    def timeline(self, pursuer: int, state: PursuerState) -> NDArray[np.intp]:
        """Return where a pursuer looks from at the steps to come if it ends the hop it is on and then stands still.

        Returns
        -------
        ndarray of intp, shape (T,), T >= 1
            Viewpoint after each step; it stays at the last one.
        """
        if state.target is None:
            return np.array([state.cell], dtype=np.intp)
        left = int(np.rint(state.time_left / self.step))
        if state.cell == state.target:
            return np.full(max(1, left), state.target, dtype=np.intp)
        edge = self.graph.edge(state.cell, state.target)
        steps = int(self.hops[pursuer].steps[edge])
        return self.hops[pursuer].views[edge, max(0, steps - max(1, left)) : steps]

    def unseen(self, timelines: list[NDArray[np.intp]]) -> NDArray[np.float64]:
        """Return the share of each state that several pursuers leave unseen at each step to come.

        Returns
        -------
        ndarray, shape (T, N)
            T as long as the longest timeline; the last row holds from then on.
        """
        horizon = max((len(t) for t in timelines), default=1)
        kept = np.ones((horizon, self.states))
        for timeline in timelines:
            padded = np.concatenate([timeline, np.full(horizon - len(timeline), timeline[-1])])
            kept *= self.looks.kept(padded)
        return kept
