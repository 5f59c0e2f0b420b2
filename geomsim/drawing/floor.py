"""The floor: everything of a cell map that does not move, drawn once, and its cells in any colours."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import cv2
import numpy as np
import shapely
from numpy.typing import NDArray

from discretize import CellMap
from geomsim.drawing.colours import bgr
from geomsim.drawing.raster import SHIFT, Image, Raster, fixed, spread
from geomsim.drawing.theme import Theme
from geomsim.drawing.viewport import Box, Viewport
from maps import FloorPlan

__all__ = ["Floor", "floor_view", "inner_boundaries", "label_image", "thin_walls"]

# Static parts are drawn this many times larger and averaged, which is anti-aliasing at its best.
_ZOOM = 4

# A gap this wide between two areas is a wall and filled, metres.
_THIN = 0.5


class Floor:
    """A cell map in a box of an image.

    Parameters
    ----------
    cells : CellMap
        What to draw.
    box : Box
        Where in the image.
    theme : Theme
        Colours.
    unit : float
        Pixels that a thin line takes.
    portals : bool
        Whether to mark the places to cross cell boundaries.

    Attributes
    ----------
    view : Viewport
        From metres to pixels of the whole image.
    unit : float
        Pixels that a thin line of the floor takes: less where cells are small.
    labels : ndarray of intp, shape (box.height, box.width)
        Number of the cell, from 1, at each pixel of the box; 0 where there is none.
    """

    def __init__(
        self,
        cells: CellMap,
        box: Box,
        theme: Theme,
        unit: float,
        *,
        portals: bool = True,
    ) -> None:
        self.box = box
        self._theme = theme
        self.view, self.unit = floor_view(cells, box, unit)
        unit = self.unit
        local = Viewport(self.view.scale, (self.view.origin[0] - box.left, self.view.origin[1] - box.top))
        shape = (box.height, box.width)
        self.labels = label_image(cells, local, shape)

        wall = _wall_cover(cells.plan, local, shape, 2.5 * unit, 1.5 * unit)
        self._is_wall = (wall > 0.5).astype(np.uint8)
        layers = [(_dot_cover(cells, local, shape, unit), theme.dots), (wall, theme.wall)]
        if portals:
            layers.insert(0, (_portal_cover(cells, local, shape, unit), theme.portal))
        self._keep, self._add = _flatten(layers)

    def paint(self, surface: Raster, colours: NDArray[np.uint8]) -> None:
        """Draw the floor into its box of an image.

        Parameters
        ----------
        surface : Raster
            Drawn on.
        colours : ndarray of uint8, shape (N, 3)
            Red, green and blue of each cell.
        """
        palette = np.zeros((len(colours) + 1, 4), dtype=np.uint8)
        palette[0, :3] = bgr(self._theme.page)
        palette[1:, :3] = colours[:, ::-1]
        pixels = np.take(palette.view(np.uint32).ravel(), self.labels, mode="clip").view(np.uint8)
        part = cv2.cvtColor(pixels.reshape(*self.labels.shape, 4), cv2.COLOR_BGRA2BGR)
        kept = cv2.multiply(part, self._keep, scale=1 / 255)
        surface.image[self.box.slices] = cv2.add(kept, self._add)

    def restore_walls(self, image: Image, painted: Image) -> None:
        """Copy the walls from a painted image to one on which something was drawn over them."""
        cv2.copyTo(painted[self.box.slices], self._is_wall, image[self.box.slices])


def floor_view(cells: CellMap, box: Box, unit: float) -> tuple[Viewport, float]:
    """Return how a cell map fits a box, and the pixels that a thin line of it takes: less where cells are small."""
    pad = int(np.ceil(2.5 * unit))  # the outer half of a wall's stroke needs room
    view = Viewport.fit(cells.plan.bounds, box.inset(pad, pad, pad, pad))
    cell = view.scale * float(np.sqrt(cells.plan.area / max(len(cells), 1)))
    return view, unit * float(np.clip(cell / (60.0 * unit), 0.4, 1.0))


def label_image(cells: CellMap, view: Viewport, shape: tuple[int, int]) -> NDArray[np.intp]:
    """Return the number of the cell, from 1, at each pixel, 0 where there is none."""
    labels = np.zeros(shape, dtype=np.int32)
    for number, cell in enumerate(cells.cells, start=1):
        cv2.fillPoly(labels, _rings(cell, view), (number,), cv2.LINE_8, SHIFT)
    # Rounding leaves a pixel here and there between two cells; walls cover what grows over the edge of the plan.
    grown = cv2.dilate(labels.astype(np.float32), np.ones((3, 3), np.uint8))
    return np.where(labels == 0, grown, labels).astype(np.intp)


def inner_boundaries(cells: CellMap) -> list[NDArray[np.float64]]:
    """Return the boundaries between cells that are no walls, as polylines in metres."""
    edges = shapely.union_all(shapely.boundary(np.array(cells.cells, dtype=object)))
    inner = shapely.difference(edges, cells.plan.space.boundary.buffer(2e-3))
    merged = shapely.get_parts(shapely.line_merge(inner))
    return [shapely.get_coordinates(g) for g in merged if g.length > 1e-2]


def thin_walls(plan: FloorPlan) -> shapely.Geometry:
    """Return what lies between areas of free space that are less than half a metre apart."""
    closed = plan.space.buffer(_THIN / 2, join_style="mitre").buffer(-_THIN / 2, join_style="mitre")
    return shapely.difference(closed, plan.space)


def _rings(area: shapely.Geometry, view: Viewport) -> list[NDArray[np.int32]]:
    rings = (ring for part in shapely.get_parts(area) for ring in shapely.get_rings(part))
    return [fixed(view.pixels(shapely.get_coordinates(ring))) for ring in rings]


def _cover(shape: tuple[int, int], draw: Callable[[NDArray[np.uint8]], None]) -> NDArray[np.float32]:
    """Return the share of each pixel, 0 to 1, that is drawn on a larger mask."""
    mask = np.zeros((shape[0] * _ZOOM, shape[1] * _ZOOM), dtype=np.uint8)
    draw(mask)
    part: NDArray[np.float32] = cv2.resize(mask, shape[::-1], interpolation=cv2.INTER_AREA) / np.float32(255)
    return part


def _wall_cover(
    plan: FloorPlan, view: Viewport, shape: tuple[int, int], edge: float, inner: float
) -> NDArray[np.float32]:
    """Walls are drawn mostly on their outer side, so that the free space shows its size; thin ones are filled."""
    rings = _rings(plan.space, view.zoomed(_ZOOM))
    thin = _rings(thin_walls(plan), view.zoomed(_ZOOM))

    def draw(mask: NDArray[np.uint8]) -> None:
        cv2.polylines(mask, rings, True, (255,), max(1, round(2 * edge * _ZOOM)), cv2.LINE_8, SHIFT)
        cv2.fillPoly(mask, thin, (255,), cv2.LINE_8, SHIFT)
        cv2.fillPoly(mask, rings, (0,), cv2.LINE_8, SHIFT)
        # What is left of a wall of no thickness:
        cv2.polylines(mask, rings, True, (255,), max(1, round(2 * inner * _ZOOM)), cv2.LINE_8, SHIFT)

    return _cover(shape, draw)


def _dot_cover(cells: CellMap, view: Viewport, shape: tuple[int, int], unit: float) -> NDArray[np.float32]:
    zoomed = view.zoomed(_ZOOM)
    centres = [spread(zoomed.pixels(path), 5.0 * unit * _ZOOM) for path in inner_boundaries(cells)]
    return _discs(shape, centres, 0.95 * unit * _ZOOM)


def _portal_cover(cells: CellMap, view: Viewport, shape: tuple[int, int], unit: float) -> NDArray[np.float32]:
    points = [view.zoomed(_ZOOM).pixels(portal.point)[None] for portal in cells.portals]
    return _discs(shape, points, 2.6 * unit * _ZOOM)


def _discs(shape: tuple[int, int], centres: Iterable[NDArray[np.float64]], radius: float) -> NDArray[np.float32]:
    def draw(mask: NDArray[np.uint8]) -> None:
        for group in centres:
            for x, y in fixed(group):
                cv2.circle(mask, (int(x), int(y)), round(radius * (1 << SHIFT)), (255,), -1, cv2.LINE_8, SHIFT)

    return _cover(shape, draw)


def _flatten(layers: list[tuple[NDArray[np.float32], str]]) -> tuple[Image, Image]:
    """Merge layers, the lowest first, into what each pixel keeps of the floor, of 255, and what is added to it."""
    keep = np.ones((*layers[0][0].shape, 1), dtype=np.float32)
    add = np.zeros((*layers[0][0].shape, 3), dtype=np.float32)
    for cover, colour in layers:
        left = 1.0 - cover[..., None]
        keep *= left
        add = add * left + cover[..., None] * np.array(bgr(colour), dtype=np.float32)
    kept = np.repeat(np.rint(255 * keep).astype(np.uint8), 3, axis=2)
    return kept, np.rint(add).astype(np.uint8)
