"""What the robots of one team know and decide: one planner for all of them, or one in each robot."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from planners import (
    Decision,
    Planner,
    Policy,
    PursuerState,
    SearchProblem,
    SearchState,
    advance,
    merge_evaders,
    observe,
)

if TYPE_CHECKING:
    from planners.motion import Sparse

__all__ = ["Crew"]


@dataclass(slots=True)
class _Mind:
    """What one planner knows.

    ``heard[j]`` is how many of robot ``j``'s looks it knows: robots tell everything, so these are always the first
    ones. ``beliefs[t]`` (E, S + 1) is what it believes, by what it knows now, of each of E evaders after t steps.
    ``last[j]`` and ``when[j]`` are where robot ``j`` was when it was last heard of, and the time, seconds.
    """

    policy: Policy
    heard: NDArray[np.intp]
    beliefs: list[NDArray[np.float64]]
    plans: list[tuple[int, ...]]
    last: list[PursuerState]
    when: NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class _Entry:
    """What P robots saw and measured at one belief step; arrays as for :meth:`Crew.learn`."""

    rows: NDArray[np.float64]
    likelihoods: NDArray[np.float64] | None

    def carry(self, beliefs: NDArray[np.float64], transition: Sparse, known: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Return the beliefs, shape (E, S + 1), a step later, by what some robots saw and measured."""
        after = advance(beliefs, transition, self.rows[known])
        if self.likelihoods is None:
            return after
        together = self.likelihoods[known].prod(axis=0)
        return np.array([observe(one, chance) for one, chance in zip(after, together, strict=True)])


class Crew:
    """P robots that search for E evaders, as one mind or as P minds.

    Every look and measurement of a robot is an entry in its log. Robots in contact exchange their logs, with what they
    heard from others before; a belief is made anew from the first step at which something new was learned (Eq. 3 with
    the looks that are known). So a merged belief is exactly that of a robot that had heard everything as it happened:
    nothing is counted twice, by whichever way it came. A robot that is not heard is taken to end the hop it was on and
    to stand there. With full contact every mind is asked the same questions in the same order, with chance from the
    same seed: so all decide as one planner would.

    Parameters
    ----------
    problem : SearchProblem
        What they plan for.
    planner : Planner
        How.
    belief : ndarray, shape (S + 1,)
        On each evader at first.
    starts : sequence of int
        Checkpoint of each robot, counted from 0.
    chance : Generator
        The planner's.
    central : bool
        Whether there is one mind only.
    evaders : int
        How many are searched for.

    Attributes
    ----------
    pooled : ndarray, shape (E, S + 1)
        What who knows all looks believes of each evader.
    free : ndarray of bool, shape (E,)
        Who is not caught yet; robots are told.
    """

    def __init__(
        self,
        problem: SearchProblem,
        planner: Planner,
        belief: NDArray[np.float64],
        starts: Sequence[int],
        chance: np.random.Generator,
        *,
        central: bool,
        evaders: int = 1,
    ) -> None:
        team = len(starts)
        self._transition = problem.motion.matrix(problem.graph, problem.time_step)
        self._log: list[_Entry] = []
        self.pooled = np.tile(belief, (evaders, 1))
        self.free = np.ones(evaders, dtype=np.bool_)
        self.central = central
        chances = [chance, *(copy.deepcopy(chance) for _ in range(0 if central else team - 1))]
        self._minds = [
            _Mind(
                policy=planner.solve(problem, own),
                heard=np.zeros(team, dtype=np.intp),
                beliefs=[self.pooled],
                plans=[()] * team,
                last=[PursuerState(cell) for cell in starts],
                when=np.zeros(team),
            )
            for own in chances
        ]

    @property
    def belief(self) -> NDArray[np.float64]:
        """What who knows all looks believes of those still free, or of all when all are caught; shape (S + 1,)."""
        return self._merged(self.pooled)

    @property
    def own_beliefs(self) -> NDArray[np.float64]:
        """The same for what each robot knows, shape (P, S + 1); with one mind, shape (0, S + 1)."""
        minds = [] if self.central else self._minds
        return np.array([self._merged(m.beliefs[-1]) for m in minds]).reshape(len(minds), self.pooled.shape[1])

    def learn(
        self,
        rows: NDArray[np.float64],
        contacts: NDArray[np.bool_],
        likelihoods: NDArray[np.float64] | None = None,
    ) -> None:
        """Take a belief step: dispersion, then the looks and measurements that are known (Eq. 3 and the matrix M).

        Parameters
        ----------
        rows : ndarray, shape (P, S)
            Detection probability of each state for each robot from where it is.
        contacts : ndarray of bool, shape (P, P)
            Who hears whom now.
        likelihoods : ndarray, shape (P, E, S), optional
            Of what each robot measured of each evader, for every state in which that may be; ones for no measurement.
        """
        self._log.append(_Entry(rows, likelihoods))
        self.pooled = self._log[-1].carry(self.pooled, self._transition, np.ones(len(rows), dtype=np.bool_))
        if self.central:
            self._minds[0].beliefs[:] = [self.pooled]
            return
        known = np.array([mind.heard for mind in self._minds])
        np.fill_diagonal(known, len(self._log))
        for i, mind in enumerate(self._minds):
            self._update(mind, known[contacts[i]].max(axis=0))

    def decide(
        self, time: float, pursuers: Sequence[PursuerState], arrived: Sequence[bool], contacts: NDArray[np.bool_]
    ) -> list[Decision | None]:
        """Return a decision for each robot that has arrived at a checkpoint, None for the others.

        Parameters
        ----------
        time : float
            Seconds.
        pursuers : sequence of PursuerState
            Where all robots are.
        arrived : sequence of bool
            Who needs a decision.
        contacts : ndarray of bool, shape (P, P)
            Who hears whom now.
        """
        team = range(len(pursuers))
        decisions: list[Decision | None] = [None] * len(pursuers)
        for i, mind in enumerate(self._minds):
            if not any(arrived[j] and contacts[i, j] for j in team):
                continue
            state = SearchState(
                time,
                self._merged(mind.beliefs[-1]),
                tuple(pursuers[j] if contacts[i, j] else _since(mind.last[j], time - mind.when[j]) for j in team),
                tuple(mind.plans),
            )
            for j, decision in zip(team, mind.policy.decide(state), strict=True):
                if arrived[j] and (self.central or j == i):
                    decisions[j] = decision
        for i, mind in enumerate(self._minds):
            for j in np.flatnonzero(contacts[i]).tolist():
                mind.last[j], mind.when[j] = pursuers[j], time
                chosen = decisions[j]
                if chosen is not None:
                    mind.last[j] = PursuerState(chosen.path[0]) if chosen.path else pursuers[j]
                    mind.plans[j] = tuple(chosen.path[1:])  # the first hop is under way
        return decisions

    def _merged(self, beliefs: NDArray[np.float64]) -> NDArray[np.float64]:
        return merge_evaders(beliefs, self.free if self.free.any() else ~self.free)

    def _update(self, mind: _Mind, heard: NDArray[np.intp]) -> None:
        """Let a mind know more looks, and make its beliefs anew from where they are new."""
        begin = int(mind.heard[heard > mind.heard].min())
        mind.heard = heard
        del mind.beliefs[begin + 1 :]
        for step in range(begin, len(self._log)):
            mind.beliefs.append(self._log[step].carry(mind.beliefs[-1], self._transition, heard > step))


def _since(last: PursuerState, elapsed: float) -> PursuerState:
    """Return where a robot is that was heard of some seconds ago, if it has ended its hop and then stood."""
    if last.target is None or last.time_left > elapsed:
        return replace(last, time_left=max(0.0, last.time_left - elapsed)) if last.target is not None else last
    return PursuerState(last.target)
