"""The moving figures on the floor: robots, evader, trails, ways ahead and what is seen."""

import numpy as np
from numpy.typing import NDArray

from geomsim.drawing.colours import mixed
from geomsim.drawing.moment import Moment
from geomsim.drawing.surface import Surface
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
    team : int
        How many robots there are; ways that they share are drawn side by side.
    """

    def __init__(self, view: Viewport, theme: Theme, unit: float, team: int = 1) -> None:
        self._view = view
        self._theme = theme
        self._unit = unit
        self._team = team

    def sight(self, surface: Surface, number: int, area: Array) -> None:
        """Draw the area that a robot sees, shape (k, 2), metres: lit from there."""
        pixels = self._view.pixels(area)
        colour = self._theme.robot(number)
        surface.tint(pixels, mixed(colour, self._theme.light, 0.5), 0.38)

    def trail(self, surface: Surface, number: int, path: Array) -> None:
        """Draw where a robot has come from, thinner the longer ago."""
        pixels = self._view.pixels(path)
        pieces = np.array_split(np.arange(len(pixels) - 1), 4)
        for width, piece in zip((1.0, 1.5, 2.0, 2.5), pieces, strict=True):
            if len(piece):
                part = pixels[piece[0] : piece[-1] + 2]
                surface.line(part, self._theme.robot(number), width * self._unit)

    def route(self, surface: Surface, number: int, path: Array) -> None:
        """Draw where a robot intends to go, dashed, with a ring at the end."""
        if len(path) < 2:
            return
        aside = (number - (self._team - 1) / 2) * min(3.0, 9.0 / max(self._team - 1, 1)) * self._unit
        pixels = self._view.pixels(path) + aside  # to the right and down, which tells both kinds of hallway apart
        colour = self._theme.robot(number)
        left = float(np.hypot(*np.diff(pixels, axis=0).T).sum())
        dash, gap = 7.0 * self._unit, 5.0 * self._unit
        # Counted from the far end, dashes stand still while the robot moves.
        surface.dashes(pixels, colour, 1.6 * self._unit, dash=dash, gap=gap, shift=-left)
        surface.disc(pixels[-1], 4.5 * self._unit, colour)
        surface.disc(pixels[-1], 2.6 * self._unit, self._theme.casing)

    def bodies(
        self, surface: Surface, moment: Moment, *, hidden: bool = False, prefix: str = "", last: int = -1
    ) -> None:
        """Draw the robots, ``last`` on top, and below them the evaders.

        Evaders that are not captured yet are drawn only if they are not ``hidden``; they are numbered if there are
        several. Those in one place are drawn beside each other, so that all can be read.
        """
        team, caught = len(moment.pursuers), {capture.evader for capture in moment.captures}
        shown = [k for k in range(len(moment.evaders)) if k in caught or not hidden]
        places = np.vstack([moment.pursuers, moment.evaders[shown]])
        centres = apart(self._view.pixels(places), 19.0 * self._unit)
        for k, centre in zip(shown, centres[team:], strict=True):
            self._evader(surface, centre, "E" if len(moment.evaders) == 1 else f"E{k + 1}", captured=k in caught)
        for number in sorted(range(team), key=lambda k: k == last):
            self._robot(surface, number, centres[number], float(moment.headings[number]), prefix)

    def _robot(self, surface: Surface, number: int, centre: Array, heading: float, prefix: str) -> None:
        """Draw a robot with its number, from 1, and a beak where it is heading."""
        radius = 9.5 * self._unit
        for grown, colour in ((1.8 * self._unit, self._theme.casing), (0.0, self._theme.robot(number))):
            surface.polygon([_beak(centre, radius + grown, heading, grown)], colour)
            surface.disc(centre, radius + grown, colour)
        self._label(surface, f"{prefix}{number + 1}", centre, 13.0)

    def spotting(self, surface: Surface, pursuer: Array, evader: Array) -> None:
        """Draw the line of sight that ended the pursuit."""
        ends = np.stack([self._view.pixels(pursuer), self._view.pixels(evader)])
        surface.line(ends, self._theme.evader, 2.0 * self._unit)

    def _evader(self, surface: Surface, centre: Array, name: str, *, captured: bool) -> None:
        """Draw an evader, a diamond with its name; a ring around it once it is captured."""
        radius = 12.0 * self._unit
        if captured:
            _ring(surface, centre, radius + 6.0 * self._unit, self._theme.evader, 2.2 * self._unit)
        for grown, colour in ((2.4 * self._unit, self._theme.casing), (0.0, self._theme.evader)):
            reach = radius + grown
            surface.polygon([centre + reach * np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])], colour)
        self._label(surface, name, centre, 12.0)

    def _label(self, surface: Surface, text: str, centre: Array, size: float) -> None:
        size *= self._unit * min(1.0, 2.1 / (len(text) + 0.6))
        at = (float(centre[0]) + 0.5, float(centre[1]))
        surface.text(text, at, size, self._theme.label, "centre", bold=True)


def apart(places: Array, distance: float) -> Array:
    """Move places away from each other until no two are nearer than a distance, or nearly so.

    Parameters
    ----------
    places : ndarray, shape (k, 2)
        Pixels.
    distance : float
        Pixels. How far a place is moved changes continuously with where the others are.
    """
    moved = np.array(places, dtype=np.float64)
    count = len(moved)
    # places that coincide part in directions of their own
    turn = 2 * np.pi * np.arange(count) / max(count, 1)
    moved += 1e-3 * distance * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    for _ in range(60):
        gap = moved[:, None] - moved[None]
        away = np.hypot(gap[..., 0], gap[..., 1])
        push = np.maximum(distance - away, 0.0) / 2
        np.fill_diagonal(push, 0.0)
        if push.max(initial=0.0) < 5e-3 * distance:
            break
        moved += (gap * (push / np.maximum(away, 1e-9))[..., None]).sum(axis=1) * 0.5
    return moved


def _ring(surface: Surface, centre: Array, radius: float, colour: str, width: float) -> None:
    turn = np.linspace(0.0, 2 * np.pi, 49)[:-1]
    surface.line(centre + radius * np.stack([np.cos(turn), np.sin(turn)], axis=1), colour, width, closed=True)


def _beak(centre: Array, radius: float, heading: float, grown: float) -> Array:
    reach = np.array([radius * 1.45 + grown * 0.4, radius * 0.98, radius * 0.98])
    angle = -heading + np.array([0.0, 0.62, -0.62])  # y is turned down
    corners: Array = centre + reach[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return corners
