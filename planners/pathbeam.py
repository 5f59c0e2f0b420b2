"""Plans over a long time by repeated responses, each found by a beam search that is compiled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planners.clock import FOREVER, Clock
from planners.simulation import SearchModel

__all__ = ["PathBeam"]

# Belief steps within which paths that come to a checkpoint compete with each other.
GRAIN = 3

# Plans closer than this share are equally good.
TIE = 1e-9

Plans = Sequence[Sequence[int]]


@dataclass(frozen=True, slots=True)
class _Answer:
    """Plans of a team, where its pursuers look from after each step (R, H), -1 for one without plan, and its value."""

    value: float
    gaze: NDArray[np.int64]
    plans: Plans


class PathBeam:
    """Answers the paths of a team's other pursuers with a good path for one, over ``horizon`` belief steps.

    The value of a plan is that of :class:`planners.branching.JointSearch`, whose answers are the best there are. Here
    only the most promising paths are followed, so that the time does not grow with the number of paths, and looks are
    sparse, so that there may be thousands of states.

    Parameters
    ----------
    model : SearchModel
        The problem.
    horizon : int
        Belief steps.
    discount : float
        Weight of each belief step relative to the one before it.
    width : int
        Paths that go on, of those that come to a checkpoint at about the same time.
    """

    def __init__(self, model: SearchModel, *, horizon: int, discount: float, width: int) -> None:
        self.model, self.horizon, self.width = model, horizon, width
        weight = discount ** np.arange(1, horizon + 1)
        weight = np.cumsum(weight[::-1])[::-1]
        self.weight = np.concatenate([weight[:1], weight, [0.0]])
        # what is left after a step is taken to be captured at a rate of half of it within half the horizon
        rate = np.log(2.0) / max(1.0, horizon / 2)
        share = np.exp(-rate * np.arange(horizon + 1))
        self.promise = np.array(
            [rate * (share[: horizon - t] * self.weight[t + 1 : horizon + 1]).sum() for t in range(horizon + 1)]
        )
        self.motion, table = _sources(model), model.looks.table
        self.looks = (table.indptr.astype(np.int64), table.indices.astype(np.int64), table.data)
        self.kinds = [
            tuple(np.ascontiguousarray(a, dtype=np.int64) for a in (kind.start, kind.target, kind.steps, kind.views))
            for kind in model.kinds
        ]

    def respond(
        self,
        belief: NDArray[np.float64],
        moves: Sequence[int],
        done: Sequence[int],
        announced: Plans,
        *,
        rounds: int,
        clock: Clock = FOREVER,
    ) -> Plans:
        """Return the plan of sequential allocation, or the one announced, after some rounds of responses.

        Parameters
        ----------
        belief : ndarray, shape (N,)
            Probability of each state now.
        moves, done : sequence of int
            The move that each pursuer is on, and how many of its steps are done.
        announced : sequence of sequence of int
            Moves that each pursuer means to begin; where there are some, they are what is improved.
        rounds : int
            Rounds of answers at most.
        clock : Clock
            No round is begun after its end.
        """
        team = range(len(moves))
        if any(announced):
            gaze = np.array([self._gaze(i, moves, done, announced[i]) for i in team])
            best = _Answer(self._worth(belief, gaze), gaze, list(announced))
        else:
            best = self._allocate(belief, moves, done, clock)
        for _ in range(rounds):
            before = best.value
            for i in team:
                best = self._answer(i, belief, moves, done, best)
            if best.value <= before * (1.0 + TIE) or clock.over():
                break
        return best.plans

    def _allocate(
        self, belief: NDArray[np.float64], moves: Sequence[int], done: Sequence[int], clock: Clock
    ) -> _Answer:
        """Let one pursuer after another take its path, the first one beginning with each of its moves; take the best.

        Where the first one goes decides most of what the others can do, and no single answer changes both.
        """
        table, found = self.model.moves[0], []
        cell = int(table.target[moves[0]])
        for begun in range(int(table.start[cell]), int(table.start[cell + 1])):
            gaze = np.full((len(moves), self.horizon), -1, dtype=np.int64)
            plan = _Answer(-1.0, gaze, [()] * len(moves))
            plan = self._answer(0, belief, moves, done, plan, begun=begun)
            for i in range(1, len(moves)):
                plan = self._answer(i, belief, moves, done, plan)
            found.append(plan)
            if clock.over():
                break
        return max(found, key=lambda plan: plan.value)

    def _answer(
        self,
        i: int,
        belief: NDArray[np.float64],
        moves: Sequence[int],
        done: Sequence[int],
        known: _Answer,
        begun: int = -1,
    ) -> _Answer:
        """Return a plan with a better path for one pursuer, or the one known."""
        from planners.pathkernel import best_path

        table = self.model.moves[i]
        first = max(0, int(table.steps[moves[i]]) - done[i])
        gaze, value = known.gaze.copy(), known.value
        gaze[i] = self._gaze(i, moves, done, known.plans[i])
        if gaze[i, 0] != known.gaze[i, 0]:  # a pursuer that had no plan so far
            value = -1.0
        if first >= self.horizon:
            return _Answer(self._worth(belief, gaze), gaze, known.plans)
        fixed = gaze.copy()
        fixed[i, first:] = -1
        value, path = best_path(
            belief, fixed, first, int(table.target[moves[i]]), self.weight, self.promise, self.motion, self.looks,
            self.kinds[self.model.kind[i]], self.width, GRAIN, value * (1.0 + TIE), begun,
        )  # fmt: skip
        if not len(path):
            return known
        plans = [*known.plans]
        plans[i] = [int(move) for move in path]
        gaze[i] = self._gaze(i, moves, done, plans[i])
        return _Answer(float(value), gaze, plans)

    def _worth(self, belief: NDArray[np.float64], gaze: NDArray[np.int64]) -> float:
        from planners.pathkernel import worth_of

        return float(worth_of(belief, gaze, self.weight, self.motion, self.looks))

    def _gaze(self, i: int, moves: Sequence[int], done: Sequence[int], plan: Sequence[int]) -> NDArray[np.int64]:
        """Return where a pursuer looks from after each step; when its plan has ended, it waits."""
        table = self.model.moves[i]
        cell = int(table.target[plan[-1] if len(plan) else moves[i]])
        waits = [self.model.move(cell, cell)] * self.horizon
        return self.model.views_along(i, moves[i], done[i], [*plan, *waits], self.horizon).astype(np.int64)


def _sources(model: SearchModel) -> tuple[NDArray[Any], ...]:
    """Return where the mass of each state comes from: the most of it, and the rest."""
    columns = model.dispersion.tocoo()
    origin, state = columns.coords
    order = np.lexsort((-columns.data, state))
    origin, state, share = origin[order].astype(np.int64), state[order].astype(np.int64), columns.data[order]
    most = np.concatenate([[True], np.diff(state) > 0]) if len(state) else np.empty(0, dtype=np.bool_)
    source, part = np.zeros(model.states, dtype=np.int64), np.zeros(model.states)
    source[state[most]], part[state[most]] = origin[most], share[most]
    return source, part, state[~most], origin[~most], share[~most]
