"""Walls on a grid, for rays by the million."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

__all__ = ["WallGrid"]

#: a wall belongs to every square that it comes so close to, so that rounding on a square's edge hides no wall; metres
_MARGIN = 1e-6
_MOST_SQUARES = 512


class WallGrid(NamedTuple):
    """W wall segments, and for every square of a grid those in it; a tuple, so that compiled functions take it.

    Attributes
    ----------
    walls : ndarray, shape (W, 4)
        x and y of both ends, metres.
    first : ndarray of int32, shape (columns * rows + 1,)
        Where the walls of each square begin in ``members``; squares go by rows.
    members : ndarray of int32
        Walls, square after square.
    origin : tuple of float
        Lower left corner of the grid, metres.
    size : float
        Side of a square, metres.
    columns, rows : int
        Number of squares.
    """

    walls: NDArray[np.float64]
    first: NDArray[np.int32]
    members: NDArray[np.int32]
    origin: tuple[float, float]
    size: float
    columns: int
    rows: int

    @classmethod
    def of(cls, walls: NDArray[np.float64], size: float = 1.0) -> WallGrid:
        """Lay a grid over walls, shape (W, 2, 2) with W >= 1; squares are larger where there would be too many."""
        low, high = walls.reshape(-1, 2).min(axis=0), walls.reshape(-1, 2).max(axis=0)
        size = max(size, float((high - low).max()) / _MOST_SQUARES)
        columns, rows = (max(1, math.floor(float(extent) / size) + 1) for extent in high - low)
        column, row = np.meshgrid(np.arange(columns), np.arange(rows))
        x, y = low[0] + size * column.reshape(-1), low[1] + size * row.reshape(-1)
        tree = shapely.STRtree(np.array(shapely.linestrings(walls), dtype=object))
        square, wall = tree.query(shapely.box(x, y, x + size, y + size), predicate="dwithin", distance=_MARGIN)
        order = np.lexsort((wall, square))
        first = np.concatenate([[0], np.cumsum(np.bincount(square, minlength=columns * rows))])
        return cls(
            walls=np.ascontiguousarray(walls.reshape(-1, 4)),
            first=first.astype(np.int32),
            members=wall[order].astype(np.int32),
            origin=(float(low[0]), float(low[1])),
            size=size,
            columns=columns,
            rows=rows,
        )
