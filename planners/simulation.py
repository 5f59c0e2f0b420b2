"""A search problem as arrays: the belief's way under pursuers that go from checkpoint to checkpoint."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from planners.capture import CaptureModel
from planners.graph import SearchGraph
from planners.policy import PursuerState, SearchProblem

if TYPE_CHECKING:
    from planners.motion import Sparse

__all__ = ["Looks", "Moves", "SearchModel"]

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Moves:
    """What a pursuer can do at a checkpoint, in belief steps: wait for one step, or go to a neighbour.

    The moves from cell ``c`` are ``start[c]`` to ``start[c + 1] - 1``: the wait first, then the edges in the order
    of the graph; edge ``e`` from cell ``c`` is move ``e + c + 1``.

    Attributes
    ----------
    start : ndarray of intp, shape (C + 1,)
        Where the moves of each cell begin.
    target : ndarray of intp, shape (M,)
        Cell at whose checkpoint each move ends.
    steps : ndarray of intp, shape (M,)
        Belief steps that each move takes: ``max(1, round(time / time_step))`` along an edge.
    views : ndarray of intp, shape (M, max(steps))
        Viewpoint after each step, a row of :class:`Looks`; the last one is repeated to the end of the row.
    """

    start: NDArray[np.intp]
    target: NDArray[np.intp]
    steps: NDArray[np.intp]
    views: NDArray[np.intp]

    @classmethod
    def of(cls, problem: SearchProblem, speed: float, capture: CaptureModel, first: int) -> Moves:
        """Divide every edge into belief steps for a pursuer of some speed (metres a second) and capture model.

        ``first`` is the row of :class:`Looks` at which this model's viewpoints begin.
        """
        graph = problem.graph
        cells = np.arange(len(graph))
        length = graph.length
        wait, go = graph.indptr[:-1] + cells, np.arange(len(length)) + np.repeat(cells, graph.degree) + 1
        target, steps = np.empty((2, len(cells) + len(length)), dtype=np.intp)
        target[wait], target[go] = cells, graph.indices
        steps[wait], steps[go] = 1, np.maximum(1, np.rint(length / (speed * problem.time_step)))
        views = np.repeat(target[:, np.newaxis], steps.max(), axis=1)
        for edge, move in enumerate(go):
            n = steps[move]
            way = length[edge] * np.arange(1, n + 1) / n
            views[move, :n] = capture.viewpoints(graph, edge, way)
            views[move, n:] = views[move, n - 1]
        return cls(graph.indptr + np.arange(len(graph) + 1), target, steps, views + first)


class Looks:
    """What is seen from each viewpoint, taken from many beliefs at once."""

    def __init__(self, table: Sparse) -> None:
        self.table = table
        self._start, self._count = table.indptr[:-1].astype(np.intp), np.diff(table.indptr).astype(np.intp)
        self._state, self._share = table.indices, table.data

    def take(self, beliefs: NDArray[np.float64], views: NDArray[np.intp]) -> None:
        """Take from row ``k`` of ``beliefs``, shape (K, N), what is seen from viewpoint ``views[k]``; in place."""
        row, entry = self._entries(views)
        beliefs[row, self._state[entry]] *= 1.0 - self._share[entry]

    def chance(
        self, beliefs: NDArray[np.float64], views: NDArray[np.intp], rows: NDArray[np.intp] | None = None
    ) -> NDArray[np.float64]:
        """Return how much viewpoint ``views[k]`` sees of row ``k`` (or ``rows[k]``) of ``beliefs``, shape (K,)."""
        row, entry = self._entries(views)
        seen = beliefs[row if rows is None else rows[row], self._state[entry]] * self._share[entry]
        return np.bincount(row, weights=seen, minlength=len(views)).astype(np.float64)

    def kept(self, views: NDArray[np.intp]) -> NDArray[np.float64]:
        """Return the share of each state that stays unseen from each viewpoint, shape (K, N)."""
        return np.asarray(1.0 - self.table[views].toarray())

    def _entries(self, views: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Return the entries of the table for all views, one after another, and which view each belongs to."""
        count = self._count[views]
        row = np.repeat(np.arange(len(views)), count)
        first = np.repeat(self._start[views] - (np.cumsum(count) - count), count)
        return row, first + np.arange(len(row))


class SearchModel:
    """What planners compute from a problem once.

    Beliefs here are without the capture state, shape (N,): its probability is what is missing to 1.

    Parameters
    ----------
    problem : SearchProblem
        The problem; its matrix and capture tables are made here.

    Attributes
    ----------
    kinds : tuple of Moves
        One for each kind of pursuer; those of a kind have equal speeds and capture models.
    kind : tuple of int
        Kind of each pursuer.
    """

    graph: SearchGraph
    dispersion: Sparse

    def __init__(self, problem: SearchProblem) -> None:
        self.graph = problem.graph
        self.step = problem.time_step
        self.speeds = problem.speeds
        inner = problem.motion.matrix(problem.graph, problem.time_step)[1:, 1:]
        self.states = inner.shape[0]
        self.dispersion = inner.tocsr()
        self._transposed = inner.T.tocsr()
        captures = _different(problem.captures)
        tables = [capture.table(problem.graph) for capture in captures]
        first = np.cumsum([0, *(table.shape[0] for table in tables)])
        self.looks = Looks(_stacked(tables))
        pursuers = list(zip(problem.speeds, map(captures.index, problem.captures), strict=True))
        kinds = _different(pursuers)
        self.kind = tuple(map(kinds.index, pursuers))
        self.kinds = tuple(Moves.of(problem, speed, captures[k], int(first[k])) for speed, k in kinds)
        self.moves = tuple(self.kinds[k] for k in self.kind)

    def disperse(self, beliefs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return many beliefs, shape (K, N), one step of the evader's motion later.

        A sparse product throughout: for 60 cells it is as fast as a dense one, and it does not wait for threads that
        another program holds up.
        """
        return np.ascontiguousarray((self._transposed @ beliefs.T).T)

    def reach(self, pursuer: int) -> NDArray[np.float64]:
        """Return how many steps a pursuer at each checkpoint is away from a checkpoint that sees each state.

        Returns
        -------
        ndarray, shape (C, N)
            Belief steps; states that it can never see from a checkpoint are as far as the farthest that it can.
        """
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import dijkstra

        moves, cells = self.moves[pursuer], len(self.graph)
        tail = np.repeat(np.arange(cells), self.graph.degree)
        steps: NDArray[np.float64] = np.delete(moves.steps, moves.start[:-1]).astype(np.float64)
        apart = dijkstra(coo_array((steps, (tail, self.graph.indices)), shape=(cells, cells)))
        seen = self.looks.table[moves.views[moves.start[:-1], 0]].tocoo()
        nearest = np.full((self.states, cells), np.inf)
        np.minimum.at(nearest, seen.coords[1], apart[seen.coords[0]])
        finite = np.isfinite(nearest)
        return np.ascontiguousarray(np.where(finite, nearest, nearest[finite].max(initial=0.0)).T)

    def move(self, cell: int, target: int) -> int:
        """Return the move from a cell to a neighbour, or the wait in the cell; GraphError where there is none."""
        if cell == target:
            return int(self.graph.indptr[cell]) + cell
        return self.graph.edge(cell, target) + cell + 1

    def length_of(self, moves: NDArray[np.intp]) -> NDArray[np.float64]:
        """Return the way that each move goes, metres; 0 for a wait."""
        cell = np.searchsorted(self.moves[0].start, moves, side="right") - 1
        wait = moves == self.moves[0].start[cell]
        return np.where(wait, 0.0, np.append(self.graph.length, 0.0)[moves - cell - 1])

    def under_way(self, pursuer: int, state: PursuerState) -> tuple[int, int]:
        """Return the move that a pursuer is on and how many of its steps are done.

        At a checkpoint that is the wait there, done. Past the portal it does not matter any more where the pursuer
        came from: it is on the wait in its cell, so many steps below 0 as it needs to the checkpoint.
        """
        if state.target is None:
            return self.move(state.cell, state.cell), 1
        left = max(1, int(np.rint(state.time_left / self.step)))
        move = self.move(state.cell, state.target)
        steps = int(self.moves[pursuer].steps[move])
        return move, steps - left if state.cell == state.target else max(0, steps - left)

    def pursuer_state(self, pursuer: int, move: int, done: int) -> PursuerState:
        """Return the state of a pursuer that has done so many steps of a move."""
        moves = self.moves[pursuer]
        cell = int(np.searchsorted(moves.start, move, side="right")) - 1
        target, steps = int(moves.target[move]), int(moves.steps[move])
        if done >= steps:
            return PursuerState(target)
        if cell != target:
            edge = move - cell - 1
            entered = done / steps * self.graph.length[edge] >= self.graph.leave[edge] - 1e-9
            cell = target if entered else cell
        return PursuerState(cell, target, (steps - done) * self.step)

    def timeline(self, pursuer: int, state: PursuerState) -> NDArray[np.intp]:
        """Return where a pursuer looks from at the steps to come if it ends the hop it is on and then stands still.

        Returns
        -------
        ndarray of intp, shape (T,), T >= 1
            Viewpoint after each step; it stays at the last one.
        """
        move, done = self.under_way(pursuer, state)
        moves = self.moves[pursuer]
        ahead = np.arange(done, max(int(moves.steps[move]), done + 1))
        looks: NDArray[np.intp] = moves.views[move, np.clip(ahead, 0, moves.steps[move] - 1)]
        return looks

    def views_along(self, pursuer: int, move: int, done: int, plan: Sequence[int], steps: int) -> NDArray[np.intp]:
        """Return where a pursuer looks from after each of the next steps, for which its plan must last; shape (T,)."""
        table = self.moves[pursuer]
        views: list[int] = []
        for m, begin in [(move, done), *((m, 0) for m in plan)]:
            views += table.views[m, np.maximum(np.arange(begin, table.steps[m]), 0)].tolist()
            if len(views) >= steps:
                break
        return np.array(views[:steps], dtype=np.intp)

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

    def together(self, first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what two groups of pursuers leave unseen, each as :meth:`unseen` gives it, if both look."""
        step = np.arange(max(len(first), len(second)))
        return np.asarray(first[np.minimum(step, len(first) - 1)] * second[np.minimum(step, len(second) - 1)])

    def foresee(
        self,
        belief: NDArray[np.float64],
        moves: Sequence[int],
        done: Sequence[int],
        plans: Sequence[Sequence[int]],
        steps: int,
    ) -> NDArray[np.float64]:
        """Return the beliefs to come under a plan.

        Parameters
        ----------
        belief : ndarray, shape (N,)
            Probability of each state now.
        moves, done : sequence of int
            The move that each pursuer is on, and how many of its steps are done.
        plans : sequence of sequence of int
            The moves that each pursuer begins after that.
        steps : int
            How many belief steps to look ahead.

        Returns
        -------
        ndarray, shape (T + 1, N)
            The belief now and after each step; T is ``steps``, or less if one of the plans ends before.
        """
        on, gone, to_come = list(moves), list(done), [iter(plan) for plan in plans]
        beliefs = [belief]
        for _ in range(steps):
            after = self._transposed @ beliefs[-1]
            for i, table in enumerate(self.moves):
                if gone[i] >= table.steps[on[i]]:
                    following = next(to_come[i], None)
                    if following is None:
                        return np.array(beliefs)
                    on[i], gone[i] = following, 0
                self.looks.take(after[np.newaxis], table.views[on[i], [max(0, gone[i])]])
                gone[i] += 1
            beliefs.append(after)
        return np.array(beliefs)


def _different(things: Sequence[T]) -> list[T]:
    """Return each thing once, in the order in which they first come; they need not be hashable."""
    return [one for k, one in enumerate(things) if one not in things[:k]]


def _stacked(tables: Sequence[Sparse]) -> Sparse:
    from scipy.sparse import csr_array, vstack

    return csr_array(vstack(tables))
