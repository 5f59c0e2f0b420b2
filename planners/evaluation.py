"""How long a team takes in the cell model: exact expected capture times, without sampling."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planners.baselines import Random, Stationary
from planners.graph import GraphError
from planners.policy import Planner, Policy, SearchProblem
from planners.running import run_policy
from planners.simulation import SearchModel
from planners.walks import JointChain, TooLargeError, catch_chances

# The curve of a team that has no plan is followed for this many times the expected time to capture.
CURVE_LENGTH = 4.0

# The exact bound is found where there are not more joint positions and states than this: within a second or so.
LARGEST_BOUND = 1_000_000

# The other bound is added up over at most so many steps, or until so little is left; what is left out would raise it.
LONGEST_BOUND, NOTHING_LEFT = 2_000, 1e-6

__all__ = ["Prediction", "lower_bounds", "predict"]


@dataclass(frozen=True, slots=True)
class Prediction:
    """What a team will achieve from one start.

    Attributes
    ----------
    start : tuple of int
        Where the pursuers stand at first, cells counted from 0.
    expected_time : float
        Expected capture time, seconds (steps, on a graph without geometry): the sum over t >= 0 of the probability of
        no capture after t steps, times the step.
    survival : ndarray, shape (T + 1,)
        Probability of no capture after 0, 1, ..., T belief steps.
    paths : tuple of tuple of int
        Cells to which each pursuer goes, one after another; empty for a team that wanders by chance.
    seconds_per_plan : float
        Mean time that a decision of the policy took, seconds; NaN where none was needed.
    """

    start: tuple[int, ...]
    expected_time: float
    survival: NDArray[np.float64]
    paths: tuple[tuple[int, ...], ...]
    seconds_per_plan: float

    @property
    def captured_share(self) -> float:
        """Probability of capture within the steps of ``survival``."""
        return 1.0 - float(self.survival[-1])


def predict(
    problem: SearchProblem,
    planner: Planner,
    starts: Sequence[Sequence[int]],
    rng: np.random.Generator,
    *,
    belief: NDArray[np.float64] | None = None,
    reachable: bool = False,
    residue: float = 1e-7,
    longest: int = 100_000,
) -> tuple[Prediction, ...]:
    """Return the exact capture-time distribution of a team in the cell model.

    "Not caught yet" is all that the team ever learns, so its plan does not depend on the evader, and the belief's
    own capture state is the distribution. A team that wanders by chance is a Markov chain over joint positions; one
    that stands still leaves a linear system.

    Parameters
    ----------
    problem : SearchProblem
        The problem.
    planner : Planner
        The method.
    starts : sequence of sequence of int
        For each prediction the cells in which the pursuers stand, counted from 0.
    rng : Generator
        Given to the planner; the same for each start, so that one start's result does not depend on the others.
    belief : ndarray, shape (N + 1,), optional
        Where the evader is at first; without it uniform over all cells but those of the pursuers.
    reachable : bool
        Whether it is then taken to be in the connected part of the first pursuer.
    residue : float
        A pursuit is followed until the probability of no capture is below this; what is left is taken to go on at
        the rate of the last half.
    longest : int
        No pursuit is followed for more belief steps than this.

    Raises
    ------
    GraphError
        If a start is no cell of the graph, names another number of pursuers than the problem, or no pursuer can
        reach where the evader may be.
    TooLargeError
        If the chain of a wandering team is too large.

    Examples
    --------
    Two rooms and an evader that stays or goes over with probability 1/2: whatever the pursuer does, it captures with
    1/2 in each step, and needs two steps on average:

    >>> import numpy as np
    >>> from planners import Decoupled, SearchGraph, lower_bounds, predict, unit_problem
    >>> problem = unit_problem(SearchGraph.from_edges(2, [(0, 1)]), 1)
    >>> (result,) = predict(problem, Decoupled(), [(0,)], np.random.default_rng(0))
    >>> print(round(result.expected_time, 6), result.survival[:4])
    2.0 [1.    0.5   0.25  0.125]

    One that knew where the evader goes would need one step:

    >>> lower_bounds(problem, [(0,)])
    (1.0,)
    """
    beliefs = []
    for start in starts:
        _check_start(problem, start)
        beliefs.append(_first_belief(problem, start, reachable=reachable) if belief is None else belief)
        _check_reach(problem, start, beliefs[-1])
    seed = int(rng.integers(2**63))
    teams = [tuple(int(cell) for cell in start) for start in starts]
    if isinstance(planner, Random):
        return _wander(problem, planner, teams, beliefs)
    model = SearchModel(problem)
    if isinstance(planner, Stationary):
        return tuple(_stand(model, team, first) for team, first in zip(teams, beliefs, strict=True))
    return tuple(
        _follow(model, planner.solve(problem, np.random.default_rng(seed)), team, first, residue, longest)
        for team, first in zip(teams, beliefs, strict=True)
    )


def lower_bounds(
    problem: SearchProblem,
    starts: Sequence[Sequence[int]],
    belief: NDArray[np.float64] | None = None,
    *,
    reachable: bool = False,
) -> tuple[float, ...]:
    """Return for each start an expected time that no planner can beat, seconds; arguments as for :func:`predict`.

    It is what a team would need that always knew the evader's state; see :meth:`JointChain.informed_times`. Where
    there are too many joint positions for that, the union bound takes its place: that a team captures within a time is
    at most as probable as that each of its pursuers alone does, added up; each of them can do its best for every time
    (:func:`planners.walks.catch_chances`).

    Parameters
    ----------
    problem : SearchProblem
        Graph, motion, capture and team.
    starts : sequence of sequence of int
        For each start the cell of every pursuer, counted from 0.
    belief : ndarray, shape (N + 1,), optional
        Where the evader is; by default uniform over the cells without a pursuer.
    reachable : bool
        Whether, by default, it is in the part of the graph that the pursuers can reach.

    Raises
    ------
    TooLargeError
        If there are too many positions even of a single pursuer.
    """
    first = [_first_belief(problem, start, reachable=reachable) if belief is None else belief for start in starts]
    try:
        times = JointChain.of(problem, wait=True, largest=LARGEST_BOUND).informed_times()
    except TooLargeError:
        return _union_bounds(problem, starts, first)
    return tuple(float(b[1:] @ times[tuple(start)]) for start, b in zip(starts, first, strict=True))


def _union_bounds(
    problem: SearchProblem, starts: Sequence[Sequence[int]], beliefs: Sequence[NDArray[np.float64]]
) -> tuple[float, ...]:
    bounds = np.zeros(len(starts))
    for chances in itertools.islice(catch_chances(problem), LONGEST_BOUND):
        left = [
            b[1:] @ (1.0 - np.minimum(1.0, sum(c[cell] for c, cell in zip(chances, start, strict=True))))
            for start, b in zip(starts, beliefs, strict=True)
        ]
        bounds += left
        if max(left) < NOTHING_LEFT:
            break
    return tuple((bounds * problem.time_step).tolist())


def _wander(
    problem: SearchProblem, planner: Random, teams: Sequence[tuple[int, ...]], beliefs: Sequence[NDArray[np.float64]]
) -> tuple[Prediction, ...]:
    chain = JointChain.of(problem, wait=planner.wait)
    times = chain.wandering_times()
    expected = [float(belief[1:] @ times[team]) for team, belief in zip(teams, beliefs, strict=True)]
    steps = int(np.ceil(CURVE_LENGTH * max(expected) / problem.time_step))
    curves = chain.wandering_survival(teams, beliefs, steps)
    paths = ((),) * len(problem.speeds)
    return tuple(
        Prediction(team, mean, curve, paths, float("nan"))
        for team, mean, curve in zip(teams, expected, curves, strict=True)
    )


def _stand(model: SearchModel, team: tuple[int, ...], belief: NDArray[np.float64]) -> Prediction:
    from scipy.sparse import csr_array, diags_array, eye_array
    from scipy.sparse.linalg import spsolve

    kept = model.unseen([np.array([cell]) for cell in team])[0]
    blind = csr_array(model.dispersion @ diags_array(kept))
    times = np.atleast_1d(spsolve((eye_array(model.states) - blind).tocsc(), np.ones(model.states)))
    mean = float(belief[1:] @ times)
    free, curve = belief[1:], [1.0 - float(belief[0])]
    for _ in range(int(np.ceil(CURVE_LENGTH * mean))):
        free = free @ blind
        curve.append(float(free.sum()))
    return Prediction(team, mean * model.step, np.array(curve), tuple((cell,) for cell in team), float("nan"))


def _follow(
    model: SearchModel,
    policy: Policy,
    team: tuple[int, ...],
    belief: NDArray[np.float64],
    residue: float,
    longest: int,
) -> Prediction:
    waits, done = [model.move(cell, cell) for cell in team], [1] * len(team)
    run = run_policy(model, policy, belief[1:], waits, done, residue=residue, longest=longest)
    paths = tuple(
        tuple(int(cell) for cell in table.target[list(moves)])
        for table, moves in zip(model.moves, run.moves, strict=True)
    )
    mean = float(np.mean(run.seconds)) if run.seconds else float("nan")
    return Prediction(team, run.expected_steps() * model.step, run.survival, paths, mean)


def _first_belief(problem: SearchProblem, start: Sequence[int], *, reachable: bool) -> NDArray[np.float64]:
    return problem.first_belief(start, int(problem.graph.component[start[0]]) if reachable else None)


def _check_start(problem: SearchProblem, start: Sequence[int]) -> None:
    if len(start) != len(problem.speeds):
        raise GraphError(f"The start names {len(start)} cells; there are {len(problem.speeds)} pursuers.")
    for cell in start:
        if not 0 <= cell < len(problem.graph):
            raise GraphError(f"The start names cell {cell + 1}; cells are numbered from 1 to {len(problem.graph)}.")


def _check_reach(problem: SearchProblem, start: Sequence[int], belief: NDArray[np.float64]) -> None:
    part = problem.graph.component
    reached = np.isin(part, part[list(start)])[problem.states.cell]
    for state in np.flatnonzero((belief[1:] > 0) & ~reached)[:1]:
        cell = int(problem.states.cell[state])
        raise GraphError(f"The evader may be in cell {cell + 1}, which no pursuer can reach from its start.")
