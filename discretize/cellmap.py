"""Cells, portals and the routes between checkpoints: what a discretiser returns."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray

from maps import FloorPlan
from maps.showing import svg_picture

__all__ = ["CellMap", "Portal", "graph_components"]

_SOFT = ("#ffdedc", "#fbe3c6", "#e0edcf", "#c8f1ed", "#d8e9ff", "#f4dffb")


@dataclass(frozen=True, slots=True)
class Portal:
    """The boundary segment that two cells share, where a robot can cross it.

    Attributes
    ----------
    cells : tuple of int
        The two cells, counted from 0, the smaller first.
    segment : ndarray, shape (2, 2)
        Ends of the shared segment, metres.
    point : ndarray, shape (2,)
        Where a body crosses: at least the body's radius from every wall, metres.
    legs : tuple of ndarray, each of shape (k, 2) with k >= 2
        Routes inside ``cells[0]`` and ``cells[1]`` from the cell's checkpoint to ``point``, metres. The last point
        but one is on the near side of the door, so that a body goes through it squarely and does not scrape a jamb.
    """

    cells: tuple[int, int]
    segment: NDArray[np.float64]
    point: NDArray[np.float64]
    legs: tuple[NDArray[np.float64], NDArray[np.float64]]

    @property
    def width(self) -> float:
        """Length of the shared segment, metres."""
        return float(np.hypot(*(self.segment[1] - self.segment[0])))


@dataclass(frozen=True)
class CellMap:
    """A floor plan cut into cells.

    Cells count from 0 here; people see cell ``k`` as number ``k + 1`` (0 is the capture state).

    Attributes
    ----------
    plan : FloorPlan
        What was cut.
    cells : tuple of shapely.Polygon
        N simple polygons that cover the free space and do not overlap.
    portals : tuple of Portal
        At most one for each pair of cells, in the order of ``Portal.cells``.
    checkpoints : ndarray, shape (N, 2)
        Where a robot in the cell plans anew: the centroid, or where a body cannot stand there the nearest place in
        the cell where it can; NaN for a cell that no body can enter. Metres.
    radius : float
        Radius of the largest body for which portals and routes hold, metres.
    method : str
        Name of the discretiser.
    names : tuple of str
        One for each cell, empty where the source has none.
    tolerance : float
        Share of its convex hull that a cell may lack by the promise of its method.
    strict : bool
        Whether a cell that lacks more is a problem, and not only to be told.
    notes : tuple of str
        What the method did otherwise than usual, a sentence each.
    """

    plan: FloorPlan
    cells: tuple[shapely.Polygon, ...]
    portals: tuple[Portal, ...]
    checkpoints: NDArray[np.float64]
    radius: float
    method: str
    names: tuple[str, ...]
    tolerance: float = 1.0
    strict: bool = False
    notes: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.cells)

    @cached_property
    def areas(self) -> NDArray[np.float64]:
        """Area of each cell, shape (N,), square metres."""
        return np.asarray(shapely.area(np.array(self.cells, dtype=object)), dtype=np.float64)

    @cached_property
    def edges(self) -> tuple[tuple[int, int], ...]:
        """Pairs of adjacent cells, counted from 0, sorted."""
        return tuple(portal.cells for portal in self.portals)

    @cached_property
    def components(self) -> NDArray[np.intp]:
        """Connected component of the graph for each cell, shape (N,), 0 the one with most area; -1: no body fits."""
        enterable = np.isfinite(self.checkpoints[:, 0])
        label = graph_components(len(self), self.edges, np.where(enterable, self.areas, 0.0))
        return np.where(enterable, label, -1)

    def locate(self, points: NDArray[np.float64]) -> NDArray[np.intp]:
        """Return the cell that contains each point, -1 where none does.

        Parameters
        ----------
        points : ndarray, shape (k, 2)
            Metres. A point on a boundary belongs to the cell with the smaller number.
        """
        found = np.full(len(points), len(self), dtype=np.intp)
        which, cell = self._tree.query(shapely.points(points), predicate="intersects")
        np.minimum.at(found, which, cell)
        return np.where(found == len(self), -1, found)

    def _repr_svg_(self) -> str:
        """Return a picture for a notebook: cells, walls and portals."""
        drawn: list[tuple[shapely.Geometry, str]] = [
            (cell, f'fill="{_SOFT[k % len(_SOFT)]}" stroke="#8a94a3" stroke-width="0.5"')
            for k, cell in enumerate(self.cells)
        ]
        drawn.append((self.plan.space, 'fill="none" stroke="#232a35" stroke-width="2"'))
        portals = shapely.MultiLineString([portal.segment for portal in self.portals])
        drawn.append((portals, 'fill="none" stroke="#00838f" stroke-width="2"'))
        return svg_picture(drawn, self.plan.bounds)

    @cached_property
    def _tree(self) -> shapely.STRtree:
        return shapely.STRtree(list(self.cells))


def graph_components(n: int, pairs: Sequence[tuple[int, int]], area: NDArray[np.float64]) -> NDArray[np.intp]:
    """Label the connected components of a graph, shape (n,), 0 the one with most area.

    Parameters
    ----------
    n : int
        Number of vertices.
    pairs : sequence of pairs of int
        Edges, vertices counted from 0.
    area : ndarray, shape (n,)
        Of each vertex, square metres.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    i, j = np.array(pairs, dtype=np.intp).reshape(-1, 2).T
    _, label = connected_components(coo_array((np.ones(len(i)), (i, j)), shape=(n, n)), directed=False)
    total = np.bincount(label, weights=area)
    rank = np.empty(len(total), dtype=np.intp)
    rank[np.argsort(-total, kind="stable")] = np.arange(len(total))
    return rank[label]
