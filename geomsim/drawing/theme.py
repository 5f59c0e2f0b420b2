"""Themes: every colour that a picture uses, light and dark."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geomsim.drawing.colours import ramp
from maps import GeomsimError, nearest

__all__ = ["THEMES", "DrawingError", "Theme", "find_theme"]


class DrawingError(GeomsimError):
    """A picture or video that cannot be drawn or written."""


@dataclass(frozen=True, slots=True, eq=False)
class Theme:
    """Colours as ``#rrggbb``.

    Attributes
    ----------
    name : str
        "light" or "dark".
    page, text, muted, grid : str
        Background, text, lesser text and thin lines beside the plan.
    wall, dots, portal : str
        Walls, cell boundaries and places to cross them.
    light : str
        What the area that a robot sees is mixed with.
    casing, label : str
        Outline around robots and evader, and the number on them.
    evader, repair, curve : str
        The evader; what was repaired in a plan; the curve of the chance of capture.
    robots : tuple of str
        One for each pursuer, again from the first where there are more of them.
    ramp : ndarray of uint8, shape (256, 3)
        Probability from none to most: red, green, blue.
    """

    name: str
    page: str
    text: str
    muted: str
    grid: str
    wall: str
    dots: str
    portal: str
    light: str
    casing: str
    label: str
    evader: str
    repair: str
    curve: str
    robots: tuple[str, ...]
    ramp: NDArray[np.uint8]

    def robot(self, number: int) -> str:
        """Colour of a pursuer, counted from 0."""
        return self.robots[number % len(self.robots)]


# Robots keep clear of the ramp's blues and differ from one another in lightness as well as in hue.
THEMES = {
    "light": Theme(
        name="light",
        page="#ffffff",
        text="#1c2430",
        muted="#66707f",
        grid="#d9dee5",
        wall="#232a35",
        dots="#5c6675",
        portal="#3d4654",
        light="#ffffff",
        casing="#ffffff",
        label="#ffffff",
        evader="#d0103a",
        repair="#d0103a",
        curve="#00838f",
        robots=("#d9660a", "#00805f", "#a23b90", "#7d6400", "#00838f", "#7a3e1d", "#4d7a00", "#5b4b9a"),
        ramp=ramp((0.985, 0.45), (0.004, 0.19), (245.0, 264.0)),
    ),
    "dark": Theme(
        name="dark",
        page="#12161c",
        text="#eef2f7",
        muted="#96a1b1",
        grid="#313a46",
        wall="#dfe5ee",
        dots="#7f8b9b",
        portal="#b5c0ce",
        light="#ffffff",
        casing="#0b0e12",
        label="#0b0e12",
        evader="#ff5470",
        repair="#ff5470",
        curve="#4fd1dd",
        robots=("#ff9d3d", "#39d6a5", "#f08fdc", "#e9d04a", "#d9a27e", "#b4e05a", "#ffc2b0", "#b8a6ff"),
        ramp=ramp((0.235, 0.80), (0.012, 0.15), (258.0, 222.0)),
    ),
}


def find_theme(name: str) -> Theme:
    """Return a theme by name; DrawingError with the nearest name where there is none."""
    try:
        return THEMES[name]
    except KeyError:
        raise DrawingError(f"There is no theme {name!r}: {nearest(name, THEMES)}") from None
