"""Curves of the probability of still being free, beyond their ends."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

__all__ = ["lengthened", "mean_time"]


def mean_time(free: NDArray[np.float64], step: float, limit: float) -> float:
    """Return the time for which the evader is free, on average, up to the time limit, seconds.

    Parameters
    ----------
    free : ndarray, shape (T + 1,)
        Probability of being free at successive times; after its end it falls on as in its last half.
    step : float
        Between two of these times, seconds.
    limit : float
        Seconds.
    """
    free = free[: max(1, math.ceil(min(float(len(free)), limit / step + 1.0) - 1e-9))]
    seen, left, rate = float(free[:-1].sum()) * step, max(0.0, limit - (len(free) - 1) * step), _rate(free) / step
    return seen + float(free[-1]) * (-math.expm1(-rate * left) / rate if rate > 0 else left)


def lengthened(free: NDArray[np.float64], length: int) -> NDArray[np.float64]:
    """Return a curve of at least ``length`` values, which falls on as in its last half."""
    further = np.arange(1, length - len(free) + 1)
    return np.concatenate([free, free[-1] * np.exp(-_rate(free) * further)])


def _rate(free: NDArray[np.float64]) -> float:
    """Return how fast a curve falls in its last half, a step."""
    half = len(free) // 2
    if free[-1] <= 0 or half == len(free) - 1:
        return 0.0
    return float(np.log(free[half] / free[-1])) / (len(free) - 1 - half)
