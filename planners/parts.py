"""Cells cut into parts, so that what has been seen of a cell and what has not are told apart."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize import CellMap
from planners.graph import SearchGraph
from planners.motion import MotionModel
from planners.space import StateSpace

if TYPE_CHECKING:
    from planners.motion import Sparse

__all__ = ["MotionInParts", "cut_cells"]

# However small a cell, its lattice has so many points in each direction.
FEWEST = 2


def cut_cells(cells: CellMap, spacing: float) -> tuple[StateSpace, NDArray[np.float64]]:
    """Cut every cell into equal parts, one around each point of a square lattice that lies in it.

    Parameters
    ----------
    cells : CellMap
        N cells.
    spacing : float
        Of the lattice, metres.

    Returns
    -------
    space : StateSpace
        S parts, those of a cell next to each other.
    points : ndarray, shape (S, 2)
        The middle of each part, metres.
    """
    found = [_lattice(cell, spacing) for cell in cells.cells]
    count = np.array([len(points) for points in found], dtype=np.intp)
    cell = np.repeat(np.arange(len(cells)), count)
    return StateSpace(cell, 1.0 / count[cell], len(cells)), np.concatenate(found)


def _lattice(cell: shapely.Polygon, spacing: float) -> NDArray[np.float64]:
    """Return the points of a lattice in the middle of a cell's bounds that lie in the cell; at least one point."""
    x0, y0, x1, y1 = cell.bounds
    across, up = (max(FEWEST, round((b - a) / spacing)) for a, b in ((x0, x1), (y0, y1)))
    x = x0 + (np.arange(across) + 0.5) * (x1 - x0) / across
    y = y0 + (np.arange(up) + 0.5) * (y1 - y0) / up
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    inside = points[shapely.contains_xy(cell, points[:, 0], points[:, 1])]
    return inside if len(inside) else np.array(cell.representative_point().coords)


@dataclass(frozen=True, slots=True, eq=False)
class MotionInParts:
    """An evader that moves from cell to cell as another model says, and within its cell as fast as it leaves it.

    With P the matrix between cells and ``w`` the share of each part in its cell, part ``a`` of cell ``i`` goes on to
    part ``b`` of cell ``j`` with ``P[i, j] w[b]``, and stays as it is with ``P[i, i]``, of which the share
    ``1 - P[i, i]`` is anywhere in the cell anew. The probabilities of cells are those of the other model; an evader
    that never leaves its cell never changes its part.

    Attributes
    ----------
    cells : MotionModel
        Motion between cells.
    graph : SearchGraph
        The cells; the graph that pursuers go on may be another.
    space : StateSpace
        The parts.
    """

    cells: MotionModel
    graph: SearchGraph
    space: StateSpace

    def matrix(self, graph: SearchGraph, time_step: float) -> Sparse:  # noqa: ARG002  (the evader has its own)
        """Return P over the capture state and S parts, shape (S + 1, S + 1)."""
        from scipy.sparse import block_diag, csr_array, diags_array, eye_array

        between = self.cells.matrix(self.graph, time_step)[1:, 1:]
        stay = between.diagonal()
        moving = between - diags_array(stay * stay)
        number, parts = np.arange(len(self.space)), len(self.space)
        member = csr_array((np.ones(parts), (number, self.space.cell)), shape=(parts, self.space.cells))
        share = csr_array((self.space.share, (self.space.cell, number)), shape=(self.space.cells, parts))
        inner = member @ moving @ share + diags_array((stay * stay)[self.space.cell])
        whole = csr_array(block_diag([eye_array(1), inner]))
        whole.eliminate_zeros()
        return whole
