"""The frame in which a plan is cut: its own, so that cells do not depend on where and how it was drawn."""

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.rooms.cuts import ring_segments

__all__ = ["Frame", "frame_of"]

Array = NDArray[np.float64]

UPRIGHT = 1e-6  # radians; walls this nearly parallel to the axes are, and stay on the grid


@dataclass(frozen=True, eq=False, slots=True)
class Frame:
    """A frame of reference.

    Attributes
    ----------
    origin : ndarray, shape (2,)
        Metres.
    axes : ndarray, shape (2, 2)
        Unit vectors along x and y, one a row.
    """

    origin: Array
    axes: Array

    def turned(self, geometry: shapely.Geometry) -> shapely.Geometry:
        """Return a geometry of the plan in this frame, on no grid."""
        return shapely.transform(shapely.set_precision(geometry, 0), self.inward)

    def inward(self, xy: Array) -> Array:
        """Return places in this frame, shape (k, 2), metres."""
        return np.asarray((xy - self.origin) @ self.axes.T)

    def outward(self, xy: Array) -> Array:
        """Return places of this frame in the plan's, shape (k, 2), metres."""
        return np.asarray(xy @ self.axes + self.origin)


def frame_of(space: shapely.Geometry) -> Frame:
    """Find the frame that turns and moves with a plan: in the middle of its walls, along most of them.

    Of the four directions the one is taken in which what is far from the middle lies.

    Parameters
    ----------
    space : shapely.Geometry
        Free space, metres.
    """
    walls = ring_segments(space)
    d = walls[:, 1] - walls[:, 0]
    length = np.hypot(*d.T)
    middle = walls.mean(axis=1)
    origin: Array = np.round(length @ middle / length.sum(), 3)
    fourfold = ((d[:, 0] + 1j * d[:, 1]) ** 4 / np.maximum(length, 1e-12) ** 3).sum()
    angle = float(np.angle(fourfold)) / 4
    x = np.array([1.0, 0.0]) if abs(angle) < UPRIGHT else np.array([np.cos(angle), np.sin(angle)])
    away = middle - origin
    far = ((length * (away**2).sum(axis=1))[:, None] * away).sum(axis=0)
    turned = [x, np.array([-x[1], x[0]]), -x, np.array([x[1], -x[0]])]
    x = turned[int(np.argmax(np.round([far @ axis / max(float(np.hypot(*far)), 1e-12) for axis in turned], 6)))]
    return Frame(origin, np.stack([x, np.array([-x[1], x[0]])]))
