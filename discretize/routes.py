"""Routes from the checkpoint of a cell to its portals that keep a round body off the walls."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.reach import Reach, reach_of
from maps import FreeSpace

__all__ = ["Ways", "ways_of"]

Leg = NDArray[np.float64]

_CLEARANCE = 0.01
"""Routes keep this much more than the body's radius from walls where there is room for it, metres."""

_APPROACH = 0.05
"""A body turns towards the door this much more than its radius before it, metres."""


@dataclass(frozen=True, slots=True)
class Ways:
    """Where the centre of a body can be: at all, and with some clearance.

    Attributes
    ----------
    tight : Reach
        No nearer to a wall than the body's radius.
    roomy : Reach
        A centimetre more.
    """

    tight: Reach
    roomy: Reach

    def way(self, start: NDArray[np.float64], goal: NDArray[np.float64]) -> Leg | None:
        """Short way from place to place, with clearance where that is no great detour; None where there is none."""
        near = float(np.hypot(*(goal - start))) + self.tight.radius
        for margin in (near, 4 * near, np.inf):
            for reach in (self.roomy, self.tight):
                way = reach.way(start, goal, margin)
                if way is not None:
                    return way
        return None

    def legs(
        self,
        cells: Sequence[shapely.Polygon],
        checkpoints: NDArray[np.float64],
        pairs: NDArray[np.intp],
        segments: NDArray[np.float64],
        points: NDArray[np.float64],
    ) -> list[tuple[Leg, Leg] | None]:
        """Routes on both sides of every portal, from the checkpoint of the cell to the portal point.

        Parameters
        ----------
        cells : sequence of shapely.Polygon
            N cells, metres.
        checkpoints : ndarray, shape (N, 2)
            Metres.
        pairs : ndarray, shape (k, 2)
            Cells of each portal.
        segments : ndarray, shape (k, 2, 2)
            Shared segment of each portal, the first cell on its left.
        points : ndarray, shape (k, 2)
            Portal points.

        Returns
        -------
        list of pairs of ndarray
            None for a portal that a body cannot get to.
        """
        along = segments[:, 1] - segments[:, 0]
        left = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
        sides = [self._side(cells, checkpoints, pairs[:, k], points, left * (1 - 2 * k)) for k in (0, 1)]
        return [None if a is None or b is None else (a, b) for a, b in zip(*sides, strict=True)]

    def _side(
        self,
        cells: Sequence[shapely.Polygon],
        checkpoints: NDArray[np.float64],
        cell: NDArray[np.intp],
        points: NDArray[np.float64],
        inwards: NDArray[np.float64],
    ) -> list[Leg | None]:
        start = checkpoints[cell]
        depth = np.clip(((start - points) * inwards).sum(axis=1), 0.0, self.tight.radius + _APPROACH)
        before = points + inwards * depth[:, None]
        own = np.array(cells, dtype=object)[cell]
        fits = (depth > 1e-6) & shapely.intersects_xy(own, before[:, 0], before[:, 1])
        fits &= self.tight.allows(np.stack([before, points], axis=1))
        goal = np.where(fits[:, None], before, points)
        straight = self.roomy.allows(np.stack([start, goal], axis=1))
        legs: list[Leg | None] = []
        for k in range(len(points)):
            way = np.stack([start[k], goal[k]]) if straight[k] else self.way(start[k], goal[k])
            if way is not None:
                way = way[np.concatenate([[True], np.hypot(*np.diff(way, axis=0).T) > 1e-9])]
                way = np.concatenate([way, points[k : k + 1]]) if fits[k] or len(way) == 1 else way
            legs.append(way)
        return legs


def ways_of(space: FreeSpace, radius: float) -> Ways:
    """Find where the centre of a body can be.

    Parameters
    ----------
    space : shapely.Polygon or shapely.MultiPolygon
        Free space, metres.
    radius : float
        Metres.
    """
    return Ways(reach_of(space, radius), reach_of(space, radius + _CLEARANCE))
