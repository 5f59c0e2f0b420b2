"""Anti-aliased drawing on pixels with OpenCV, in fractions of a pixel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Self

import cv2
import numpy as np
from numpy.typing import NDArray

from geomsim.drawing.colours import bgr
from geomsim.drawing.surface import Align
from geomsim.drawing.text import draw_text
from geomsim.drawing.viewport import Box

__all__ = ["SHIFT", "Image", "Raster", "blank", "fixed", "spread"]

Image = NDArray[np.uint8]

# OpenCV takes coordinates as whole numbers of 1/2^SHIFT pixel.
SHIFT = 4


def blank(width: int, height: int, colour: str) -> Image:
    """Return an image of one colour, shape (height, width, 3), blue first."""
    return np.full((height, width, 3), bgr(colour), dtype=np.uint8)


def fixed(pixels: NDArray[np.float64]) -> NDArray[np.int32]:
    """Return pixel coordinates as OpenCV's fixed-point numbers."""
    return np.rint(pixels * (1 << SHIFT)).astype(np.int32)


def spread(path: NDArray[np.float64], spacing: float) -> NDArray[np.float64]:
    """Return points along a polyline, evenly, with half a space at each end."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    count = max(1, round(along[-1] / spacing))
    places = (np.arange(count) + 0.5) * along[-1] / count
    return np.stack([np.interp(places, along, path[:, 0]), np.interp(places, along, path[:, 1])], axis=1)


class Raster:
    """An image as a :class:`~geomsim.drawing.surface.Surface`.

    Parameters
    ----------
    image : ndarray of uint8, shape (height, width, 3)
        Blue first; drawn on.
    """

    def __init__(self, image: Image) -> None:
        self.image = image

    def part(self, box: Box) -> Self:
        """Return a view of a box of the image."""
        return type(self)(self.image[box.slices])

    def line(self, pixels: NDArray[np.float64], colour: str, width: float, *, closed: bool = False) -> None:
        """Draw a polyline; its width is a whole number of pixels."""
        if len(pixels) > 1:
            cv2.polylines(self.image, [fixed(pixels)], closed, bgr(colour), _whole(width), cv2.LINE_AA, SHIFT)

    def dotted(self, paths: Sequence[NDArray[np.float64]], colour: str, width: float, spacing: float) -> None:
        """Draw polylines as rows of dots."""
        for path in paths:
            for dot in spread(path, spacing):
                self.disc(dot, width / 2, colour)

    def polygon(self, rings: Sequence[NDArray[np.float64]], colour: str, seam: float = 0.0) -> None:
        """Fill the area within rings by the even-odd rule, which grows it by half a pixel already."""
        cv2.fillPoly(self.image, [fixed(ring) for ring in rings], bgr(colour), cv2.LINE_AA, SHIFT)
        if seam > 1.0:
            for ring in rings:
                self.line(ring, colour, seam, closed=True)

    def disc(self, centre: NDArray[np.float64], radius: float, colour: str) -> None:
        """Fill a circle."""
        x, y = fixed(np.asarray(centre))
        whole = round(radius * (1 << SHIFT))
        cv2.circle(self.image, (int(x), int(y)), whole, bgr(colour), -1, cv2.LINE_AA, SHIFT)

    def strip(self, box: Box, colours: NDArray[np.uint8]) -> None:
        """Fill a box from left to right with colours, red first."""
        columns = np.linspace(0, len(colours) - 1, box.width).round().astype(int)
        self.image[box.slices] = colours[columns][:, ::-1]

    def text(
        self,
        text: str,
        at: tuple[float, float],
        size: float,
        colour: str,
        align: Align = "left",
        bold: bool = False,
    ) -> None:
        """Write a line of text."""
        draw_text(self.image, text, at, size, colour, align, bold)

    def tint(self, pixels: NDArray[np.float64], colour: str, opacity: float) -> None:
        """Blend a colour over the area within one ring, and touch nothing else."""
        height, width = self.image.shape[:2]
        x, y = pixels.T
        x0, y0 = max(int(x.min()) - 3, 0), max(int(y.min()) - 3, 0)
        x1, y1 = min(int(x.max()) + 4, width), min(int(y.max()) + 4, height)
        if x0 >= x1 or y0 >= y1:
            return
        under = self.image[y0:y1, x0:x1]
        over = under.copy()
        Raster(over).polygon([pixels - (x0, y0)], colour)
        cv2.addWeighted(over, opacity, under, 1.0 - opacity, 0.0, dst=under)

    def dashes(
        self, pixels: NDArray[np.float64], colour: str, width: float, *, dash: float, gap: float, shift: float = 0.0
    ) -> None:
        """Draw a polyline in dashes."""
        if len(pixels) < 2:
            return
        along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(pixels, axis=0).T))])
        period = dash + gap
        starts = np.arange(-(shift % period), along[-1], period)
        cuts = np.unique(np.clip(np.concatenate([along, starts, starts + dash]), 0.0, along[-1]))
        middle = (cuts[1:] + cuts[:-1]) / 2
        drawn = (middle + shift) % period < dash
        corners = fixed(np.stack([np.interp(cuts, along, pixels[:, 0]), np.interp(cuts, along, pixels[:, 1])], axis=1))
        pieces = np.stack([corners[:-1], corners[1:]], axis=1)[drawn]
        cv2.polylines(self.image, list(pieces), False, bgr(colour), _whole(width), cv2.LINE_AA, SHIFT)


def _whole(width: float) -> int:
    return max(1, round(width))
