"""From metres to pixels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Box", "Viewport"]


@dataclass(frozen=True, slots=True)
class Box:
    """A rectangle of pixels: left, top, right and bottom, the last two not included."""

    left: int
    top: int
    right: int
    bottom: int

    @property
    def width(self) -> int:
        """Columns."""
        return self.right - self.left

    @property
    def height(self) -> int:
        """Rows."""
        return self.bottom - self.top

    @property
    def slices(self) -> tuple[slice, slice]:
        """Index of the rectangle in an image."""
        return slice(self.top, self.bottom), slice(self.left, self.right)

    def inset(self, left: int, top: int, right: int, bottom: int) -> Box:
        """Return the rectangle without margins."""
        return Box(self.left + left, self.top + top, self.right - right, self.bottom - bottom)


@dataclass(frozen=True, slots=True)
class Viewport:
    """A uniform scale with y turned down. Whole pixel coordinates are the centres of pixels.

    Attributes
    ----------
    scale : float
        Pixels in a metre.
    origin : tuple of float
        Pixel of the point (0, 0).
    """

    scale: float
    origin: tuple[float, float]

    @classmethod
    def fit(cls, bounds: tuple[float, float, float, float], box: Box) -> Viewport:
        """Centre an area of the plan in a box, as large as it can be.

        Parameters
        ----------
        bounds : tuple of float
            Smallest x and y, largest x and y, metres.
        box : Box
            Where to.
        """
        x0, y0, x1, y1 = bounds
        scale = min(box.width / max(x1 - x0, 1e-6), box.height / max(y1 - y0, 1e-6))
        left = (box.left + box.right - 1) / 2 - scale * (x0 + x1) / 2
        return cls(scale, (left, (box.top + box.bottom - 1) / 2 + scale * (y0 + y1) / 2))

    def pixels(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the pixel coordinates of points in metres, shape (k, 2) or (2,)."""
        return points * (self.scale, -self.scale) + self.origin

    def zoomed(self, factor: int) -> Viewport:
        """Return the same view on an image whose pixels are each cut into ``factor`` x ``factor``."""
        shift = (factor - 1) / 2
        return Viewport(self.scale * factor, (self.origin[0] * factor + shift, self.origin[1] * factor + shift))
