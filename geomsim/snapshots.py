"""A contact sheet of a pursuit: the plan at chosen times, as in a paper."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from geomsim.drawing.figures import Figures
from geomsim.drawing.floor import Floor
from geomsim.drawing.legend import draw_colour_bar, draw_scale_bar
from geomsim.drawing.moment import Timeline, shares
from geomsim.drawing.playback import write_png
from geomsim.drawing.scale import ProbabilityScale
from geomsim.drawing.strokes import Image, blank
from geomsim.drawing.text import draw_text
from geomsim.drawing.theme import DrawingError, find_theme
from geomsim.drawing.viewport import Box
from geomsim.episode import Episode

__all__ = ["draw_snapshots", "snapshot_times", "write_snapshots"]

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
    """Write a contact sheet as PNG; see :func:`draw_snapshots` for the options.

    Raises
    ------
    GeomsimError
        If an option is out of range or the file cannot be written.
    """
    if path.suffix.lower() != ".png":
        raise DrawingError(f"A contact sheet's name must end in .png, but is {path.name!r}.")
    return write_png(draw_snapshots(episode, times=times, panels=panels, width=width, theme=theme), path)


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
    chosen = snapshot_times(episode, times, panels)
    colours = find_theme(theme)
    x0, y0, x1, y1 = episode.plan.bounds
    columns = _columns(len(chosen), (x1 - x0) / (y1 - y0))
    rows = math.ceil(len(chosen) / columns)
    unit = width / 850
    margin, gap, caption, foot = round(10 * unit), round(16 * unit), round(24 * unit), round(58 * unit)
    panel_width = (width - 2 * margin - (columns - 1) * gap) // columns
    panel_height = round(panel_width * (y1 - y0) / (x1 - x0))
    panel_height = min(panel_height, 4 * panel_width)
    sheet = blank(width, 2 * margin + rows * (panel_height + caption) + foot, colours.page)

    scale = ProbabilityScale.of(episode.beliefs)
    box = Box(0, 0, panel_width, panel_height)
    floor = Floor(episode.cells, box, colours, 0.8 * unit, portals=False)
    figures = Figures(floor.view, colours, 0.85 * unit)
    timeline = Timeline(episode)
    for k, time in enumerate(chosen):
        left = margin + (k % columns) * (panel_width + gap)
        top = margin + (k // columns) * (panel_height + caption)
        panel = sheet[top : top + panel_height, left : left + panel_width]
        moment = timeline.at(time)
        floor.paint(panel, colours.ramp[scale.steps(shares(episode.beliefs[moment.step]))])
        team = range(len(moment.pursuers))
        for r in team:
            figures.trail(panel, r, moment.trails[r])
        by = episode.outcome.pursuer
        if moment.captured and by is not None:
            figures.spotting(panel, moment.pursuers[by], moment.evader)
        figures.evader(panel, moment.evader, captured=moment.captured)
        for r in team:
            figures.robot(panel, r, moment.pursuers[r], float(moment.headings[r]), prefix="P")
        told = f"t = {time:.1f} s"
        if moment.captured and by is not None:
            told += f" · captured by P{by + 1}"
        at = (left + panel_width / 2, top + panel_height + 12 * unit)
        draw_text(sheet, told, at, 13 * unit, colours.text, "centre")

    bottom = Box(margin, sheet.shape[0] - foot + round(6 * unit), width - margin, sheet.shape[0] - margin // 2)
    bar = Box(bottom.right - round(300 * unit), bottom.top, bottom.right - round(8 * unit), bottom.bottom)
    title = "chance that the evader is in a cell, if not captured"
    draw_colour_bar(sheet, bar, scale, colours, unit, title)
    metres = Box(bottom.left, bottom.top, bottom.left + round(200 * unit), bottom.top + round(32 * unit))
    draw_scale_bar(sheet, metres, floor.view.scale, colours, unit)
    return sheet


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
        return [float(t) for t in np.linspace(0.0, end, panels)] if panels > 1 else [end]
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
