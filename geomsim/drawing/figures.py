"""The moving figures on the floor: robots, evader, trails, ways ahead and what is seen."""

import numpy as np
from numpy.typing import NDArray

from geomsim.drawing.colours import mixed
from geomsim.drawing.strokes import Image, dashes, disc, line, polygon, tint
from geomsim.drawing.text import draw_text
from geomsim.drawing.theme import Theme
from geomsim.drawing.viewport import Viewport

__all__ = ["Figures"]

Array = NDArray[np.float64]


class Figures:
    """Draws figures whose sizes follow the image, whatever the size of the building.

    Parameters
    ----------
    view : Viewport
        From metres to pixels.
    theme : Theme
        Colours.
    unit : float
        Pixels that a thin line takes.
    """

    def __init__(self, view: Viewport, theme: Theme, unit: float) -> None:
        self._view = view
        self._theme = theme
        self._unit = unit
        self._thin = max(1, round(1.2 * unit))

    def sight(self, image: Image, number: int, area: Array) -> None:
        """Draw the area that a robot sees, shape (k, 2), metres: lit from there."""
        pixels = self._view.pixels(area)
        colour = self._theme.robot(number)
        tint(image, pixels, mixed(colour, self._theme.light, 0.5), 0.38)

    def trail(self, image: Image, number: int, path: Array) -> None:
        """Draw where a robot has come from, thinner the longer ago."""
        pixels = self._view.pixels(path)
        pieces = np.array_split(np.arange(len(pixels) - 1), 4)
        for width, piece in zip((1.0, 1.5, 2.0, 2.5), pieces, strict=True):
            if len(piece):
                part = pixels[piece[0] : piece[-1] + 2]
                line(image, part, self._theme.robot(number), max(1, round(width * self._unit)))

    def route(self, image: Image, number: int, path: Array) -> None:
        """Draw where a robot intends to go, dashed, with a ring at the end."""
        if len(path) < 2:
            return
        pixels = self._view.pixels(path)
        colour = self._theme.robot(number)
        left = float(np.hypot(*np.diff(pixels, axis=0).T).sum())
        dash, gap = 7.0 * self._unit, 5.0 * self._unit
        # Counted from the far end, dashes stand still while the robot moves.
        dashes(image, pixels, colour, max(1, round(1.6 * self._unit)), dash=dash, gap=gap, shift=-left)
        disc(image, pixels[-1], 4.5 * self._unit, colour)
        disc(image, pixels[-1], 2.6 * self._unit, self._theme.casing)

    def robot(self, image: Image, number: int, position: Array, heading: float, prefix: str = "") -> None:
        """Draw a robot with its number, from 1, and a beak where it is heading."""
        centre = self._view.pixels(position)
        radius = 9.5 * self._unit
        for grown, colour in ((1.8 * self._unit, self._theme.casing), (0.0, self._theme.robot(number))):
            polygon(image, [_beak(centre, radius + grown, heading, grown)], colour)
            disc(image, centre, radius + grown, colour)
        self._label(image, f"{prefix}{number + 1}", centre, 13.0)

    def spotting(self, image: Image, pursuer: Array, evader: Array) -> None:
        """Draw the line of sight that ended the pursuit."""
        ends = np.stack([self._view.pixels(pursuer), self._view.pixels(evader)])
        line(image, ends, self._theme.evader, max(1, round(2.0 * self._unit)))

    def evader(self, image: Image, position: Array, *, captured: bool) -> None:
        """Draw the evader, a diamond with an E; a ring around it once it is captured."""
        centre = self._view.pixels(position)
        radius = 12.0 * self._unit
        if captured:
            _ring(image, centre, radius + 6.0 * self._unit, self._theme.evader, round(2.2 * self._unit))
        for grown, colour in ((2.4 * self._unit, self._theme.casing), (0.0, self._theme.evader)):
            reach = radius + grown
            polygon(image, [centre + reach * np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])], colour)
        self._label(image, "E", centre, 12.0)

    def _label(self, image: Image, text: str, centre: Array, size: float) -> None:
        size *= self._unit * min(1.0, 2.1 / (len(text) + 0.6))
        at = (float(centre[0]) + 0.5, float(centre[1]))
        draw_text(image, text, at, size, self._theme.label, "centre", bold=True)


def _ring(image: Image, centre: Array, radius: float, colour: str, width: int) -> None:
    turn = np.linspace(0.0, 2 * np.pi, 49)[:-1]
    line(image, centre + radius * np.stack([np.cos(turn), np.sin(turn)], axis=1), colour, max(1, width), closed=True)


def _beak(centre: Array, radius: float, heading: float, grown: float) -> Array:
    reach = np.array([radius * 1.45 + grown * 0.4, radius * 0.98, radius * 0.98])
    angle = -heading + np.array([0.0, 0.62, -0.62])  # y is turned down
    corners: Array = centre + reach[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return corners
