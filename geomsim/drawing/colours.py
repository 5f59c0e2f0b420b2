"""Colours: conversion from the perceptual space OKLCH, and the ramp that shows probability."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

__all__ = ["bgr", "hex_colour", "lightness", "mixed", "ramp"]

# OKLab <-> linear sRGB, B. Ottosson, "A perceptual color space for image processing" (2020).
_LAB_TO_LMS = np.array(
    [
        [1.0, 0.3963377774, 0.2158037573],
        [1.0, -0.1055613458, -0.0638541728],
        [1.0, -0.0894841775, -1.2914855480],
    ]
)
_LMS_TO_RGB = np.array(
    [
        [4.0767416621, -3.3077115913, 0.2309699292],
        [-1.2684380046, 2.6097574011, -0.3413193965],
        [-0.0041960863, -0.7034186147, 1.7076147010],
    ]
)


@cache
def bgr(colour: str) -> tuple[int, int, int]:
    """Return a colour ``#rrggbb`` as OpenCV wants it."""
    return int(colour[5:7], 16), int(colour[3:5], 16), int(colour[1:3], 16)


def hex_colour(rgb: NDArray[np.uint8]) -> str:
    """Return a colour of shape (3,) as ``#rrggbb``."""
    return "#{:02x}{:02x}{:02x}".format(*(int(c) for c in rgb))


@cache
def mixed(colour: str, other: str, part: float) -> str:
    """Return a colour with a part, 0 to 1, of another one in it."""
    pairs = zip(bgr(colour)[::-1], bgr(other)[::-1], strict=True)
    return "#{:02x}{:02x}{:02x}".format(*(round(a + part * (b - a)) for a, b in pairs))


def ramp(
    light: tuple[float, float], chroma: tuple[float, float], hue: tuple[float, float], steps: int = 256
) -> NDArray[np.uint8]:
    """Make a sequential ramp whose lightness and hue change evenly.

    Lightness alone orders the colours, so that the ramp reads the same with any colour vision and in print.

    Parameters
    ----------
    light, chroma, hue : pair of float
        First and last value in OKLCH; the hue in degrees. Chroma is cut where sRGB ends.
    steps : int
        How many colours.

    Returns
    -------
    ndarray of uint8, shape (steps, 3)
        Red, green, blue.
    """
    t = np.linspace(0.0, 1.0, steps)
    ls, cs, hs = (a + (b - a) * t for a, b in (light, chroma, np.radians(hue)))
    least, most = np.zeros(steps), cs
    for _ in range(20):  # bisection, so that what is cut is cut smoothly
        rgb = _oklch_to_rgb(ls, cs, hs)
        inside = np.all((rgb > -1e-4) & (rgb < 1 + 1e-4), axis=1)
        least, most = np.where(inside, cs, least), np.where(inside, most, cs)
        cs = (least + most) / 2
    return np.rint(255 * np.clip(_oklch_to_rgb(ls, least, hs), 0, 1)).astype(np.uint8)


def lightness(rgb: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Return the OKLab lightness, 0 to 1, of colours of shape (k, 3)."""
    s = rgb / 255.0
    linear = np.where(s <= 0.04045, s / 12.92, ((s + 0.055) / 1.055) ** 2.4)
    lab: NDArray[np.float64] = np.cbrt(linear @ np.linalg.inv(_LMS_TO_RGB).T) @ np.linalg.inv(_LAB_TO_LMS).T
    return lab[:, 0]


def _oklch_to_rgb(ls: NDArray[np.float64], cs: NDArray[np.float64], hs: NDArray[np.float64]) -> NDArray[np.float64]:
    lab = np.stack([ls, cs * np.cos(hs), cs * np.sin(hs)], axis=1)
    linear = (lab @ _LAB_TO_LMS.T) ** 3 @ _LMS_TO_RGB.T
    rgb: NDArray[np.float64] = np.where(
        linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 0.0031308) ** (1 / 2.4) - 0.055
    )
    return rgb
