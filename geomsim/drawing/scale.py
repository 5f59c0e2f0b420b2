"""The scale from probability to colour, and round numbers for axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geomsim.drawing.moment import shares

__all__ = ["ProbabilityScale", "percent", "round_number", "ticks"]


@dataclass(frozen=True, slots=True)
class ProbabilityScale:
    """Square-root scale: half the colours serve the lowest quarter, where nearly all cells are nearly always.

    It shows the chance that the evader is in a cell *if it has not been captured*, because all others fade to
    nothing as capture becomes likely; and it stays the same through an episode, so that pictures can be compared.

    Attributes
    ----------
    top : float
        Probability of the last colour, and of all above.
    """

    top: float

    @classmethod
    def of(cls, beliefs: NDArray[np.float64]) -> ProbabilityScale:
        """Choose a scale for all beliefs of an episode, shape (B, N + 1)."""
        peaks = np.array([shares(b).max(initial=0.0) for b in beliefs])
        return cls(min(1.0, _top(max(float(np.quantile(peaks, 0.95)), 1e-6))))

    def steps(self, share: NDArray[np.float64]) -> NDArray[np.intp]:
        """Return the index into a ramp of 256 colours for each share."""
        part: NDArray[np.float64] = np.sqrt(np.clip(share / self.top, 0.0, 1.0))
        return np.rint(255 * part).astype(np.intp)


def _top(value: float) -> float:
    """Return a round number not much above a value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(next(c for c in np.array([1, 1.5, 2, 3, 4, 5, 6, 8, 10]) * power if c >= value * (1 - 1e-9)))


def round_number(value: float, *, up: bool) -> float:
    """Return the next 1, 2 or 5 times a power of ten, above or below."""
    power = 10.0 ** np.floor(np.log10(value))
    choices = [c * power for c in (1.0, 2.0, 5.0, 10.0)]
    if up:
        return float(next(c for c in choices if c >= value * (1 - 1e-9)))
    return float(next(c for c in reversed(choices) if c <= value * (1 + 1e-9)))


def ticks(end: float, most: int) -> NDArray[np.float64]:
    """Return round numbers from 0 up to ``end``, at most ``most`` + 1 of them."""
    step = round_number(max(end, 1e-9) / most, up=True)
    return np.arange(0.0, end * (1 + 1e-9), step)


def percent(share: float) -> str:
    """Return a probability as people read it: 12 %, 1.5 %, 0.02 %."""
    value = 100 * share
    return f"{value:.2g} %" if value < 10 else f"{value:.0f} %"
