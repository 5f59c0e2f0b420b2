"""The whole team's plan over a long time, searched by a beam that moves all pursuers forward in step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planners.clock import FOREVER, Clock
from planners.policy import SearchProblem
from planners.simulation import SearchModel
from planners.team import TeamPolicy, at_least

__all__ = ["Beam", "BeamSearch", "TeamPlan"]

# Values closer than this share are equal: the same plan with the roles of two pursuers changed.
TIE = 1e-12

# Weight of the way to what is left, chosen by measurement between 0 (no guidance) and 1 (too much of it).
GUIDE = 0.3


@dataclass(frozen=True, slots=True)
class Beam:
    """The team plans jointly, for a long time ahead, to be expected to capture as soon as possible.

    What is minimised is the mission's own aim, the expected time to capture: the sum over time of the probability
    of no capture, which does not favour short hops as a sum over hops does. The search is a beam search, see
    :class:`BeamSearch`. The team keeps to its plan for ``patience`` steps, or until the belief is not what the plan
    foresaw, and then searches anew; the plan that it has announced competes.

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
    seconds : float
        Thinking time for one decision; with a limit, results depend on the machine.

    Raises
    ------
    PlannerError
        If one of them is below 1, or the time below 0.
    """

    width: int = 200
    horizon: int = 120
    patience: int = 10
    alike: int = 1
    seconds: float = float("inf")

    def __post_init__(self) -> None:
        at_least(1, width=self.width, horizon=self.horizon, patience=self.patience, alike=self.alike)
        at_least(0, seconds=self.seconds)

    def solve(self, problem: SearchProblem, rng: np.random.Generator) -> TeamPolicy:  # noqa: ARG002  (no chance)
        """Prepare a policy; nothing in it is random."""
        model = SearchModel(problem)
        search = BeamSearch(model, width=self.width, alike=self.alike, horizon=self.horizon)
        return TeamPolicy(model, lambda *now: search.run(*now).moves, self.patience, self.seconds)


@dataclass(frozen=True, slots=True)
class TeamPlan:
    """A plan for all pursuers and what it is expected to achieve.

    Attributes
    ----------
    cost : float
        Expected time not captured over the horizon, and after it at the rate so far; belief steps.
    moves : tuple of tuple of int
        The moves that each pursuer begins, one after another; see :class:`planners.simulation.Moves`.
    """

    cost: float
    moves: tuple[tuple[int, ...], ...]


class BeamSearch:
    """Searches for the team plan with the least expected time to capture.

    Time advances by one belief step for all plans in the beam at once. Within a step the pursuers choose one after
    another, so that work grows in proportion to their number; after each choice only the ``width`` most promising
    plans remain, and of those with the same joint position only the best ``alike``, without which the beam would
    fill up with variants of one plan. A plan is judged by its expected time not captured so far, plus what it leaves
    at the rate at which the best plan has captured up to now. (Beam search is textbook; that judgement, and the order
    of choices, were chosen by measurement, see ``tests/benchmarks/planning.py``.)

    Parameters
    ----------
    model : SearchModel
        The problem.
    width : int
        Plans that remain after each choice.
    alike : int
        How many of them may share a joint position.
    horizon : int
        Belief steps to plan for.
    discount : float
        Weight of each belief step relative to the one before it.
    residue : float
        The search ends when the best plan leaves less than this uncaught.
    """

    def __init__(
        self,
        model: SearchModel,
        *,
        width: int,
        alike: int,
        horizon: int,
        discount: float = 1.0,
        residue: float = 1e-3,
    ) -> None:
        self.model = model
        self.width, self.alike, self.horizon = width, alike, horizon
        self.discount, self.residue = discount, residue
        by_kind = {kind: model.reach(model.kind.index(kind)) for kind in model.kind}
        self._reach = [by_kind[kind] for kind in model.kind]
        # A joint position is told by a sum of one random number for each pursuer's move, times how far it is: so
        # pursuers of the same kind may change places. Nothing else hangs on these numbers.
        size = len(model.kinds), len(model.moves[0].target)
        salt = np.random.default_rng(0).integers(1, 2**63, size, dtype=np.uint64)
        self._salt = salt[list(model.kind)]

    def run(
        self,
        belief: NDArray[np.float64],
        moves: Sequence[int],
        done: Sequence[int],
        announced: Sequence[Sequence[int]] = (),
        clock: Clock = FOREVER,
    ) -> TeamPlan:
        """Return the best plan found.

        Parameters
        ----------
        belief : ndarray, shape (N,)
            Probability of each state now.
        moves, done : sequence of int
            The move that each pursuer is on, and how many of its steps are done.
        announced : sequence of sequence of int
            Moves that each pursuer means to begin, from an earlier plan. The plan that keeps to them stays in the
            beam until one of them ends, so that searching again does no harm.
        clock : Clock
            Ends the search; the plan is as long then as the beam has come.
        """
        beam = _Beam(self, belief, moves, done, announced)
        for _ in range(self.horizon):
            beam.advance()
            if beam.left.min() < self.residue or clock.over():
                break
        return beam.best()


class _Beam:
    """K team plans in the making.

    ``free`` (K, N) is the belief under each, ``spent`` (K,) its cost so far, ``move`` and ``done`` (K, R) where its
    pursuers are, ``loyal`` the index of the plan that keeps to what was announced, or -1.
    """

    def __init__(
        self,
        search: BeamSearch,
        belief: NDArray[np.float64],
        moves: Sequence[int],
        done: Sequence[int],
        announced: Sequence[Sequence[int]],
    ) -> None:
        self.search, self.model = search, search.model
        self.free, self.spent = belief[np.newaxis].copy(), np.zeros(1)
        self.move = np.array([moves], dtype=np.intp)
        self.done = np.array([done], dtype=np.intp)
        self.announced = [list(plan) for plan in announced]
        self.loyal = 0 if any(self.announced) else -1
        self.trace: list[tuple[int, NDArray[np.intp], NDArray[np.intp]]] = []
        self.first = float(belief.sum())
        self.step, self.weight, self.rate = 0, 1.0, float(search.horizon)

    @property
    def left(self) -> NDArray[np.float64]:
        """What each plan leaves uncaught, shape (K,)."""
        return np.asarray(self.free.sum(axis=1))

    def advance(self) -> None:
        """Take all plans one belief step further."""
        self.free = self.model.disperse(self.free)
        for pursuer in range(self.move.shape[1]):
            self._choose(pursuer)
        left = self.left
        self.spent = self.spent + self.weight * left
        self.weight *= self.search.discount
        self.step += 1
        best = left[np.argmin(self.spent + self.weight * self.rate * left)]
        fall = np.log(self.first / best) if 0 < best < self.first else 0.0
        self.rate = min(self.step / fall, 1e6) if fall > 0 else float(self.search.horizon)

    def best(self) -> TeamPlan:
        """Return the best plan so far."""
        total = self.spent + self.weight * self.rate * self.left
        leaf = int(np.argmin(total))
        cost = float(total[leaf])
        paths: list[list[int]] = [[] for _ in range(self.move.shape[1])]
        for pursuer, parent, begun in reversed(self.trace):
            if begun[leaf] >= 0:
                paths[pursuer].append(int(begun[leaf]))
            leaf = int(parent[leaf])
        return TeamPlan(cost, tuple(tuple(reversed(path)) for path in paths))

    def _choose(self, pursuer: int) -> None:
        """Let one pursuer go on, or choose where it stands at a checkpoint, in all plans."""
        moves, looks = self.model.moves[pursuer], self.model.looks
        move, done = self.move[:, pursuer], self.done[:, pursuer]
        arrived = done >= moves.steps[move]
        if not arrived.any():
            looks.take(self.free, moves.views[move, np.maximum(done, 0)])
            done += 1
            return
        cell = moves.target[move]
        first = np.where(arrived, moves.start[cell], move)
        count = np.where(arrived, moves.start[cell + 1] - first, 1)
        parent = np.repeat(np.arange(len(count)), count)
        move = np.arange(len(parent)) + np.repeat(first - (np.cumsum(count) - count), count)
        done = np.where(arrived, 0, done)[parent]
        views = moves.views[move, np.maximum(done, 0)]
        left = self.left[parent] - looks.chance(self.free, views, parent)
        after = (1.0 + self.rate) * left + GUIDE * self._way(pursuer, parent, move, done + 1)
        value = self.spent[parent] + self.weight * after
        loyal = self._loyal_choice(pursuer, arrived, parent, move)
        kept = self._select(value, self._positions(pursuer, parent, move, done + 1), loyal)
        self.free = self.free[parent[kept]]
        looks.take(self.free, views[kept])
        self.spent = self.spent[parent[kept]]
        self.move, self.done = self.move[parent[kept]], self.done[parent[kept]]
        self.move[:, pursuer], self.done[:, pursuer] = move[kept], done[kept] + 1
        self.loyal = int(np.flatnonzero(kept == loyal)[0]) if loyal >= 0 else -1
        self.trace.append((pursuer, parent[kept], np.where(done[kept] == 0, move[kept], -1)))

    def _way(
        self, pursuer: int, parent: NDArray[np.intp], move: NDArray[np.intp], done: NDArray[np.intp]
    ) -> NDArray[np.float64]:
        """Return for each choice how many steps what is there now is away from the nearest pursuer, on average."""
        nearest = self._apart(pursuer, move, done)
        others = [i for i in range(self.move.shape[1]) if i != pursuer]
        if others:
            least = np.minimum.reduce([self._apart(i, self.move[:, i], self.done[:, i]) for i in others])
            np.minimum(nearest, least[parent], out=nearest)
        return np.asarray(np.einsum("kn,kn->k", self.free[parent], nearest))

    def _apart(self, pursuer: int, move: NDArray[np.intp], done: NDArray[np.intp]) -> NDArray[np.float64]:
        """Return how many steps a pursuer is away from seeing each state, shape (K, N)."""
        table = self.model.moves[pursuer]
        apart: NDArray[np.float64] = self.search._reach[pursuer][table.target[move]]
        rest = table.steps[move] - done
        if rest.any():
            apart += rest[:, np.newaxis]
        return apart

    def _loyal_choice(
        self, pursuer: int, arrived: NDArray[np.bool_], parent: NDArray[np.intp], move: NDArray[np.intp]
    ) -> int:
        """Return which choice keeps to what was announced, -1 if there is none any more."""
        if self.loyal < 0:
            return -1
        choices = np.flatnonzero(parent == self.loyal)
        if not arrived[self.loyal]:
            return int(choices[0])
        if not self.announced[pursuer]:
            return -1
        match = choices[move[choices] == self.announced[pursuer].pop(0)]
        return int(match[0]) if len(match) else -1

    def _positions(
        self, pursuer: int, parent: NDArray[np.intp], move: NDArray[np.intp], done: NDArray[np.intp]
    ) -> NDArray[np.uint64]:
        """Return a number for the joint position of each choice; equal positions have equal numbers."""
        salt = self.search._salt
        total = salt[np.arange(len(salt)), self.move] * (2 * self.done + 1).astype(np.uint64)
        rest = total.sum(axis=1) - total[:, pursuer]
        return np.asarray(rest[parent] + salt[pursuer, move] * (2 * done + 1).astype(np.uint64))

    def _select(self, value: NDArray[np.float64], position: NDArray[np.uint64], loyal: int) -> NDArray[np.intp]:
        """Return the choices that remain in the beam."""
        order = np.lexsort((value, position))
        index = np.arange(len(order))
        begins = np.concatenate([[True], np.diff(position[order]) != 0])
        rank = index - np.maximum.accumulate(np.where(begins, index, 0))
        twin = ~begins & (np.diff(value[order], prepend=-np.inf) <= TIE * value[order])
        if loyal >= 0:
            value = value.copy()
            value[loyal] = -np.inf
        kept = order[((rank < self.search.alike) & ~twin) | (order == loyal)]
        if len(kept) > self.search.width:
            kept = kept[np.argpartition(value[kept], self.search.width)[: self.search.width]]
        return np.asarray(np.sort(kept))
