"""Planners over a fixed time: sequential allocation, repeated best response, branch and bound with a proven gap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planners.beam import BeamSearch
from planners.branching import Certificate, JointSearch
from planners.clock import FOREVER, Clock
from planners.pathbeam import PathBeam
from planners.policy import SearchProblem
from planners.simulation import SearchModel
from planners.team import TeamPolicy, at_least

__all__ = ["BestResponse", "BranchAndBound", "Sequential", "respond"]

# Paths that a beam search for an answer follows, where there are too many states for the best answer; twice as many
# made no plan better on the bundled plans.
_WIDTH = 4


@dataclass(frozen=True, slots=True)
class Sequential:
    """One pursuer after another takes its best path over a fixed time, given the paths of those before it.

    Sequential allocation (Hollinger et al. 2009); since what a path adds can only shrink as paths are added, the
    team gets at least half of what the best joint plan would. Each pursuer's path is the best one, by branch and
    bound, see :class:`planners.branching.JointSearch`; where states are parts of cells, of which there are too many for
    that, it is found by beam search (:class:`planners.pathbeam.PathBeam`).

    Attributes
    ----------
    horizon : int
        Belief steps to plan for.
    discount : float
        Weight of each belief step relative to the one before it.
    patience : int
        Time between two searches, belief steps.
    seconds : float
        Thinking time for one decision; with a limit, results depend on the machine.

    Raises
    ------
    PlannerError
        If a number is below 1, or time or discount below 0.
    """

    horizon: int = 10
    discount: float = 1.0
    patience: int = 1
    seconds: float = float("inf")

    def __post_init__(self) -> None:
        at_least(1, horizon=self.horizon, patience=self.patience)
        at_least(0, discount=self.discount, seconds=self.seconds)

    def solve(self, problem: SearchProblem, rng: np.random.Generator) -> TeamPolicy:  # noqa: ARG002  (no chance)
        """Prepare a policy; nothing in it is random."""
        model = SearchModel(problem)
        beam = PathBeam(model, horizon=self.horizon, discount=self.discount, width=_WIDTH)
        search = JointSearch(model, horizon=self.horizon, discount=self.discount) if problem.space is None else None

        def allocate(
            belief: NDArray[np.float64],
            moves: Sequence[int],
            done: Sequence[int],
            announced: Sequence[Sequence[int]],  # noqa: ARG001  (every plan starts from nothing)
            clock: Clock,
        ) -> Sequence[Sequence[int]]:
            if search is None:
                return beam.respond(belief, moves, done, (), rounds=0, clock=clock)
            return respond(search, belief, moves, done, (), rounds=0, clock=clock)

        return TeamPolicy(model, allocate, self.patience, self.seconds)


@dataclass(frozen=True, slots=True)
class BestResponse:
    """Sequential allocation; then each pursuer in turn answers the others' paths with its best one, until none can.

    A pursuer changes its path only for a better one, so that this ends, in a joint plan that no single pursuer can
    improve; the plan announced before competes.

    Attributes
    ----------
    horizon : int
        Belief steps to plan for.
    rounds : int
        Rounds of answers at most.
    discount : float
        Weight of each belief step relative to the one before it.
    patience : int
        Time between two searches, belief steps.
    seconds : float
        Thinking time for one decision; with a limit, results depend on the machine.
    width : int
        Most paths that the search for an answer follows of those that come to a checkpoint at about the same time;
        0 lets it find the best answer there is where states are cells, and stands for 4 where they are parts of them,
        see :class:`planners.pathbeam.PathBeam`.

    Raises
    ------
    PlannerError
        If a number is below 1, or time, discount or width below 0.
    """

    horizon: int = 10
    rounds: int = 10
    discount: float = 1.0
    patience: int = 1
    seconds: float = float("inf")
    width: int = 0

    def __post_init__(self) -> None:
        at_least(1, horizon=self.horizon, rounds=self.rounds, patience=self.patience)
        at_least(0, discount=self.discount, seconds=self.seconds, width=self.width)

    def solve(self, problem: SearchProblem, rng: np.random.Generator) -> TeamPolicy:  # noqa: ARG002  (no chance)
        """Prepare a policy; nothing in it is random."""
        model = SearchModel(problem)
        beam = PathBeam(model, horizon=self.horizon, discount=self.discount, width=self.width or _WIDTH)
        exact = self.width == 0 and problem.space is None
        search = JointSearch(model, horizon=self.horizon, discount=self.discount) if exact else None

        def answer(
            belief: NDArray[np.float64],
            moves: Sequence[int],
            done: Sequence[int],
            announced: Sequence[Sequence[int]],
            clock: Clock,
        ) -> Sequence[Sequence[int]]:
            if search is None:
                return beam.respond(belief, moves, done, announced, rounds=self.rounds, clock=clock)
            return respond(search, belief, moves, done, announced, rounds=self.rounds, clock=clock)

        return TeamPolicy(model, answer, self.patience, self.seconds)


@dataclass(frozen=True, slots=True)
class BranchAndBound:
    """The best joint plan over a fixed time, with a proof or a proven gap.

    Starts from the better of beam search and repeated best response, and then searches all joint plans, see
    :class:`planners.branching.JointSearch`; ended early, it returns the best plan so far and how far from the best
    it can be at most. The policy keeps the last :class:`planners.branching.Certificate`.

    Attributes
    ----------
    horizon : int
        Belief steps to plan for.
    nodes : int
        The proof is given up after this many nodes.
    seconds : float
        Thinking time for one decision; with a limit, results depend on the machine.
    discount : float
        Weight of each belief step relative to the one before it.
    patience : int
        Time between two searches, belief steps.

    Raises
    ------
    PlannerError
        If a number is below 1, or time or discount below 0.
    """

    horizon: int = 8
    nodes: int = 5_000
    seconds: float = float("inf")
    discount: float = 1.0
    patience: int = 4

    def __post_init__(self) -> None:
        at_least(1, horizon=self.horizon, nodes=self.nodes, patience=self.patience)
        at_least(0, seconds=self.seconds, discount=self.discount)

    def solve(self, problem: SearchProblem, rng: np.random.Generator) -> CertifiedPolicy:  # noqa: ARG002  (no chance)
        """Prepare a policy; nothing in it is random."""
        return CertifiedPolicy(SearchModel(problem), self)


class CertifiedPolicy(TeamPolicy):
    """The policy of :class:`BranchAndBound`; ``certificate`` belongs to the last plan, None before the first."""

    def __init__(self, model: SearchModel, planner: BranchAndBound) -> None:
        super().__init__(model, self._certify, planner.patience, planner.seconds)
        horizon, discount = planner.horizon, planner.discount
        self.limits = planner
        self.joint = JointSearch(model, horizon=horizon, discount=discount)
        self.beam = BeamSearch(model, width=100, alike=1, horizon=horizon, discount=discount, residue=0.0)
        self.certificate: Certificate | None = None

    def _certify(
        self,
        belief: NDArray[np.float64],
        moves: Sequence[int],
        done: Sequence[int],
        announced: Sequence[Sequence[int]],
        clock: Clock,
    ) -> Sequence[Sequence[int]]:
        plan = self.beam.run(belief, moves, done, announced, clock).moves
        plan = respond(self.joint, belief, moves, done, plan, rounds=10, clock=clock)
        self.certificate = self.joint.run(belief, moves, done, plan, nodes=self.limits.nodes, clock=clock)
        return self.certificate.moves


def respond(
    search: JointSearch,
    belief: NDArray[np.float64],
    moves: Sequence[int],
    done: Sequence[int],
    announced: Sequence[Sequence[int]],
    *,
    rounds: int,
    clock: Clock = FOREVER,
) -> tuple[tuple[int, ...], ...]:
    """Return the plan of sequential allocation after some rounds of best responses.

    Parameters
    ----------
    search : JointSearch
        Answers for one pursuer at a time.
    belief, moves, done, announced
        As in :class:`planners.team.TeamSearch`; the announced plan, where there is one, is improved too, and the
        better of the two results returned.
    rounds : int
        Rounds of answers at most.
    clock : Clock
        Ends the search.
    """
    team = range(len(moves))
    plans: tuple[tuple[int, ...], ...] = ((),) * len(moves)
    for i in team:
        plans = search.run(belief, moves, done, plans, who=[i], absent=team[i + 1 :], clock=clock).moves
    results = [plans] + ([tuple(map(tuple, announced))] if any(announced) else [])
    for k, plans in enumerate(results):
        value = search.value(belief, moves, done, plans)
        for _ in range(rounds):
            before = value
            for i in team:
                answer = search.run(belief, moves, done, plans, who=[i], clock=clock)
                plans, value = answer.moves, answer.value
            if value <= before * (1.0 + 1e-9) or clock.over():
                break
        results[k] = plans
    return max(results, key=lambda plan: search.value(belief, moves, done, plan))
