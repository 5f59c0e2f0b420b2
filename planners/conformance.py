"""What every planner must keep to: a check that users can run on their own."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import fields

import numpy as np

from maps import ConformanceError
from planners.costs import Cost, Hops
from planners.policy import Decision, Planner, Policy, PursuerState, SearchProblem, SearchState

__all__ = ["check_cost", "check_policy"]


def check_cost(cost: Cost, rng: np.random.Generator, rounds: int = 8) -> None:
    """Check that a cost heuristic keeps the rules of :data:`planners.Cost` on random hops.

    It must return one finite number for each hop, none below 0, that does not depend on the other hops in the batch
    nor on how often it is asked, and leave the hops as they were.

    Parameters
    ----------
    cost : callable
        What is checked.
    rng : Generator
        Makes the hops.
    rounds : int
        Number of batches.

    Raises
    ------
    ConformanceError
        At the first rule that is broken.
    """
    who = f"The heuristic {getattr(cost, '__name__', cost)!r}"
    for k in range(rounds):
        count, cells = (1, 1) if k == 0 else rng.integers(1, 30, 2).tolist()
        hops = _random_hops(count, cells, rng, empty=k == 1)
        kept = copy.deepcopy(hops)
        values = np.asarray(cost(hops))
        if values.shape != (count,):
            raise ConformanceError(f"{who} returns shape {values.shape} for {count} hops; it must be ({count},).")
        if not (np.isfinite(values).all() and (values >= 0).all()):
            raise ConformanceError(
                f"{who} returns {values.min():g} to {values.max():g}; costs are finite and not below 0."
            )
        if not all(np.array_equal(getattr(hops, f.name), getattr(kept, f.name)) for f in fields(Hops)):
            raise ConformanceError(f"{who} changes the hops that it is given.")
        alone = [
            np.asarray(cost(Hops(*(getattr(hops, f.name)[i : i + 1] for f in fields(Hops))))) for i in range(count)
        ]
        if not np.allclose(np.concatenate(alone), values, rtol=1e-9, atol=1e-12):
            raise ConformanceError(f"{who} gives a hop another cost in a batch than alone, or when asked again.")


def check_policy(planner: Planner, problem: SearchProblem, rng: np.random.Generator, rounds: int = 8) -> None:
    """Check that a planner keeps the rules of :class:`planners.Policy` on a problem.

    The team is put into random states, some pursuers at checkpoints and some on their way; in each of them the
    policy must

    - return one entry for each pursuer, a :class:`planners.Decision` exactly for those at a checkpoint;
    - give paths that are not empty, begin with a neighbour of the pursuer's cell or with that cell itself, and go
      on in the same way;
    - leave the state, the belief in it above all, as it was;
    - decide alike when it was made anew with an equal seed and is asked the same questions.

    Parameters
    ----------
    planner : Planner
        What is checked.
    problem : SearchProblem
        On what.
    rng : Generator
        Chooses the states and the policy's seed.
    rounds : int
        Number of states.

    Raises
    ------
    ConformanceError
        At the first rule that is broken.
    """
    if not isinstance(planner, Planner):
        raise ConformanceError(f"{planner!r} has no method solve(problem, rng).")
    seed = int(rng.integers(2**32))
    states = [_random_state(problem, rng, at_checkpoints=k == 0) for k in range(rounds)]
    first, again = (
        _ask(planner.solve(problem, np.random.default_rng(seed)), problem, states, planner) for _ in range(2)
    )
    if first != again:
        raise ConformanceError(f"{planner!r} decides differently when it is made anew with an equal seed.")


def _random_hops(count: int, cells: int, rng: np.random.Generator, *, empty: bool) -> Hops:
    """Make hops over which pursuers gain probability, or, empty, over cells that hold none."""
    before = rng.dirichlet(np.ones(cells + 1), count)[:, 1:] * (not empty)
    return Hops(before, before * rng.uniform(0.0, 1.0, (count, cells)), before[:, 0], rng.uniform(0.1, 30.0, count))


def _ask(
    policy: Policy, problem: SearchProblem, states: Sequence[SearchState], planner: Planner
) -> list[list[tuple[int, ...] | None]]:
    answers = []
    for state in states:
        kept = copy.deepcopy(state)
        decisions = policy.decide(state)
        where = f"{planner!r} with pursuers at {state.pursuers}"
        if not _same(state, kept):
            raise ConformanceError(f"{where} changes the state that it is given.")
        if len(decisions) != len(state.pursuers):
            raise ConformanceError(f"{where} returns {len(decisions)} decisions for {len(state.pursuers)} pursuers.")
        for pursuer, decision in zip(state.pursuers, decisions, strict=True):
            _check_decision(problem, pursuer, decision, where)
        answers.append([None if d is None else d.path for d in decisions])
    return answers


def _check_decision(problem: SearchProblem, pursuer: PursuerState, decision: Decision | None, where: str) -> None:
    if (decision is None) != (pursuer.target is not None):
        raise ConformanceError(f"{where} must decide for those at a checkpoint and no others; got {decision}.")
    if decision is None:
        return
    if not decision.path:
        raise ConformanceError(f"{where} returns an empty path.")
    cell = pursuer.cell
    for following in decision.path:
        if following != cell and following not in problem.graph.neighbours(cell):
            raise ConformanceError(f"{where} goes from cell {cell + 1} to {following + 1}, which is no neighbour.")
        cell = following


def _same(a: SearchState, b: SearchState) -> bool:
    return (
        (a.time, a.pursuers, a.plans) == (b.time, b.pursuers, b.plans)
        and np.array_equal(a.belief, b.belief)
        and a.belief.flags.writeable == b.belief.flags.writeable
    )


def _random_state(problem: SearchProblem, rng: np.random.Generator, *, at_checkpoints: bool) -> SearchState:
    graph = problem.graph
    pursuers = []
    for speed in problem.speeds:
        cell = int(rng.choice(np.flatnonzero(graph.component >= 0)))
        ways = graph.neighbours(cell)
        if at_checkpoints or not len(ways) or rng.random() < 0.5:
            pursuers.append(PursuerState(cell))
            continue
        target = int(rng.choice(ways))
        duration = float(graph.length[graph.edge(cell, target)]) / speed
        pursuers.append(PursuerState(cell, target, duration * float(rng.uniform(0.01, 1.0))))
    if not any(p.target is None for p in pursuers):
        pursuers[0] = PursuerState(pursuers[0].cell)
    possible = problem.first_belief(()) > 0
    possible[0] = True
    weights = rng.dirichlet(np.ones(len(possible))) * possible
    return SearchState(
        time=float(rng.uniform(0.0, 100.0)),
        belief=weights / weights.sum(),
        pursuers=tuple(pursuers),
        plans=((),) * len(pursuers),
    )
