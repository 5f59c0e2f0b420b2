"""Which wall a ray meets first: the one geometric query that finding cuts needs."""

import numpy as np
import shapely
from numpy.typing import NDArray

__all__ = ["Walls", "lines_of"]

Array = NDArray[np.float64]


def lines_of(segments: Array) -> NDArray[np.object_]:
    """Make a line of each segment, shape (k,)."""
    return np.asarray(shapely.linestrings(segments), dtype=object)


class Walls:
    """Segments in an index, asked for the first one along a ray.

    Parameters
    ----------
    segments : ndarray, shape (M, 2, 2)
        Metres.
    """

    def __init__(self, segments: Array) -> None:
        self.segments = segments
        self._tree = shapely.STRtree(lines_of(segments))

    def hits(self, origins: Array, directions: Array, reach: Array, skip: float = 2e-3) -> Array:
        """Return how far each ray goes before it meets a wall, at most its reach; shape (k,), metres.

        Parameters
        ----------
        origins : ndarray, shape (k, 2)
            Metres.
        directions : ndarray, shape (k, 2)
            Unit vectors.
        reach : ndarray, shape (k,)
            Metres.
        skip : float
            Walls nearer than this are not seen, so that a ray may leave from a wall. Metres.
        """
        found = reach.astype(np.float64).copy()
        if len(origins) == 0:
            return found
        # Most rays are short: a long ray costs a search through its whole bounding box, so reach out in steps.
        open_ = np.arange(len(origins))
        step = np.minimum(reach, 4.0)
        while len(open_):
            distance = self._within(origins[open_], directions[open_], step[open_], skip)
            hit = distance < np.inf
            found[open_[hit]] = distance[hit]
            open_ = open_[~hit & (step[open_] < reach[open_])]
            step[open_] = np.minimum(reach[open_], 4.0 * step[open_])
        return found

    def _within(self, origins: Array, directions: Array, reach: Array, skip: float) -> Array:
        ends = np.stack([origins + skip * directions, origins + reach[:, None] * directions], axis=1)
        ray, wall = self._tree.query(shapely.linestrings(ends), predicate="intersects")
        a, b = self.segments[wall, 0], self.segments[wall, 1]
        d, e, w = directions[ray], b - a, a - origins[ray]
        denominator = d[:, 0] * e[:, 1] - d[:, 1] * e[:, 0]
        parallel = np.abs(denominator) < 1e-9 * np.hypot(e[:, 0], e[:, 1])
        crossing = (w[:, 0] * e[:, 1] - w[:, 1] * e[:, 0]) / np.where(parallel, 1.0, denominator)
        along = np.minimum((w * d).sum(1), ((b - origins[ray]) * d).sum(1))
        distance = np.maximum(np.where(parallel, along, crossing), skip)
        nearest = np.full(len(origins), np.inf)
        np.minimum.at(nearest, ray, distance)
        return nearest
