"""Distances to evaders that robots measure, and what they tell of where an evader is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize import CellMap
from planners import LineOfSight, SearchProblem, measured_range

__all__ = ["RangeReadings"]

# However far off a reading is from what is believed, it may have been that.
LEAST = 1e-12


@dataclass(frozen=True, slots=True, eq=False)
class RangeReadings:
    """Readings of the distance to an evader, in a straight line, with Gaussian noise (Section IV-B, the matrix M).

    Attributes
    ----------
    middles : ndarray, shape (S, 2)
        The middle of each state of the belief, metres.
    spreads : ndarray, shape (S,)
        Deviation of a reading of an evader that is anywhere in a state: that of the noise, and that of a place in a
        square of the state's area along one direction; metres.
    """

    middles: NDArray[np.float64]
    spreads: NDArray[np.float64]

    @classmethod
    def of(cls, cells: CellMap, problem: SearchProblem, noise: float) -> RangeReadings:
        """Prepare for readings with noise of some standard deviation, metres."""
        states, capture = problem.states, problem.captures[0]
        centroids = shapely.get_coordinates(shapely.centroid(np.array(cells.cells, dtype=object)))
        middles = capture.map.points if isinstance(capture, LineOfSight) else centroids[states.cell]
        return cls(middles, np.hypot(noise, np.sqrt(cells.areas[states.cell] * states.share / 12.0)))

    def likelihoods(self, eyes: NDArray[np.float64], ranges: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the likelihood of readings for each state, shape (P, E, S).

        Parameters
        ----------
        eyes : ndarray, shape (P, 2)
            Where the robots are, metres.
        ranges : ndarray, shape (P, E)
            What they measured, metres; NaN for no reading.
        """
        told = np.ones((*ranges.shape, len(self.middles)))
        for i, k in np.argwhere(np.isfinite(ranges)).tolist():
            away = np.hypot(*(self.middles - eyes[i]).T)
            told[i, k] = np.maximum(measured_range(away, float(ranges[i, k]), self.spreads), LEAST)
        return told
