"""Where pursuers go: the ways between checkpoints, drawn on a map of cells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from discretize import CellMap
from maps import nearest
from planners.graph import GraphError, SearchGraph

__all__ = ["CHECKPOINTS", "Roads"]

CHECKPOINTS = {
    "centroids": "the centroid of every cell",
    "boundaries": "the centroid of every cell and every place where a robot passes from cell to cell",
}
"""Where robots may decide anew (Section IV-C)."""


@dataclass(frozen=True, slots=True, eq=False)
class Roads:
    """A graph of checkpoints with its geometry.

    Checkpoint ``c`` below the number of cells is that of cell ``c``; those above are portals, in the order of the map.

    Attributes
    ----------
    graph : SearchGraph
        V checkpoints and the ways between them, E of them with both directions. A way counts as in the cell of its
        second checkpoint from ``leave`` metres on.
    points : ndarray, shape (V, 2)
        Where the checkpoints are, metres; NaN for a cell that no body can enter.
    cell : ndarray of intp, shape (V,)
        Cell in which each checkpoint counts; a portal, like any place on a boundary, in that of the smaller number.
    lines : tuple of ndarray, length E
        The ways as polylines, each from its first checkpoint to its second, metres.
    """

    graph: SearchGraph
    points: NDArray[np.float64]
    cell: NDArray[np.intp]
    lines: tuple[NDArray[np.float64], ...]

    @classmethod
    def of(cls, cells: CellMap, checkpoints: str = "centroids") -> Roads:
        """Make the roads of a map.

        Parameters
        ----------
        cells : CellMap
            The map.
        checkpoints : str
            A name in :data:`CHECKPOINTS`.

        Raises
        ------
        GraphError
            If there are no such checkpoints.
        """
        if checkpoints not in CHECKPOINTS:
            raise GraphError(f"There are no checkpoints {checkpoints!r}; {nearest(checkpoints, CHECKPOINTS)}")
        n = len(cells)
        if checkpoints == "centroids":
            graph = SearchGraph.from_cells(cells)
            whole = {p.cells: np.concatenate([p.legs[0], p.legs[1][-2::-1]]) for p in cells.portals}
            return cls(graph, cells.checkpoints, np.arange(n), _both_ways(graph, whole))
        legs = {(c, n + k): leg for k, p in enumerate(cells.portals) for c, leg in zip(p.cells, p.legs, strict=True)}
        portals = np.array([portal.cells[0] for portal in cells.portals], dtype=np.intp)
        at = np.array([portal.point for portal in cells.portals]).reshape(-1, 2)
        lengths = np.array([[_length(leg), 0.0] for leg in legs.values()]).reshape(-1, 2)
        area = np.concatenate([cells.areas, np.zeros(len(portals))])
        part = np.concatenate([cells.components, cells.components[portals]])
        graph = SearchGraph._build(list(legs), lengths, area, part)
        points = np.concatenate([cells.checkpoints, at])
        return cls(graph, points, np.concatenate([np.arange(n), portals]), _both_ways(graph, legs))

    @property
    def tails(self) -> NDArray[np.intp]:
        """First checkpoint of each way, shape (E,); the second ones are ``graph.indices``."""
        return np.repeat(np.arange(len(self.graph)), self.graph.degree)


def _both_ways(
    graph: SearchGraph, lines: dict[tuple[int, int], NDArray[np.float64]]
) -> tuple[NDArray[np.float64], ...]:
    tails = np.repeat(np.arange(len(graph)), graph.degree)
    ends = zip(tails.tolist(), graph.indices.tolist(), strict=True)
    return tuple(lines[a, b] if (a, b) in lines else lines[b, a][::-1] for a, b in ends)


def _length(line: NDArray[np.float64]) -> float:
    return float(np.hypot(*np.diff(line, axis=0).T).sum())
