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
from geomsim.drawing.raster import Image, Raster, blank
from geomsim.drawing.surface import Surface
from geomsim.drawing.text import cut_text, text_width
from geomsim.drawing.theme import Theme, find_theme
from geomsim.drawing.vector import VectorSheet, is_vector
from geomsim.drawing.vectorfloor import VectorFloor
from geomsim.drawing.viewport import Box, Viewport
from maps import FloorPlan

__all__ = ["draw_cells", "write_cells_picture"]

#: height of the line of text above the plan, thin lines
_HEADER = 46

_HUES = (20.0, 75.0, 125.0, 190.0, 250.0, 315.0)


def write_cells_picture(cells: CellMap, path: Path, *, width: int | None = None, theme: str = "light") -> Path:
    """Write the picture of :func:`draw_cells` as ``.png``, ``.svg`` or ``.pdf``.

    Raises
    ------
    GeomsimError
        If it cannot be written.
    """
    if not is_vector(path):
        return write_png(draw_cells(cells, width=width, theme=theme), path)
    colours = find_theme(theme)
    wide, high, unit, box = _layout(cells, width)
    sheet = VectorSheet(wide, high, colours.page)
    floor = VectorFloor(cells, box, colours, unit)
    floor.paint(sheet, _soft_colours(cells, colours))
    _draw_over(sheet, cells, floor.view, colours, unit, floor.unit, (wide, high))
    return sheet.save(path)


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
    wide, high, unit, box = _layout(cells, width)
    surface = Raster(blank(wide, high, colours.page))
    floor = Floor(cells, box, colours, unit)
    floor.paint(surface, _soft_colours(cells, colours))
    _draw_over(surface, cells, floor.view, colours, unit, floor.unit, (wide, high))
    return surface.image


def _layout(cells: CellMap, width: int | None) -> tuple[int, int, float, Box]:
    """Return width and height of the picture, the pixels that a thin line takes, and the box of the plan."""
    if width is None:
        width = round(float(np.clip(1600 * np.sqrt(len(cells) / 300), 1600, 3200)))
    unit = 1.25 * float(np.sqrt(width / 1600))
    x0, y0, x1, y1 = cells.plan.bounds
    margin, header = round(16 * unit), round(_HEADER * unit)
    tall = float(np.clip((y1 - y0) / (x1 - x0), 0.3, 1.2))
    box = Box(margin, header, width - margin, header + round((width - 2 * margin) * tall))
    return width, box.bottom + margin, unit, box


def _draw_over(
    surface: Surface, cells: CellMap, view: Viewport, theme: Theme, unit: float, fine: float, size: tuple[int, int]
) -> None:
    """Draw what lies above the floor; ``fine`` is the unit of lines among cells."""
    _draw_routes(surface, cells, view, theme, fine)
    # Rays of a scan may reach far beyond the plan, but never into the header.
    header = round(_HEADER * unit)
    below = surface.part(Box(0, header, *size))
    _draw_repairs(below, cells.plan, Viewport(view.scale, (view.origin[0], view.origin[1] - header)), theme, fine)
    _draw_numbers(surface, cells, view, theme, unit)
    _draw_header(surface, cells, view, theme, unit, size[0])


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


def _draw_routes(surface: Surface, cells: CellMap, view: Viewport, theme: Theme, unit: float) -> None:
    colour = mixed(theme.muted, theme.page, 0.15)
    for portal in cells.portals:
        for leg in portal.legs:
            surface.line(view.pixels(leg), colour, 1.2 * unit)
    for portal in cells.portals:
        surface.line(view.pixels(portal.segment), theme.curve, 2.2 * unit)


def _draw_numbers(surface: Surface, cells: CellMap, view: Viewport, theme: Theme, unit: float) -> None:
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
                surface.disc(centre, radius + unit, theme.muted)
                surface.disc(centre, radius, theme.page)
                surface.text(text, (centre[0] + 0.5, centre[1]), size, theme.text, "centre", bold=True)
                break
        else:
            surface.disc(centre, min(2.2 * unit, max(room, 1.2 * unit)), theme.text)


def _draw_repairs(surface: Surface, plan: FloorPlan, view: Viewport, theme: Theme, unit: float) -> None:
    thick = 1.2 * unit
    for repair in plan.repairs:
        for part in shapely.get_parts(repair.geometry):
            pixels = view.pixels(shapely.get_coordinates(part))
            if isinstance(part, shapely.Polygon):
                outline = view.pixels(shapely.get_coordinates(part.exterior))
                surface.tint(outline, theme.repair, 0.35)
                surface.line(outline, theme.repair, thick, closed=True)
            elif isinstance(part, shapely.Point):
                surface.disc(pixels[0], 1.8 * unit, theme.repair)
            else:
                surface.line(pixels, theme.repair, thick)


def _draw_header(surface: Surface, cells: CellMap, view: Viewport, theme: Theme, unit: float, width: int) -> None:
    at = (16 * unit, 23 * unit)
    name = cut_text(cells.plan.name, 0.3 * width, 20 * unit, bold=True)
    surface.text(name, at, 20 * unit, theme.text, bold=True)
    x = at[0] + text_width(name, 20 * unit, True) + 14 * unit
    told = f"{len(cells)} cells · {len(cells.portals)} portals · {cells.plan.area:.0f} m² · {cells.method}"
    surface.text(told, (x, at[1] + unit), 14 * unit, theme.muted)
    if cells.plan.repairs:
        x += text_width(told, 14 * unit) + 14 * unit
        count = len(cells.plan.repairs)
        surface.text(f"{count} repair{'s' * (count != 1)} in red", (x, at[1] + unit), 14 * unit, theme.repair)
    right = width - round(16 * unit)
    place = Box(right - round(300 * unit), 0, right - round(50 * unit), round(31 * unit))
    draw_scale_bar(surface, place, view.scale, theme, unit)
