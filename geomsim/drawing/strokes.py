"""Anti-aliased lines and areas on OpenCV, in fractions of a pixel."""

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from geomsim.drawing.colours import bgr

__all__ = ["Image", "blank", "dashes", "disc", "fixed", "line", "polygon", "tint"]

Image = NDArray[np.uint8]

# OpenCV takes coordinates as whole numbers of 1/2^SHIFT pixel.
SHIFT = 4


def blank(width: int, height: int, colour: str) -> Image:
    """Return an image of one colour, shape (height, width, 3), blue first."""
    return np.full((height, width, 3), bgr(colour), dtype=np.uint8)


def fixed(pixels: NDArray[np.float64]) -> NDArray[np.int32]:
    """Return pixel coordinates as OpenCV's fixed-point numbers."""
    return np.rint(pixels * (1 << SHIFT)).astype(np.int32)


def line(image: Image, pixels: NDArray[np.float64], colour: str, width: int, *, closed: bool = False) -> None:
    """Draw a polyline, shape (k, 2) in pixels."""
    if len(pixels) > 1:
        cv2.polylines(image, [fixed(pixels)], closed, bgr(colour), width, cv2.LINE_AA, SHIFT)


def polygon(image: Image, rings: Sequence[NDArray[np.float64]], colour: str) -> None:
    """Fill the area within rings by the even-odd rule."""
    cv2.fillPoly(image, [fixed(ring) for ring in rings], bgr(colour), cv2.LINE_AA, SHIFT)


def disc(image: Image, centre: NDArray[np.float64], radius: float, colour: str) -> None:
    """Fill a circle."""
    x, y = fixed(np.asarray(centre))
    cv2.circle(image, (int(x), int(y)), round(radius * (1 << SHIFT)), bgr(colour), -1, cv2.LINE_AA, SHIFT)


def tint(image: Image, pixels: NDArray[np.float64], colour: str, opacity: float) -> None:
    """Blend a colour over the area within one ring, and touch nothing else."""
    height, width = image.shape[:2]
    x0, y0 = np.maximum(np.floor(pixels.min(axis=0)).astype(int) - 2, 0)
    x1, y1 = np.minimum(np.ceil(pixels.max(axis=0)).astype(int) + 3, (width, height))
    if x0 >= x1 or y0 >= y1:
        return
    part = image[y0:y1, x0:x1]
    layer = part.copy()
    polygon(layer, [pixels - (x0, y0)], colour)
    cv2.addWeighted(layer, opacity, part, 1.0 - opacity, 0.0, dst=part)


def dashes(
    image: Image, pixels: NDArray[np.float64], colour: str, width: int, *, dash: float, gap: float, shift: float = 0.0
) -> None:
    """Draw a polyline in dashes.

    Parameters
    ----------
    image : ndarray of uint8, shape (height, width, 3)
        Drawn on.
    pixels : ndarray, shape (k, 2)
        The path.
    colour : str
        ``#rrggbb``.
    width : int
        Of the line, pixels.
    dash, gap : float
        Lengths, pixels.
    shift : float
        How much of the first dash has been drawn already, pixels; so dashes stand still while a path is eaten up.
    """
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
    cv2.polylines(image, list(pieces), False, bgr(colour), width, cv2.LINE_AA, SHIFT)
