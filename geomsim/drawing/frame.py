"""One frame of a pursuit: plan, belief, robots, what they see, the evader, time and predicted capture."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import shapely
from numpy.typing import NDArray

from geomsim.drawing.colours import lightness
from geomsim.drawing.figures import Figures
from geomsim.drawing.floor import Floor
from geomsim.drawing.legend import draw_colour_bar, draw_scale_bar
from geomsim.drawing.moment import Moment, Timeline, beliefs_of, shares
from geomsim.drawing.raster import Image, Raster, blank
from geomsim.drawing.scale import ProbabilityScale
from geomsim.drawing.sight import Sight
from geomsim.drawing.strip import CaptureStrip
from geomsim.drawing.surface import Surface
from geomsim.drawing.text import cut_text, text_width
from geomsim.drawing.theme import DrawingError, find_theme
from geomsim.drawing.viewport import Box, Viewport
from geomsim.episode import Episode

__all__ = ["FrameDrawer", "FrameStyle", "draw_frame"]

_SMALLEST = (320, 240)


@dataclass(frozen=True, slots=True)
class FrameStyle:
    """How frames look.

    Attributes
    ----------
    size : tuple of int
        Width and height, pixels; at least 320 x 240.
    theme : str
        "light" or "dark".
    evader : str
        "shown", or "hidden" until it is captured, as the robots know it.
    belief, sight, plans, trails : bool
        Layers: cells shaded by probability, what each robot sees, where it intends to go, where it came from.
    numbers : bool
        Layer: the number of each cell that has room for it.
    belief_of : int or None
        Number of the robot whose own belief is shown, from 1; None for what all robots have seen together.
    note : str
        Something to say beside the time, such as the speed of a video.
    """

    size: tuple[int, int] = (1280, 720)
    theme: str = "light"
    evader: str = "shown"
    belief: bool = True
    sight: bool = True
    plans: bool = True
    trails: bool = True
    numbers: bool = False
    belief_of: int | None = None
    note: str = ""

    def __post_init__(self) -> None:
        if self.size[0] < _SMALLEST[0] or self.size[1] < _SMALLEST[1]:
            raise DrawingError(
                f"A frame of {self.size[0]} x {self.size[1]} pixels is too small; 320 x 240 is the least."
            )
        if self.evader not in ("shown", "hidden"):
            raise DrawingError(f"The evader can be 'shown' or 'hidden', not {self.evader!r}.")
        find_theme(self.theme)

    @property
    def unit(self) -> float:
        """Pixels that a thin line takes: 1 at 1280 x 720."""
        return min(self.size[0] / 1280, self.size[1] / 720)


@dataclass(slots=True)
class _Canvas:
    """The last floor that was painted, kept while the belief stays the same."""

    step: int = -1
    image: Image = field(default_factory=lambda: np.empty((0, 0, 3), np.uint8))


class FrameDrawer:
    """Draws any time of one episode; everything that does not move is drawn once.

    Parameters
    ----------
    episode : Episode
        The record.
    style : FrameStyle
        How it looks.
    """

    def __init__(self, episode: Episode, style: FrameStyle | None = None) -> None:
        self.episode = episode
        self.style = style = style or FrameStyle()
        self._theme = theme = find_theme(style.theme)
        unit = style.unit
        width, height = style.size
        margin, header, strip = round(16 * unit), round(46 * unit), round(104 * unit)
        legend = round(300 * unit)
        plan_box = Box(margin, header, width - margin, height - strip - round(6 * unit))
        legend_box = Box(width - margin - legend, height - strip, width - margin, height - round(10 * unit))
        strip_box = Box(margin, height - strip, legend_box.left - round(12 * unit), height - round(4 * unit))

        self._timeline = Timeline(episode)
        self._floor = Floor(episode.cells, plan_box, theme, unit)
        self._figures = Figures(self._floor.view, theme, unit, episode.pursuers.shape[1])
        self._strip = CaptureStrip(episode, strip_box, theme, unit)
        self._sight = Sight(episode)
        self._beliefs = beliefs_of(episode, style.belief_of)
        self._scale = ProbabilityScale.of(self._beliefs)
        self._background = self._draw_background(legend_box)
        self._canvas = _Canvas()

    @property
    def view(self) -> Viewport:
        """From metres to pixels."""
        return self._floor.view

    def draw(self, time: float) -> Image:
        """Return the frame at a time in seconds, shape (height, width, 3), blue first.

        A time before the start or after the end of the episode shows its first or last moment.
        """
        moment = self._timeline.at(time)
        painted = self._painted_floor(moment.step)
        image = painted.copy()
        surface, figures, style = Raster(image), self._figures, self.style
        team = range(len(moment.pursuers))
        if style.sight:
            for r in team:
                figures.sight(surface, r, self._sight.area(moment, r))
            self._floor.restore_walls(image, painted)
        if style.trails:
            for r in team:
                figures.trail(surface, r, moment.trails[r])
        if style.plans and not moment.captured:
            for r in team:
                figures.route(surface, r, moment.routes[r])
        by = self.episode.outcome.pursuer
        if moment.captured and by is not None:
            figures.spotting(surface, moment.pursuers[by], moment.evaders[self.episode.outcome.evader])
        figures.bodies(surface, moment, hidden=style.evader == "hidden", last=-1 if by is None else by)
        self._strip.draw(surface, moment)
        self._draw_time(surface, moment)
        return image

    def _painted_floor(self, step: int) -> Image:
        if self._canvas.step != step:
            image = self._background.copy()
            share = shares(self._beliefs[step]) if self.style.belief else np.zeros(len(self.episode.cells))
            colours = self._theme.ramp[self._scale.steps(share)]
            self._floor.paint(Raster(image), colours)
            if self.style.numbers:
                self._draw_numbers(Raster(image), colours)
            self._canvas = _Canvas(step, image)
        return self._canvas.image

    def _draw_numbers(self, surface: Surface, colours: NDArray[np.uint8]) -> None:
        theme, size = self._theme, 12 * self.style.unit
        far = np.abs(lightness(colours) - lightness(theme.ramp[:1])) > 0.3  # from the lightness of the page
        for k, (cell, at) in enumerate(zip(self.episode.cells.cells, self.episode.cells.checkpoints, strict=True)):
            room = self.view.scale * float(shapely.distance(cell.exterior, shapely.Point(at)))
            if room > 0.6 * text_width(str(k + 1), size):  # never where the checkpoint is not a number
                x, y = self.view.pixels(at)
                surface.text(str(k + 1), (float(x), float(y)), size, theme.page if far[k] else theme.text, "centre")

    def _draw_background(self, legend: Box) -> Image:
        theme, unit, episode = self._theme, self.style.unit, self.episode
        image = blank(*self.style.size, theme.page)
        surface = Raster(image)
        self._strip.draw_axes(surface)
        if self.style.belief:
            title = "chance that the evader is in a cell, if not captured"
            title += "" if self.style.belief_of is None else f" (robot {self.style.belief_of})"
            draw_colour_bar(surface, legend, self._scale, theme, unit, title)
        draw_scale_bar(surface, legend, self._floor.view.scale, theme, unit)
        at = (16 * unit, 23 * unit)
        name = cut_text(episode.plan.name, 0.35 * self.style.size[0], 20 * unit, bold=True)
        surface.text(name, at, 20 * unit, theme.text, bold=True)
        robots = episode.pursuers.shape[1]
        told = f"{robots} robot{'s' * (robots != 1)} · {len(episode.cells)} cells"
        x = at[0] + text_width(name, 20 * unit, True) + 14 * unit
        surface.text(told, (x, at[1] + unit), 14 * unit, theme.muted)
        return image

    def _draw_time(self, surface: Surface, moment: Moment) -> None:
        theme, unit = self._theme, self.style.unit
        right, y = self.style.size[0] - 16 * unit, 23 * unit
        widest = text_width(f"{self.episode.times[-1]:.1f} s", 22 * unit, True)
        surface.text(f"{moment.time:.1f} s", (right, y), 22 * unit, theme.text, "right", bold=True)
        x = right - widest - 16 * unit
        if self.style.note:
            surface.text(self.style.note, (x, y + unit), 14 * unit, theme.muted, "right")
            x -= text_width(self.style.note, 14 * unit) + 16 * unit
        out = self.episode.outcome
        if moment.captured and out.pursuer is not None and out.cell is not None:
            told = f"captured by robot {out.pursuer + 1} in cell {out.cell + 1}"
            surface.text(told, (x, y), 16 * unit, theme.evader, "right", bold=True)
        elif not out.captured and moment.time >= out.time - 1e-9:
            surface.text(out.status.value, (x, y), 16 * unit, theme.muted, "right", bold=True)


def draw_frame(episode: Episode, time: float, style: FrameStyle | None = None) -> Image:
    """Draw one frame; for many of the same episode make a :class:`FrameDrawer` once.

    Parameters
    ----------
    episode : Episode
        The record.
    time : float
        Seconds.
    style : FrameStyle, optional
        How it looks.

    Returns
    -------
    ndarray of uint8, shape (height, width, 3)
        Blue first.
    """
    return FrameDrawer(episode, style).draw(time)
