"""The floor as vectors: the same look as :class:`geomsim.drawing.floor.Floor`, made of strokes."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize import CellMap
from geomsim.drawing.colours import hex_colour
from geomsim.drawing.floor import floor_view, inner_boundaries, thin_walls
from geomsim.drawing.surface import Surface
from geomsim.drawing.theme import Theme
from geomsim.drawing.viewport import Box

__all__ = ["VectorFloor"]


class VectorFloor:
    """A cell map in a box of any surface.

    Parameters
    ----------
    cells, box, theme, unit, portals
        As for :class:`~geomsim.drawing.floor.Floor`.
    """

    def __init__(self, cells: CellMap, box: Box, theme: Theme, unit: float, *, portals: bool = True) -> None:
        self.view, self.unit = floor_view(cells, box, unit)
        self._theme = theme
        self._space = self._rings(cells.plan.space)
        self._thin = self._rings(thin_walls(cells.plan))
        self._cells = [self._rings(cell) for cell in cells.cells]
        self._dotted = [self.view.pixels(path) for path in inner_boundaries(cells)]
        self._portals = [self.view.pixels(portal.point) for portal in cells.portals] if portals else []

    def paint(self, surface: Surface, colours: NDArray[np.uint8]) -> None:
        """Draw the floor.

        Parameters
        ----------
        surface : Surface
            Drawn on.
        colours : ndarray of uint8, shape (N, 3)
            Red, green and blue of each cell.
        """
        theme, unit = self._theme, self.unit
        for ring in self._space:
            surface.line(ring, theme.wall, 5.0 * unit, closed=True)
        if self._thin:
            surface.polygon(self._thin, theme.wall)
        for rings, colour in zip(self._cells, colours, strict=True):
            surface.polygon(rings, hex_colour(colour), seam=0.5 * unit)
        for portal in self._portals:
            surface.disc(portal, 2.6 * unit, theme.portal)
        surface.dotted(self._dotted, theme.dots, 1.9 * unit, 5.0 * unit)
        for ring in self._space:
            surface.line(ring, theme.wall, 3.0 * unit, closed=True)

    def _rings(self, area: shapely.Geometry) -> list[NDArray[np.float64]]:
        parts = [part for part in shapely.get_parts(area) if isinstance(part, shapely.Polygon)]
        return [self.view.pixels(shapely.get_coordinates(ring)[:-1]) for ring in shapely.get_rings(parts)]
