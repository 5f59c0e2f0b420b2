"""A finished picture: an image that shows itself in a notebook and saves itself; and that of a belief."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from discretize import CellMap
from geomsim.drawing.floor import Floor
from geomsim.drawing.legend import draw_colour_bar
from geomsim.drawing.moment import shares
from geomsim.drawing.playback import write_png
from geomsim.drawing.raster import Image, Raster, blank
from geomsim.drawing.scale import ProbabilityScale
from geomsim.drawing.theme import DrawingError, find_theme
from geomsim.drawing.viewport import Box

__all__ = ["Picture", "show_belief"]


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """An image.

    Attributes
    ----------
    image : ndarray of uint8, shape (height, width, 3)
        Blue first.
    """

    image: Image

    def save(self, path: str | Path) -> Path:
        """Write a PNG; GeomsimError if it cannot be written."""
        return write_png(self.image, Path(path))

    def _repr_png_(self) -> bytes:
        return bytes(cv2.imencode(".png", self.image)[1])


def show_belief(cells: CellMap, belief: NDArray[np.float64], *, width: int = 1000, theme: str = "light") -> Picture:
    """Draw where the evader may be.

    Parameters
    ----------
    cells : CellMap
        The cells.
    belief : ndarray, shape (N + 1,)
        Index 0 is the capture state.
    width : int
        Pixels; the height follows the plan.
    theme : str
        "light" or "dark".

    Raises
    ------
    DrawingError
        If the belief has another length.
    """
    if belief.shape != (len(cells) + 1,):
        raise DrawingError(f"A belief over {len(cells)} cells has {len(cells) + 1} numbers, not shape {belief.shape}.")
    colours = find_theme(theme)
    unit = width / 900
    x0, y0, x1, y1 = cells.plan.bounds
    margin, foot = round(8 * unit), round(62 * unit)
    high = round((width - 2 * margin) * float(np.clip((y1 - y0) / (x1 - x0), 0.2, 1.2)))
    surface = Raster(blank(width, high + margin + foot, colours.page))
    floor = Floor(cells, Box(margin, margin, width - margin, margin + high), colours, unit)
    scale = ProbabilityScale.of(belief[None])
    floor.paint(surface, colours.ramp[scale.steps(shares(belief))])
    top = margin + high + round(4 * unit)
    bar = Box(width - margin - round(300 * unit), top, width - margin - round(8 * unit), top + round(50 * unit))
    draw_colour_bar(surface, bar, scale, colours, unit, "chance that the evader is in a cell, if not captured")
    told = f"captured by now: {100 * belief[0]:.0f} %"
    surface.text(told, (margin, top + 26 * unit), 14 * unit, colours.text)
    return Picture(surface.image)
