"""The best joint plan over a fixed time, with a proof: branch and bound over one pursuer's moves after another's."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from planners.clock import FOREVER, Clock
from planners.simulation import Moves, SearchModel

if TYPE_CHECKING:
    from planners.motion import Sparse

__all__ = ["Certificate", "JointSearch"]

# Nodes of the joint search between two looks at the clock.
BATCH = 10

# Nodes of the first search for one pursuer's path.
FIRST_BUDGET = 10_000

# Links between looks that are worth their memory.
MOST_LINKS = 5_000_000


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
    much as to minimise the time not captured over the horizon. The pursuers' paths are fixed one after another, the
    last pursuer is answered exactly, and what those not yet fixed can add is bounded by priced looks, see
    :mod:`planners.pricing`; in one pursuer's own search by a relaxation in which its looks hardly take anything from
    each other (after the MEAN bound for the optimal searcher path problem), see :mod:`planners.kernels`.

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
        from planners.kernels import Look, Motion

        self.model, self.horizon = model, horizon
        weight = discount ** np.arange(1, horizon + 1)
        self.weight = np.concatenate([[0.0], np.cumsum(weight[::-1])[::-1]])
        self.weight[0] = self.weight[1]
        self.motion = Motion(*_rows(model.dispersion))
        self.looks = Look(*_rows(model.looks.table))
        self.kind = np.array(model.kind)
        self.ways = _ways(model.kinds, self.motion, self.looks)
        self.stack = self._new_stack()

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
        clock: Clock = FOREVER,
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
        clock : Clock
            Ends the search.
        """
        begun = time.perf_counter()
        who = [i for i in (range(len(moves)) if who is None else who) if self._free_at(i, moves, done) < self.horizon]
        fixed = self._certain(moves, done, self.fill(moves, plans), who, absent)
        known = 0.0 if absent else self.value(belief, moves, done, plans)
        found = [tuple(int(m) for m in plan) for plan in plans]
        first = np.array([(self._free_at(i, moves, done), self.model.moves[i].target[moves[i]]) for i in who], np.int64)
        if not who:
            value = self._worth_of(belief, fixed)
            return Certificate(value, value, tuple(found), 0, time.perf_counter() - begun)
        if len(who) == 1:
            value, bound, opened, rows = self._one(belief, who[0], first[0], fixed, known, nodes, clock)
        else:
            value, bound, opened, rows = self._joint(belief, who, first, fixed, known, nodes, clock)
        if rows[0, 0] >= 0:
            for i, (free, _), row in zip(who, first, rows, strict=True):
                found[i] = tuple(int(m) for m in row[: self._length(i, row, int(free))])
        return Certificate(value, bound, tuple(found), opened, time.perf_counter() - begun)

    def _one(
        self,
        belief: NDArray[np.float64],
        pursuer: int,
        first: NDArray[np.intp],
        fixed: NDArray[np.float64],
        known: float,
        nodes: int,
        clock: Clock,
    ) -> tuple[float, float, int, NDArray[np.int64]]:
        """Return value, bound, nodes and moves of one pursuer's best path; searched anew with twice as many nodes."""
        from planners.kernels import ANYWHERE, best_path, new_path, values_from, weigh

        worth, seen, path = (
            np.empty((self.horizon + 1, self.model.states)),
            np.empty_like(fixed),
            new_path(self.horizon),
        )
        values_from(self.weight, fixed, self.motion, worth)
        base = weigh(belief, self.weight, fixed, self.motion, seen)
        free, opened, budget = belief[np.newaxis], 0, min(nodes, FIRST_BUDGET)
        begin, cell = int(first[0]), int(first[1])
        for t in range(begin):
            free = self.model.disperse(free) * fixed[t]
        best, ways = known - base, self.kind_of(pursuer)
        while True:
            self.stack.free[0, begin] = free[0]
            best, bound, more = best_path(
                begin, cell, fixed, worth, self.motion, self.looks, ways, self.stack, path, ANYWHERE, best, 0.0, budget
            )
            opened, budget = opened + more, 2 * budget
            if bound <= best or opened >= nodes or clock.over():
                return base + best, base + bound, opened, path.moves[np.newaxis]

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

    def _joint(
        self,
        belief: NDArray[np.float64],
        who: Sequence[int],
        first: NDArray[np.int64],
        fixed: NDArray[np.float64],
        known: float,
        nodes: int,
        clock: Clock,
    ) -> tuple[float, float, int, NDArray[np.int64]]:
        """Return value, bound, nodes and moves of the best joint plan of several pursuers."""
        from planners.pricing import AT_FIRST, Task, search

        kind = self.kind[list(who)]
        alike = bool((kind == kind[0]).all() and (first == first[0]).all())
        task = Task(belief, self.weight, self.motion, self.looks, self.ways, kind, first, alike)
        state, room = self._make_room(len(who))
        room.certain[0] = fixed
        level, best, opened = AT_FIRST, known, 0
        while level != -1 and opened < nodes and not clock.over():
            level, best, more = search(level, best, min(BATCH, nodes - opened), task, state, room)
            opened += more
        bound = max(best, room.summary[2])
        for k in range(level + 1):
            open_moves = ~state.used[k, : len(self.model.graph.neighbours(state.where[k])) + 1]
            bound = max(bound, state.bounds[k, : len(open_moves)].max(where=open_moves, initial=0.0))
        return float(best), float(bound), opened, room.plan

    def kind_of(self, pursuer: int) -> Any:
        """Return the moves of one pursuer for the compiled search."""
        start, target, steps, views, ptr, *links = self.ways
        kind = self.kind[pursuer]
        return type(self.ways)(start, target, steps[kind], views[kind], ptr[kind], *links)

    def _new_stack(self) -> Any:
        from planners.kernels import new_stack

        widest = int(np.diff(self.model.graph.indptr).max(initial=0)) + 1
        views = self.model.looks.table.shape[0]
        return new_stack(self.horizon, self.model.states, views, len(self.model.graph), widest)

    def _make_room(self, team: int) -> tuple[Any, Any]:
        """Return the nodes and the room of a joint search; made once for each number of pursuers."""
        from planners.pricing import Nodes, Room

        horizon, states, widest = self.horizon, self.model.states, self.stack.bounds.shape[1]
        # A level for each step of each pursuer but the last, and a spare one.
        levels, steps = (team - 1) * horizon + 1, (horizon, states)
        whole = np.int64
        nodes = Nodes(
            owner=np.zeros(levels, whole),
            when=np.zeros(levels, whole),
            where=np.zeros(levels, whole),
            value=np.zeros(levels),
            bounds=np.zeros((levels, widest)),
            used=np.zeros((levels, widest), dtype=np.bool_),
            move=np.zeros(levels, whole),
            later=np.zeros(levels),
            free=np.zeros((levels, horizon + 1, states)),
            frame=np.zeros(levels, whole),
            price=np.zeros((levels, *steps)),
            kept=np.ones((levels, *steps)),
            worth=np.zeros((levels, horizon + 1, states)),
            root=np.zeros((levels, horizon + 1, states)),
            gain=np.zeros(levels),
            gaze=np.zeros((team, horizon), whole),
        )
        room = Room(
            certain=np.ones((team + 1, *steps)),
            left=np.zeros(steps),
            worth=np.zeros((horizon + 1, states)),
            spare=np.zeros(steps),
            value=np.zeros((horizon + 1, states)),
            seen=np.zeros(steps),
            slope=np.zeros(steps),
            kept=np.zeros(steps),
            cheapest=np.zeros(steps),
            stack=self.stack,
            ahead=np.zeros_like(self.stack.ahead),
            moves=np.full((team, horizon), -1),
            gaze=np.full((team, horizon), -1),
            place=np.full((team, horizon + 1), -1),
            plan=np.full((team, horizon), -1),
            summary=np.zeros(3),
        )
        return nodes, room


def _rows(matrix: Sparse) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    return matrix.indptr.astype(np.int64), matrix.indices.astype(np.int64), matrix.data


def _ways(kinds: Sequence[Moves], motion: Any, looks: Any) -> Any:
    """Return the moves of all kinds of pursuers, with one more axis than those of one kind."""
    from planners.kernels import Ways, link_looks

    longest = max(moves.views.shape[1] for moves in kinds)
    start, target = kinds[0].start.astype(np.int64), kinds[0].target.astype(np.int64)
    steps = np.stack([moves.steps for moves in kinds]).astype(np.int64)
    views = np.stack([np.pad(m.views, ((0, 0), (0, longest - m.views.shape[1])), mode="edge") for m in kinds])
    views = views.astype(np.int64)
    ptr = np.zeros((*views.shape[:2], longest + 1), dtype=np.int64)
    links = (np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros(0))
    for fill in (False, True):
        count = 0
        for own_steps, own_views, own in zip(steps, views, ptr, strict=True):
            own[0, 0] = count
            link_looks(start, own_steps, own_views, motion, looks, own, fill, *links)
            count = int(own[-1, -1])
        if not fill:
            # Links tighten a bound that holds without them.
            if count > MOST_LINKS:
                ptr[:] = 0
                break
            links = (np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.int64), np.zeros(count))
    return Ways(start, target, steps, views, ptr, *links)
