"""A long plan made better piece by piece: one pursuer's path within a window of time, all else kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planners.beam import BeamSearch
from planners.branching import JointSearch
from planners.clock import FOREVER, Clock
from planners.policy import SearchProblem
from planners.simulation import SearchModel
from planners.team import TeamPolicy, at_least

__all__ = ["Refined", "Refiner"]

# Longest search for a path within one window, nodes; what it has found by then counts.
LONGEST = 1_000

# A piece is changed only if the expected time falls by more than this, in belief steps.
WORTHWHILE = 1e-9


@dataclass(frozen=True, slots=True)
class Refined:
    """A plan by beam search, then every pursuer's path improved window by window until no window can be.

    "Not caught yet" is all that a team learns, so a plan for the whole pursuit can be made at once, and local search
    over whole plans is worth its time: see :class:`Refiner`. The team keeps to its plan for ``patience`` steps; at the
    next search the rest of the plan competes and is improved further.

    Attributes
    ----------
    window : int
        Belief steps of a piece.
    rounds : int
        Passes over the plan at most.
    width : int
        Plans that the beam search pursues at a time.
    horizon : int
        Longest time to plan for, belief steps.
    patience : int
        Time between two searches, belief steps.
    seconds : float
        Thinking time for one decision; with a limit, results depend on the machine.

    Raises
    ------
    PlannerError
        If a number is below 1, or the time below 0.
    """

    window: int = 12
    rounds: int = 20
    width: int = 200
    horizon: int = 150
    patience: int = 50
    seconds: float = float("inf")

    def __post_init__(self) -> None:
        at_least(1, window=self.window, rounds=self.rounds, width=self.width)
        at_least(1, horizon=self.horizon, patience=self.patience)
        at_least(0, seconds=self.seconds)

    def solve(self, problem: SearchProblem, rng: np.random.Generator) -> TeamPolicy:  # noqa: ARG002  (no chance)
        """Prepare a policy; nothing in it is random."""
        model = SearchModel(problem)
        beam = BeamSearch(model, width=self.width, alike=1, horizon=self.horizon)
        refiner = Refiner(model, window=self.window)

        def search(
            belief: NDArray[np.float64],
            moves: Sequence[int],
            done: Sequence[int],
            announced: Sequence[Sequence[int]],
            clock: Clock,
        ) -> Sequence[Sequence[int]]:
            plan = beam.run(belief, moves, done, announced, clock).moves
            return refiner.run(belief, moves, done, plan, rounds=self.rounds, clock=clock)

        return TeamPolicy(model, search, self.patience, self.seconds)


class Refiner:
    """Improves a team's plan by local search.

    A pass takes one pursuer after another, and of its path one window after another, the last one first. All other
    looks are kept, those of the pursuer itself outside the window too; so what a path through the window adds is
    linear in the mass that it takes (see :mod:`planners.kernels`), and the best one that ends where the old one did is
    found by branch and bound. The expected time never rises; passes end when it falls no more.

    Parameters
    ----------
    model : SearchModel
        The problem.
    window : int
        Belief steps of a window.
    """

    def __init__(self, model: SearchModel, *, window: int) -> None:
        self.model, self.window = model, window
        self.search = JointSearch(model, horizon=window, discount=1.0)

    def run(
        self,
        belief: NDArray[np.float64],
        moves: Sequence[int],
        done: Sequence[int],
        plans: Sequence[Sequence[int]],
        *,
        rounds: int,
        clock: Clock = FOREVER,
    ) -> tuple[tuple[int, ...], ...]:
        """Return a plan that is expected to capture no later.

        Parameters
        ----------
        belief : ndarray, shape (N,)
            Probability of each state now.
        moves, done : sequence of int
            The move that each pursuer is on, and how many of its steps are done.
        plans : sequence of sequence of int
            The moves that each pursuer begins; the plan lasts as long as the shortest of them.
        rounds : int
            Passes at most.
        clock : Clock
            Ends the search.
        """
        pieces = _Pieces(self, belief, moves, done, plans)
        for _ in range(rounds):
            before = pieces.value
            for pursuer in range(len(moves)):
                pieces.sweep(pursuer, clock)
            if pieces.value <= before + WORTHWHILE or clock.over():
                break
        return tuple(tuple(path) for path in pieces.plans)


class _Pieces:
    """A plan in work.

    ``kept`` (R, T, N) is what each pursuer leaves of each state at each step, ``worth`` (T + 1, N) what mass is worth
    beside all looks, ``seen`` (T, N) the mass before each look, ``value`` what all looks are worth.
    """

    def __init__(
        self,
        refiner: Refiner,
        belief: NDArray[np.float64],
        moves: Sequence[int],
        done: Sequence[int],
        plans: Sequence[Sequence[int]],
    ) -> None:
        self.model, self.search, self.window = refiner.model, refiner.search, refiner.window
        self.belief, self.moves, self.done = belief, list(moves), list(done)
        left = self.model.foresee(belief, moves, done, plans, 1_000_000).sum(axis=1)
        self.steps = len(left) - 1
        self.plans = [list(plan) for plan in plans]
        self.weight = self._weights(left)
        self.kept = np.ones((len(self.moves), self.steps, self.model.states))
        self.worth = np.empty((self.steps + 1, self.model.states))
        self.seen = np.empty(self.kept.shape[1:])
        for pursuer in range(len(self.moves)):
            self._look(pursuer)
        self.value = self._weigh()

    def _weights(self, left: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what capture after each step saves: the steps to the end, and the time that it would take then.

        What is left at the end is taken to be captured at the rate of the last half.
        """
        half = self.steps // 2
        fall = np.log(left[half] / left[-1]) if 0 < left[-1] < left[half] else 0.0
        rate = (self.steps - half) / fall if fall > 0 else float(self.steps)
        weight: NDArray[np.float64] = self.steps - np.arange(self.steps + 1) + rate
        return weight

    def _look(self, pursuer: int) -> None:
        plan = self.plans[pursuer]
        views = self.model.views_along(pursuer, self.moves[pursuer], self.done[pursuer], plan, self.steps)
        self.kept[pursuer] = self.model.looks.kept(views)

    def _weigh(self) -> float:
        from planners.kernels import values_from, weigh

        everything = self.kept.prod(axis=0)
        values_from(self.weight, everything, self.search.motion, self.worth)
        return float(weigh(self.belief, self.weight, everything, self.search.motion, self.seen))

    def sweep(self, pursuer: int, clock: Clock) -> None:
        """Improve one pursuer's path, a third of a window after another."""
        begin = self.steps
        while begin > 0 and not clock.over():
            begin = max(0, begin - max(1, self.window // 3))
            times = self._times(pursuer)
            first = int(np.searchsorted(times, begin))
            if first < len(times) - 1:
                self._improve(pursuer, times, first)

    def _times(self, pursuer: int) -> NDArray[np.intp]:
        """Return when the pursuer begins each move of its plan, and when it ends the last one."""
        table, move = self.model.moves[pursuer], self.moves[pursuer]
        free = max(0, int(table.steps[move]) - self.done[pursuer])
        return np.concatenate([[free], free + np.cumsum(table.steps[self.plans[pursuer]])]).astype(np.intp)

    def _improve(self, pursuer: int, times: NDArray[np.intp], first: int) -> None:
        """Find a better path from the beginning of one move of the plan, and put it in."""
        from planners.kernels import ANYWHERE, best_path, new_path, values_back

        plan, table, search = self.plans[pursuer], self.model.moves[pursuer], self.search
        begin = int(times[first])
        last = int(np.searchsorted(times, begin + self.window, side="right")) - 1
        end = int(times[last])
        goal = int(table.target[plan[last - 1]])
        if times[last] >= self.steps:
            last, end, goal = len(plan), self.steps, ANYWHERE
        if end <= begin or last == first:
            return
        kept = np.delete(self.kept, pursuer, axis=0)[:, begin:end].prod(axis=0)
        worth = np.empty((end - begin + 1, self.model.states))
        worth[-1] = self.worth[end]
        values_back(self.weight[begin : end + 1], kept, search.motion, worth)
        free = self.seen[begin - 1] * self.kept[:, begin - 1].prod(axis=0) if begin else self.belief
        known, mass = 0.0, free
        for t in range(end - begin):
            mass = self.model.disperse(mass[np.newaxis])[0] * kept[t]
            own = self.kept[pursuer, begin + t]
            known += float(mass @ ((1.0 - own) * worth[t + 1]))
            mass = mass * own
        path, cell = new_path(self.window), int(table.target[plan[first - 1] if first else self.moves[pursuer]])
        search.stack.free[0, 0] = free
        best_path(
            0, cell, kept, worth, search.motion, search.looks, search.kind_of(pursuer), search.stack, path, goal,
            known + WORTHWHILE, 0.0, LONGEST,
        )  # fmt: skip
        if path.moves[0] >= 0:
            plan[first:last] = path.moves[path.moves >= 0].tolist()
            self._look(pursuer)
            self.value = self._weigh()
