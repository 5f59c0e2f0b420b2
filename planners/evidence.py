"""What is learned besides "not seen": priors, measurements, and several evaders at once."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from maps import GeomsimError
from planners.belief import uniform_belief
from planners.graph import SearchGraph

__all__ = [
    "EvidenceError",
    "elsewhere",
    "measured_range",
    "merge_evaders",
    "observe",
    "region_belief",
    "reported_sighting",
]


class EvidenceError(GeomsimError):
    """A prior or measurement that cannot be right."""


def observe(belief: NDArray[np.float64], likelihood: ArrayLike) -> NDArray[np.float64]:
    """Return the belief after a measurement: the matrix M of Section IV-B, a diagonal one, and Bayes' rule.

    A measurement of the evader says that it is free, and nothing on how likely it was to be caught before; so the
    capture state keeps its probability, and what is left is divided anew: ``p_n <- (1 - p_0) p_n L_n / sum_m p_m L_m``.

    Parameters
    ----------
    belief : ndarray, shape (N + 1,)
        Index 0 is the capture state.
    likelihood : array_like, shape (N,)
        Probability (density) of what was measured, for an evader in each state.

    Raises
    ------
    EvidenceError
        If the likelihood has another shape or a negative entry, or the belief holds the measurement to be impossible.

    Examples
    --------
    Captured with probability 1/5, else in one of three states; then a range of 4 m with a deviation of 1 m is measured
    to an evader that would be 1 m, 4 m or 5 m away; and then somebody reports a sighting in the second state, which
    is right nine times of ten and false once in ten:

    >>> import numpy as np
    >>> from planners import measured_range, observe, reported_sighting
    >>> belief = np.array([0.2, 0.2, 0.4, 0.2])
    >>> belief = observe(belief, measured_range([1.0, 4.0, 5.0], measured=4.0, deviation=1.0))
    >>> print(belief.round(3))
    [0.2   0.003 0.611 0.185]
    >>> print(observe(belief, reported_sighting(3, [1], hit=0.9, false=0.1)).round(3))
    [0.2   0.    0.773 0.026]
    """
    chance = np.asarray(likelihood, dtype=np.float64)
    if chance.shape != (len(belief) - 1,):
        raise EvidenceError(f"A likelihood must have {len(belief) - 1} entries, one a state; got shape {chance.shape}.")
    if not (np.isfinite(chance).all() and (chance >= 0).all()):
        raise EvidenceError("A likelihood must be finite and nowhere below 0.")
    weighed = belief[1:] * chance
    total = float(weighed.sum())
    if total <= 0:
        raise EvidenceError("The measurement is impossible everywhere the evader may be.")
    return np.concatenate([[belief[0]], weighed * ((1.0 - belief[0]) / total)])


def measured_range(distances: ArrayLike, measured: float, deviation: ArrayLike) -> NDArray[np.float64]:
    """Return the likelihood, shape (N,), of a range to the evader with Gaussian noise.

    Parameters
    ----------
    distances : array_like, shape (N,)
        True range for an evader in each state, metres.
    measured : float
        What was measured, metres.
    deviation : float or array_like, shape (N,)
        Standard deviation of the noise, metres; above 0. For a state as large as a cell it should include the spread
        of places in the cell, and may be another for each.

    Raises
    ------
    EvidenceError
        If a deviation is not above 0.
    """
    spread = np.asarray(deviation, dtype=np.float64)
    for value in spread[~(spread > 0)][:1]:
        raise EvidenceError(f"The deviation of a range must be above 0; got {value}.")
    error = (np.asarray(distances, dtype=np.float64) - measured) / spread
    log = -0.5 * error**2 - np.log(spread)
    # Divided by the largest value, which cancels in Bayes' rule, so that far outliers do not become 0 everywhere.
    return np.asarray(np.exp(log - log.max()))


def reported_sighting(states: int, where: Iterable[int], hit: float, false: float) -> NDArray[np.float64]:
    """Return the likelihood, shape (N,), of a report that the evader was seen in some states.

    Parameters
    ----------
    states : int
        Number N of states.
    where : iterable of int
        States that were reported, counted from 0.
    hit, false : float
        Probability of such a report if the evader is there, and if it is not.

    Raises
    ------
    EvidenceError
        If a probability is outside [0, 1] or a state does not exist.
    """
    if not (0 <= hit <= 1 and 0 <= false <= 1):
        raise EvidenceError(f"Probabilities of a report must be between 0 and 1; got {hit} and {false}.")
    likelihood = np.full(states, float(false))
    for state in where:
        if not 0 <= state < states:
            raise EvidenceError(f"There is no state {state + 1}; states are numbered from 1 to {states}.")
        likelihood[state] = hit
    return likelihood


def elsewhere(states: int, where: Iterable[int]) -> NDArray[np.float64]:
    """Return the likelihood, shape (N,), of being told that the evader is not ``where``, in some of N ``states``.

    States count from 0.
    """
    return reported_sighting(states, where, 0.0, 1.0)


def region_belief(graph: SearchGraph, cells: Iterable[int], inside: float = 1.0) -> NDArray[np.float64]:
    """Return a prior: in some ``cells`` with probability ``inside``, anywhere else in ``graph`` with the rest.

    Its shape is (N + 1,); cells count from 0.

    It is also the belief after a lost sighting, with the cells that the evader can have got to. (If it was lost in one
    cell, that is :func:`planners.point_belief`, and its motion model carries it on.)

    Raises
    ------
    EvidenceError
        If the probability is outside [0, 1].
    GraphError
        If a cell does not exist, or a part that has probability has no cell.
    """
    if not 0 <= inside <= 1:
        raise EvidenceError(f"The probability of a region must be between 0 and 1; got {inside}.")
    region = set(cells)
    parts = ((inside, set(range(len(graph))) - region), (1.0 - inside, region))
    belief = np.zeros(len(graph) + 1)
    for share, excluded in parts:
        if share > 0:
            belief += share * uniform_belief(graph, exclude=excluded)
    return belief


def merge_evaders(beliefs: NDArray[np.float64], free: ArrayLike) -> NDArray[np.float64]:
    """Return one belief to plan with for several independent evaders, each with a belief of its own.

    It is the mean over those still free. Every aim that is linear in the belief - the expected time to capture, the
    target probability - then is the mean over evaders of what it is for each; entropy is that of the mixture.

    Parameters
    ----------
    beliefs : ndarray, shape (K, N + 1)
        Belief on each evader.
    free : array_like of bool, shape (K,)
        Which evaders are not caught yet; the robots are told who is.

    Raises
    ------
    EvidenceError
        If nobody is free.
    """
    mask = np.asarray(free, dtype=bool)
    if not mask.any():
        raise EvidenceError("All evaders are caught; there is nobody left to search for.")
    return np.asarray(beliefs[mask].mean(axis=0))
