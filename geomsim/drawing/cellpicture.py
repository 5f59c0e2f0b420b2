"""The discretisation as a picture: cells, their numbers, portals, the graph of routes, repairs in red."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize import CellMap
from geomsim.drawing.colours import mixed, ramp
from geomsim.drawing.floor import Floor
from geomsim.drawing.legend import draw_scale_bar
from geomsim.drawing.playback import write_png
from geomsim.drawing.strokes import Image, blank, disc, line, tint
from geomsim.drawing.text import draw_text, text_width
from geomsim.drawing.theme import Theme, find_theme
from geomsim.drawing.viewport import Box, Viewport
from maps import FloorPlan

__all__ = ["draw_cells", "write_cells_picture"]

_HUES = (20.0, 75.0, 125.0, 190.0, 250.0, 315.0)


def write_cells_picture(cells: CellMap, path: Path, *, width: int | None = None, theme: str = "light") -> Path:
    """Write the picture of :func:`draw_cells` as PNG; GeomsimError if it cannot be written."""
    return write_png(draw_cells(cells, width=width, theme=theme), path)


def draw_cells(cells: CellMap, *, width: int | None = None, theme: str = "light") -> Image:
    """Draw a cell map: cells in soft colours with numbers from 1 where there is room, portals, routes and repairs.

    Parameters
    ----------
    cells : CellMap
        What to draw.
    width : int, optional
        Pixels, by default 1600 to 3200, more for more cells; the height follows the plan.
    theme : str
        "light" or "dark".

    Returns
    -------
    ndarray of uint8, shape (height, width, 3)
        Blue first.
    """
    colours = find_theme(theme)
    if width is None:
        width = round(float(np.clip(1600 * np.sqrt(len(cells) / 300), 1600, 3200)))
    unit = 1.25 * float(np.sqrt(width / 1600))
    x0, y0, x1, y1 = cells.plan.bounds
    margin, header = round(16 * unit), round(46 * unit)
    tall = float(np.clip((y1 - y0) / (x1 - x0), 0.3, 1.2))
    box = Box(margin, header, width - margin, header + round((width - 2 * margin) * tall))
    image = blank(width, box.bottom + margin, colours.page)
    floor = Floor(cells, box, colours, unit)
    floor.paint(image, _soft_colours(cells, colours))
    _draw_routes(image, cells, floor.view, colours, floor.unit)
    _draw_repairs(image, cells.plan, floor.view, colours, floor.unit)
    _draw_numbers(image, cells, floor.view, colours, unit)
    _draw_header(image, cells, floor.view, colours, unit)
    return image


def _soft_colours(cells: CellMap, theme: Theme) -> NDArray[np.uint8]:
    """Choose for each cell the colour that its neighbours use least; cells that no body can enter stay grey."""
    light, chroma = (0.93, 0.045) if theme.name == "light" else (0.36, 0.05)
    soft = np.concatenate([ramp((light, light), (chroma, chroma), (hue, hue), 1) for hue in _HUES])
    grey = ramp((light - 0.08, light), (0.0, 0.0), (0.0, 0.0), 1)[0]
    around: list[list[int]] = [[] for _ in range(len(cells))]
    tree = shapely.STRtree(list(cells.cells))
    for a, b in tree.query(list(cells.cells), predicate="dwithin", distance=0.3).T:
        if a != b:
            around[a].append(int(b))
    chosen = np.full(len(cells), -1)
    for cell in range(len(cells)):
        used = np.bincount([chosen[n] for n in around[cell] if chosen[n] >= 0], minlength=len(soft))
        # Starting elsewhere each time spreads the colours over the plan.
        chosen[cell] = (np.argmin(np.roll(used, -cell)) + cell) % len(soft)
    enterable = np.isfinite(cells.checkpoints[:, :1])
    picked: NDArray[np.uint8] = np.where(enterable, soft[chosen], grey)
    return picked


def _draw_routes(image: Image, cells: CellMap, view: Viewport, theme: Theme, unit: float) -> None:
    colour = mixed(theme.muted, theme.page, 0.15)
    for portal in cells.portals:
        for leg in portal.legs:
            line(image, view.pixels(leg), colour, max(1, round(1.2 * unit)))
    for portal in cells.portals:
        line(image, view.pixels(portal.segment), theme.curve, max(1, round(2.2 * unit)))


def _draw_numbers(image: Image, cells: CellMap, view: Viewport, theme: Theme, unit: float) -> None:
    """Put each number on its checkpoint, as large as the cell has room for, else a dot."""
    for k, (cell, checkpoint) in enumerate(zip(cells.cells, cells.checkpoints, strict=True)):
        if not np.isfinite(checkpoint[0]):
            continue
        room = view.scale * float(shapely.distance(cell.exterior, shapely.Point(checkpoint)))
        centre = view.pixels(checkpoint)
        text = str(k + 1)
        for size in (15 * unit, 12 * unit, 10 * unit):
            radius = max(0.5 * text_width(text, size, True), 0.42 * size) + 2.5 * unit
            if radius <= room:
                disc(image, centre, radius + unit, theme.muted)
                disc(image, centre, radius, theme.page)
                draw_text(image, text, (centre[0] + 0.5, centre[1]), size, theme.text, "centre", bold=True)
                break
        else:
            disc(image, centre, min(2.2 * unit, max(room, 1.2 * unit)), theme.text)


def _draw_repairs(image: Image, plan: FloorPlan, view: Viewport, theme: Theme, unit: float) -> None:
    thick = max(1, round(1.6 * unit))
    for repair in plan.repairs:
        for part in shapely.get_parts(repair.geometry):
            pixels = view.pixels(shapely.get_coordinates(part))
            if isinstance(part, shapely.Polygon):
                outline = view.pixels(shapely.get_coordinates(part.exterior))
                tint(image, outline, theme.repair, 0.35)
                line(image, outline, theme.repair, thick, closed=True)
            elif isinstance(part, shapely.Point):
                disc(image, pixels[0], 3 * unit, theme.repair)
            else:
                line(image, pixels, theme.repair, thick)


def _draw_header(image: Image, cells: CellMap, view: Viewport, theme: Theme, unit: float) -> None:
    at = (16 * unit, 23 * unit)
    name = cells.plan.name
    draw_text(image, name, at, 20 * unit, theme.text, bold=True)
    x = at[0] + text_width(name, 20 * unit, True) + 14 * unit
    told = f"{len(cells)} cells · {len(cells.portals)} portals · {cells.plan.area:.0f} m² · {cells.method}"
    draw_text(image, told, (x, at[1] + unit), 14 * unit, theme.muted)
    if cells.plan.repairs:
        x += text_width(told, 14 * unit) + 14 * unit
        count = len(cells.plan.repairs)
        draw_text(image, f"{count} repair{'s' * (count != 1)} in red", (x, at[1] + unit), 14 * unit, theme.repair)
    right = image.shape[1] - round(16 * unit)
    place = Box(right - round(300 * unit), 0, right - round(50 * unit), round(31 * unit))
    draw_scale_bar(image, place, view.scale, theme, unit)
