"""The graph that pursuers search: arrays only, from cells or straight from an edge list."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from discretize import CellMap, graph_components
from maps import GeomsimError

__all__ = ["GraphError", "SearchGraph"]


class GraphError(GeomsimError):
    """A graph, cell number or start that cannot be searched."""


@dataclass(frozen=True, slots=True)
class SearchGraph:
    """N cells and the ways between them, in compressed sparse rows.

    Cells count from 0. The neighbours of cell ``i`` are ``indices[indptr[i]:indptr[i + 1]]``, in rising order.

    Attributes
    ----------
    indptr : ndarray of intp, shape (N + 1,)
        Where the neighbours of each cell begin.
    indices : ndarray of intp, shape (E,)
        Neighbours; every edge is there twice, once from each end.
    leave : ndarray, shape (E,)
        Way from the checkpoint of the cell to the portal, metres (a graph without geometry: one half).
    arrive : ndarray, shape (E,)
        Way from the portal to the checkpoint of the neighbour, metres (a graph without geometry: one half).
    area : ndarray, shape (N,)
        Square metres (a graph without geometry: ones).
    component : ndarray of intp, shape (N,)
        Connected component of each cell, the one with most area first; -1 for a cell that no robot can enter.
    """

    indptr: NDArray[np.intp]
    indices: NDArray[np.intp]
    leave: NDArray[np.float64]
    arrive: NDArray[np.float64]
    area: NDArray[np.float64]
    component: NDArray[np.intp]

    def __len__(self) -> int:
        return len(self.area)

    @property
    def degree(self) -> NDArray[np.intp]:
        """Number of neighbours of each cell, shape (N,)."""
        return np.diff(self.indptr)

    @property
    def length(self) -> NDArray[np.float64]:
        """Way from checkpoint to checkpoint along each edge, shape (E,), metres."""
        return self.leave + self.arrive

    def neighbours(self, cell: int) -> NDArray[np.intp]:
        """Cells next to a cell, in rising order."""
        return self.indices[self.indptr[cell] : self.indptr[cell + 1]]

    def edge(self, cell: int, neighbour: int) -> int:
        """Index of an edge into ``indices``, ``leave`` and ``arrive``; GraphError where there is none."""
        row = self.neighbours(cell)
        k = int(np.searchsorted(row, neighbour))
        if k == len(row) or row[k] != neighbour:
            raise GraphError(f"Cells {cell + 1} and {neighbour + 1} are not next to each other.")
        return int(self.indptr[cell]) + k

    @classmethod
    def from_cells(cls, cells: CellMap) -> SearchGraph:
        """Make the graph of a cell map; ways are the lengths of its routes."""

        def length(leg: NDArray[np.float64]) -> float:
            return float(np.hypot(*np.diff(leg, axis=0).T).sum())

        legs = np.array([[length(leg) for leg in portal.legs] for portal in cells.portals]).reshape(-1, 2)
        return cls._build(cells.edges, legs, cells.areas, cells.components)

    @classmethod
    def from_edges(cls, vertices: int, edges: Iterable[Sequence[int]]) -> SearchGraph:
        """Make a graph without geometry: every edge has length 1, every cell area 1.

        Parameters
        ----------
        vertices : int
            Number of cells.
        edges : iterable of pairs of int
            Cells counted from 0; each edge once, in any order and direction.

        Raises
        ------
        GraphError
            If an edge names a cell that does not exist, joins a cell to itself or is there twice.
        """
        pairs: list[tuple[int, int]] = []
        for a, b in edges:
            if not (0 <= a < vertices and 0 <= b < vertices):
                raise GraphError(f"Edge ({a}, {b}) names a vertex outside 0 to {vertices - 1}.")
            if a == b:
                raise GraphError(f"Edge ({a}, {b}) joins a vertex to itself.")
            pairs.append((min(a, b), max(a, b)))
        if len(set(pairs)) != len(pairs):
            twice = next(p for i, p in enumerate(pairs) if p in pairs[:i])
            raise GraphError(f"Edge {twice} is there twice.")
        ones = np.ones(vertices)
        component = graph_components(vertices, pairs, ones)
        return cls._build(pairs, np.full((len(pairs), 2), 0.5), ones, component)

    @classmethod
    def _build(
        cls,
        pairs: Sequence[tuple[int, int]],
        legs: NDArray[np.float64],
        area: NDArray[np.float64],
        component: NDArray[np.intp],
    ) -> SearchGraph:
        i, j = np.array(pairs, dtype=np.intp).reshape(-1, 2).T
        tail, head = np.concatenate([i, j]), np.concatenate([j, i])
        leave, arrive = np.concatenate([legs[:, 0], legs[:, 1]]), np.concatenate([legs[:, 1], legs[:, 0]])
        order = np.lexsort((head, tail))
        indptr = np.concatenate([[0], np.cumsum(np.bincount(tail, minlength=len(area)))]).astype(np.intp)
        arrays = (indptr, head[order], leave[order], arrive[order], area.copy(), component.copy())
        for array in arrays:
            array.setflags(write=False)
        return cls(*arrays)
