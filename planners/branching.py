"""The best joint plan over a fixed time, with a proof: branch and bound over one pursuer's moves after another's."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planners.simulation import SearchModel

__all__ = ["Certificate", "JointSearch"]

# Nodes between two looks at the clock: a millisecond or two.
BATCH = 100


@dataclass(frozen=True, slots=True)
class Certificate:
    """A joint plan over a fixed time and what is proven about it.

    Attributes
    ----------
    value : float
        The weighted sum over steps of the probability of capture by then.
    bound : float
        No plan has a higher value.
    moves : tuple of tuple of int
        The moves that each pursuer begins, one after another.
    nodes : int
        Nodes that were opened.
    seconds : float
        Time that it took.
    """

    value: float
    bound: float
    moves: tuple[tuple[int, ...], ...]
    nodes: int
    seconds: float

    @property
    def gap(self) -> float:
        """How far the plan may be from the best one, as a share of the bound; 0 where it is proven to be the best."""
        return max(0.0, 1.0 - self.value / self.bound) if self.bound > 0 else 0.0


class JointSearch:
    """Searches all joint plans of a team over ``horizon`` steps.

    The value of a plan is ``sum_t discount^t p0(t)``, t = 1 ... horizon, with p0 the capture state's probability: as
    much as to minimise the time not captured over the horizon. The pursuers' paths are fixed one after another; what
    a path adds to those before it is linear in the mass that its looks take (see :mod:`planners.kernels`), and what a
    pursuer not yet fixed can add is bounded by a relaxation in which its looks hardly take anything from each other
    (after the MEAN bound for the optimal searcher path problem), so that the last pursuer is answered exactly.

    Parameters
    ----------
    model : SearchModel
        The problem.
    horizon : int
        Belief steps.
    discount : float
        Weight of each belief step relative to the one before it.
    """

    def __init__(self, model: SearchModel, *, horizon: int, discount: float) -> None:
        self.model, self.horizon = model, horizon
        weight = discount ** np.arange(1, horizon + 1)
        self.weight = np.concatenate([[0.0], np.cumsum(weight[::-1])[::-1]])
        self.weight[0] = self.weight[1]
        matrix, table = model.dispersion, model.looks.table
        self.motion = (matrix.indptr.astype(np.int64), matrix.indices.astype(np.int64), matrix.data)
        self.looks = (
            table.indptr.astype(np.int64), table.indices.astype(np.int64), table.data, table.toarray()
        )  # fmt: skip
        self.kind, kinds = np.array(model.kind), model.kinds
        longest = max(moves.views.shape[1] for moves in kinds)
        views = [np.pad(moves.views, ((0, 0), (0, longest - moves.views.shape[1])), mode="edge") for moves in kinds]
        steps = [moves.steps for moves in kinds]
        self.moves = tuple(
            np.ascontiguousarray(a, dtype=np.int64) for a in (kinds[0].start, kinds[0].target, steps, views)
        )

    def value(
        self,
        belief: NDArray[np.float64],
        moves: Sequence[int],
        done: Sequence[int],
        plans: Sequence[Sequence[int]],
    ) -> float:
        """Return the value of a plan of the whole team; who has no more moves waits."""
        left = self.model.foresee(belief, moves, done, self.fill(moves, plans), self.horizon).sum(axis=1)
        return float(-np.diff(left) @ self.weight[1:])

    def fill(self, moves: Sequence[int], plans: Sequence[Sequence[int]]) -> list[list[int]]:
        """Return plans that last for the horizon: who has no more moves waits."""
        filled = []
        for table, move, plan in zip(self.model.moves, moves, plans, strict=True):
            cell = int(table.target[plan[-1] if len(plan) else move])
            filled.append([*plan, *[self.model.move(cell, cell)] * self.horizon])
        return filled

    def run(
        self,
        belief: NDArray[np.float64],
        moves: Sequence[int],
        done: Sequence[int],
        plans: Sequence[Sequence[int]],
        *,
        who: Sequence[int] | None = None,
        absent: Sequence[int] = (),
        nodes: int = 1_000_000,
        seconds: float = np.inf,
    ) -> Certificate:
        """Return the best plan found, and a bound on all.

        Parameters
        ----------
        belief : ndarray, shape (N,)
            Probability of each state now.
        moves, done : sequence of int
            The move that each pursuer is on, and how many of its steps are done.
        plans : sequence of sequence of int
            A plan that is known already, the moves that each pursuer begins; the search looks for a better one.
        who : sequence of int, optional
            The pursuers whose plans may change; without it all of them.
        absent : sequence of int
            Pursuers that are left out, as if they saw nothing.
        nodes : int
            The search ends after about this many nodes.
        seconds : float
            The search ends after this time.
        """
        from planners.kernels import begin_search, open_bound, search

        begun = time.perf_counter()
        who = [i for i in (range(len(moves)) if who is None else who) if self._free_at(i, moves, done) < self.horizon]
        fixed = self._certain(moves, done, self.fill(moves, plans), who, absent)
        if not who:
            value = self._worth_of(belief, fixed)
            return Certificate(value, value, tuple(tuple(plan) for plan in plans), 0, time.perf_counter() - begun)
        best = known = 0.0 if absent else self.value(belief, moves, done, plans)
        task, state, tables = self._prepare(belief, moves, done, who, fixed)
        answer = np.full(len(state[0]), -1)
        level, opened = begin_search(self._worth_of(belief, fixed), task, state, tables), 0
        while level >= 0 and opened < nodes and time.perf_counter() - begun < seconds:
            level, best, more = search(level, best, min(BATCH, nodes - opened), task, state, tables, answer)
            opened += more
        bound = float(open_bound(level, best, task, state))
        found = [tuple(int(m) for m in plan) for plan in plans]
        if best > known:
            k = 0
            for i, rest in zip(who, task[5][:, 0], strict=True):
                length = self._length(i, answer[k:], int(rest))
                found[i] = tuple(int(m) for m in answer[k : k + length])
                k += length
        return Certificate(float(best), bound, tuple(found), opened, time.perf_counter() - begun)

    def _free_at(self, pursuer: int, moves: Sequence[int], done: Sequence[int]) -> int:
        """Return after how many steps a pursuer is at a checkpoint."""
        return max(0, int(self.model.moves[pursuer].steps[moves[pursuer]]) - done[pursuer])

    def _length(self, pursuer: int, moves: NDArray[np.int64], begin: int) -> int:
        """Return how many moves it takes from step ``begin`` to the horizon."""
        end = begin + np.cumsum(self.model.moves[pursuer].steps[moves])
        return int(np.searchsorted(end, self.horizon)) + 1

    def _certain(
        self,
        moves: Sequence[int],
        done: Sequence[int],
        plans: Sequence[Sequence[int]],
        who: Sequence[int],
        absent: Sequence[int],
    ) -> NDArray[np.float64]:
        """Return the share of each state that is left, shape (H, N), by all looks that the search does not choose."""
        kept = np.ones((self.horizon, self.model.states))
        for i in range(len(moves)):
            if i in absent:
                continue
            views = self.model.views_along(i, moves[i], done[i], plans[i], self.horizon)
            rest = self._free_at(i, moves, done) if i in who else self.horizon
            kept[:rest] *= self.model.looks.kept(views[:rest])
        return kept

    def _worth_of(self, belief: NDArray[np.float64], unseen: NDArray[np.float64]) -> float:
        """Return the value of looks that leave so much of each state unseen."""
        free, total = belief[np.newaxis], 0.0
        for t in range(self.horizon):
            free = self.model.disperse(free)
            total += float(self.weight[t + 1] * (free * (1.0 - unseen[t])).sum())
            free = free * unseen[t]
        return total

    def _prepare(
        self,
        belief: NDArray[np.float64],
        moves: Sequence[int],
        done: Sequence[int],
        who: Sequence[int],
        fixed: NDArray[np.float64],
    ) -> tuple[Any, Any, Any]:
        """Return the arrays that the compiled search works on: what to solve, its nodes, and its tables."""
        model, horizon, team = self.model, self.horizon, len(who)
        first = np.zeros((team, 2), dtype=np.int64)
        for k, i in enumerate(who):
            first[k] = self._free_at(i, moves, done), model.moves[i].target[moves[i]]
        kind = self.kind[list(who)]
        twins = team == 2 and bool(kind[0] == kind[1] and (first[0] == first[1]).all())
        # A level for each step of each pursuer, and a spare one.
        levels, widest = team * (horizon + 1) + 2, int(np.diff(model.graph.indptr).max()) + 1
        task = (belief, self.motion, self.looks, self.moves, kind, first, twins, self.weight)
        state = (
            *np.zeros((3, levels), dtype=np.int64),
            np.zeros(levels),
            np.zeros((levels, widest)),
            np.zeros((levels, widest), dtype=np.bool_),
            np.zeros(levels, dtype=np.int64),
        )
        unseen = np.ones((team + 1, horizon, model.states))
        unseen[0] = fixed
        tables = (
            np.zeros((levels, horizon + 1, model.states)),
            unseen,
            np.zeros((team + 1, horizon + 1, model.states)),
            np.zeros((team, horizon), dtype=np.int64),
            np.zeros((horizon + 1, len(model.graph))),
            np.zeros((horizon + 1, len(model.graph)), dtype=np.bool_),
        )
        return task, state, tables
