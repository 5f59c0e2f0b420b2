"""A contact sheet of a pursuit: the plan at chosen times, as in a paper."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from geomsim.drawing.figures import Figures
from geomsim.drawing.floor import Floor
from geomsim.drawing.legend import draw_colour_bar, draw_scale_bar
from geomsim.drawing.moment import Timeline, shares
from geomsim.drawing.playback import write_png
from geomsim.drawing.raster import Image, Raster, blank
from geomsim.drawing.scale import ProbabilityScale
from geomsim.drawing.surface import Surface
from geomsim.drawing.theme import DrawingError, Theme, find_theme
from geomsim.drawing.vector import VectorSheet, is_vector
from geomsim.drawing.vectorfloor import VectorFloor
from geomsim.drawing.viewport import Box, Viewport
from geomsim.episode import Episode

__all__ = ["draw_snapshots", "snapshot_times", "write_snapshots"]

AnySurface = TypeVar("AnySurface", bound=Surface)

# A sheet that is this many times as wide as high suits a page.
_ASPECT = 1.4


def write_snapshots(
    episode: Episode,
    path: Path,
    *,
    times: Sequence[float] | None = None,
    panels: int = 6,
    width: int = 2400,
    theme: str = "light",
) -> Path:
    """Write a contact sheet as ``.png``, ``.svg`` or ``.pdf``; see :func:`draw_snapshots` for the options.

    Raises
    ------
    GeomsimError
        If an option is out of range or the file cannot be written.
    """
    if not is_vector(path):
        return write_png(draw_snapshots(episode, times=times, panels=panels, width=width, theme=theme), path)
    layout = _Layout.of(episode, snapshot_times(episode, times, panels), width)
    colours = find_theme(theme)
    sheet = VectorSheet(layout.width, layout.height, colours.page)
    floor = VectorFloor(episode.cells, layout.panel, colours, 0.8 * layout.unit, portals=False)
    _draw_sheet(sheet, episode, layout, colours, floor.view, floor.paint)
    return sheet.save(path)


def draw_snapshots(
    episode: Episode,
    *,
    times: Sequence[float] | None = None,
    panels: int = 6,
    width: int = 2400,
    theme: str = "light",
) -> Image:
    """Draw an episode at several times on one sheet, each with walls, cell boundaries, belief, robots and evader.

    Parameters
    ----------
    episode : Episode
        The record.
    times : sequence of float, optional
        Seconds, one panel each. By default evenly spread from start to end.
    panels : int
        How many, where ``times`` is not given.
    width : int
        Width of the sheet, pixels.
    theme : str
        "light" or "dark".

    Returns
    -------
    ndarray of uint8, shape (height, width, 3)
        Blue first.

    Raises
    ------
    DrawingError
        If a time is outside the episode or there is nothing to draw.
    """
    layout = _Layout.of(episode, snapshot_times(episode, times, panels), width)
    colours = find_theme(theme)
    sheet = Raster(blank(layout.width, layout.height, colours.page))
    floor = Floor(episode.cells, layout.panel, colours, 0.8 * layout.unit, portals=False)
    _draw_sheet(sheet, episode, layout, colours, floor.view, floor.paint)
    return sheet.image


@dataclass(frozen=True, slots=True)
class _Layout:
    """Where things are on a sheet, in pixels; ``panel`` is the box of the plan within each part of the sheet.

    A part is larger than its plan by a border, for robots that stand at the outer walls.
    """

    times: list[float]
    width: int
    height: int
    unit: float
    panel: Box
    corners: list[tuple[int, int]]

    @classmethod
    def of(cls, episode: Episode, times: list[float], width: int) -> _Layout:
        x0, y0, x1, y1 = episode.plan.bounds
        columns = _columns(len(times), (x1 - x0) / (y1 - y0))
        rows = math.ceil(len(times) / columns)
        unit = width / 850
        border, caption, foot = round(10 * unit), round(16 * unit), round(68 * unit)
        part = width // columns
        wide = part - 2 * border
        high = min(round(wide * (y1 - y0) / (x1 - x0)), 4 * wide)
        places = [divmod(k, columns) for k in range(len(times))]
        row_height = high + 2 * border + caption
        corners = [(column * part, row * row_height) for row, column in places]
        panel = Box(border, border, border + wide, border + high)
        return cls(times, width, rows * row_height + foot, unit, panel, corners)


def _draw_sheet(
    sheet: AnySurface,
    episode: Episode,
    layout: _Layout,
    colours: Theme,
    view: Viewport,
    paint: Callable[[AnySurface, NDArray[np.uint8]], None],
) -> None:
    unit, panel = layout.unit, layout.panel
    scale = ProbabilityScale.of(episode.beliefs)
    figures = Figures(view, colours, 0.85 * unit)
    timeline = Timeline(episode)
    for time, (left, top) in zip(layout.times, layout.corners, strict=True):
        moment = timeline.at(time)
        part = sheet.part(Box(left, top, left + panel.right + panel.left, top + panel.bottom + panel.top))
        paint(part, colours.ramp[scale.steps(shares(episode.beliefs[moment.step]))])
        team = range(len(moment.pursuers))
        for r in team:
            figures.trail(part, r, moment.trails[r])
        told = f"t = {time:.1f} s"
        by = episode.outcome.pursuer
        if moment.captured and by is not None:
            figures.spotting(part, moment.pursuers[by], moment.evaders[episode.outcome.evader])
            told += f" · captured by P{by + 1}"
        figures.bodies(part, moment, prefix="P", last=-1 if by is None else by)
        at = (left + panel.left + panel.width / 2, top + panel.bottom + panel.top + 4 * unit)
        sheet.text(told, at, 13 * unit, colours.text, "centre")

    margin, top = round(10 * unit), layout.height - round(52 * unit)
    right = layout.width - margin - round(8 * unit)
    bar = Box(right - round(292 * unit), top, right, layout.height)
    draw_colour_bar(sheet, bar, scale, colours, unit, "chance that the evader is in a cell, if not captured")
    metres = Box(margin, top, margin + round(200 * unit), top + round(32 * unit))
    draw_scale_bar(sheet, metres, view.scale, colours, unit)


def snapshot_times(episode: Episode, times: Sequence[float] | None, panels: int) -> list[float]:
    """Return the times to show: those given, or evenly spread ones.

    Raises
    ------
    DrawingError
        If a time is outside the episode or there is none.
    """
    end = float(episode.times[-1])
    if times is None:
        if not 1 <= panels <= 60:
            raise DrawingError(f"A contact sheet has 1 to 60 panels, not {panels}.")
        return [float(t) for t in np.unique(np.linspace(0.0, end, panels))] if panels > 1 else [end]
    if not times:
        raise DrawingError("A contact sheet needs at least one time.")
    for time in times:
        if not 0 <= time <= end + 1e-6:
            raise DrawingError(f"There is no snapshot at {time:g} s: the episode lasts from 0 to {end:.1f} s.")
    return [min(float(t), end) for t in times]


def _columns(panels: int, aspect: float) -> int:
    """Choose how many panels stand side by side, so that the sheet suits a page and few places stay empty."""

    def misfit(columns: int) -> float:
        rows = math.ceil(panels / columns)
        return abs(math.log(columns * aspect / rows / _ASPECT)) + 0.5 * (rows * columns - panels)

    return min(range(1, panels + 1), key=misfit)
