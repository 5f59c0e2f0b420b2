"""Cost heuristics: what a pursuer pays for a hop from one checkpoint to the next."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from maps import GeomsimError, nearest
from maps.errors import enter

__all__ = [
    "COSTS",
    "Cost",
    "CostError",
    "Hops",
    "distance_over_probability",
    "entropy",
    "find_cost",
    "probability",
    "register_cost",
    "target_probability",
]

# A cell without any probability would cost an infinite amount by Eq. 5, and then all paths through one would be alike.
SMALLEST_PROBABILITY = 1e-9


class CostError(GeomsimError):
    """A cost heuristic that does not exist."""


@dataclass(frozen=True, slots=True)
class Hops:
    """K hops from checkpoint to checkpoint, to be judged together.

    Attributes
    ----------
    before : ndarray, shape (K, N)
        Probability of each state (without the capture state) when the pursuer sets out.
    after : ndarray, shape (K, N)
        The same when it arrives.
    chance : ndarray, shape (K,)
        Probability, when it sets out, of the states that it will see from where it goes, each weighted with its
        detection probability; with same-cell capture ``p_x(t)``, the probability of the cell it is about to enter.
    distance : ndarray, shape (K,)
        Length of the way, metres.
    """

    before: NDArray[np.float64]
    after: NDArray[np.float64]
    chance: NDArray[np.float64]
    distance: NDArray[np.float64]


Cost: TypeAlias = Callable[[Hops], NDArray[np.float64]]
"""Gives the cost of each hop, shape (K,), none below 0; a path costs the sum over its hops (Eq. 8)."""


def probability(hops: Hops) -> NDArray[np.float64]:
    """Probability of failing to capture on entering the cell: Eq. 4 of the paper, ``1 - p_x(t)``."""
    return np.asarray(1.0 - hops.chance)


def distance_over_probability(hops: Hops) -> NDArray[np.float64]:
    """Distance over the probability of capture: Eq. 5 of the paper, after Sarmiento et al.; metres.

    That is the paper's reference [16], on searching polygonal environments with several robots. A probability below
    1e-9 counts as 1e-9, so that a path over fewer empty cells is still the cheaper one.
    """
    return np.asarray(hops.distance / np.maximum(hops.chance, SMALLEST_PROBABILITY))


def target_probability(hops: Hops) -> NDArray[np.float64]:
    """Distance of the belief from certain capture: Eq. 6 of the paper, ``sum_n |p_n - target_n|``.

    The target is [1, 0, ..., 0]. Since p sums to 1 this is twice the probability of the evader's being free.

    Examples
    --------
    >>> import numpy as np
    >>> hop = Hops(np.array([[0.5, 0.5]]), np.array([[0.0, 0.25]]), np.array([0.5]), np.array([3.0]))
    >>> print(target_probability(hop), probability(hop), distance_over_probability(hop), entropy(hop).round(4))
    [0.5] [0.5] [6.] [0.5623]
    """
    return np.asarray(2.0 * hops.after.sum(axis=1))


def entropy(hops: Hops) -> NDArray[np.float64]:
    """Entropy of the belief: Eq. 7 of the paper, ``-sum_n p_n log p_n`` over all states and that of capture; nats."""
    captured = np.maximum(1.0 - hops.after.sum(axis=1), 0.0)
    return np.asarray(_surprise(hops.after).sum(axis=1) + _surprise(captured))


def _surprise(p: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``-p log p``, 0 where p is 0."""
    return np.asarray(-p * np.log(np.where(p > 0, p, 1.0)))


_COSTS: dict[str, Cost] = {
    "entropy": entropy,
    "target-probability": target_probability,
    "probability": probability,
    "distance-over-probability": distance_over_probability,
}
COSTS: Mapping[str, Cost] = MappingProxyType(_COSTS)
"""Every heuristic by its name."""


def register_cost(name: str) -> Callable[[Cost], Cost]:
    """Give a cost heuristic of one's own a name, under which planners and the command line find it; a decorator.

    Raises
    ------
    GeomsimError
        If the name is none, or there is another one of it.
    """

    def register(cost: Cost) -> Cost:
        enter(_COSTS, "cost heuristic", name, cost)
        return cost

    return register


def find_cost(name: str) -> Cost:
    """Return a heuristic by its name.

    Raises
    ------
    CostError
        If there is none of this name; the message offers the nearest one.
    """
    if name not in COSTS:
        raise CostError(f"There is no cost heuristic {name!r}; {nearest(name, COSTS)}")
    return COSTS[name]
