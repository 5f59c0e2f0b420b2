"""What a pursuer is believed to catch: detection probabilities for each place it may look from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from maps import GeomsimError
from planners.graph import SearchGraph

if TYPE_CHECKING:
    from planners.motion import Sparse

__all__ = ["CaptureError", "CaptureModel", "SameCell"]


class CaptureError(GeomsimError):
    """A parameter of a capture model that cannot be right."""


@runtime_checkable
class CaptureModel(Protocol):
    """Gives the capture matrices C of Section IV-B, as rows of detection probabilities.

    A pursuer looks from a *viewpoint*. Viewpoints count from 0; the first ones are the checkpoints of the graph's
    cells, and a model may have more along the ways between them. The matrix C of a viewpoint moves the share
    ``row[n]`` of the probability of state ``n`` to the capture state.
    """

    def table(self, graph: SearchGraph) -> Sparse:
        """Return the detection probability of each state from each viewpoint, shape (V, N) with V >= len(graph)."""
        ...

    def viewpoints(self, graph: SearchGraph, edge: int, way: NDArray[np.float64]) -> NDArray[np.intp]:
        """Return the viewpoint of a pursuer at each place along an edge.

        Parameters
        ----------
        graph : SearchGraph
            Cells and the ways between them.
        edge : int
            Index of a directed edge, see :meth:`SearchGraph.edge`.
        way : ndarray, shape (k,)
            Metres gone from the checkpoint of the edge's first cell.

        Returns
        -------
        ndarray of intp, shape (k,)
        """
        ...

    def row(self, graph: SearchGraph, cell: int) -> NDArray[np.float64]:
        """Return the detection probability of each state, shape (N,), for a pursuer at the checkpoint of a cell."""
        ...


@dataclass(frozen=True, slots=True)
class SameCell:
    """Sees the whole of the cell that it is in, and nothing of the others (Section V).

    Attributes
    ----------
    detection : float
        Probability of seeing an evader in the same cell at one belief step, in (0, 1]. Below one, looks at
        successive steps are taken to fail independently (the paper's footnote on noisy sensors).

    Raises
    ------
    CaptureError
        If the detection probability is outside (0, 1].
    """

    detection: float = 1.0

    def __post_init__(self) -> None:
        if not 0 < self.detection <= 1:
            raise CaptureError(f"A detection probability must be above 0 and at most 1; got {self.detection}.")

    def table(self, graph: SearchGraph) -> Sparse:
        """Return the identity times the detection probability, shape (N, N)."""
        from scipy.sparse import csr_array

        n = len(graph)
        return csr_array((np.full(n, self.detection), np.arange(n), np.arange(n + 1)), shape=(n, n))

    def viewpoints(self, graph: SearchGraph, edge: int, way: NDArray[np.float64]) -> NDArray[np.intp]:
        """Return the cell that the pursuer is in: the one it leaves up to the portal, then the one it enters."""
        first = int(np.searchsorted(graph.indptr, edge, side="right")) - 1
        entered = way >= graph.leave[edge] - 1e-9
        return np.where(entered, graph.indices[edge], first).astype(np.intp)

    def row(self, graph: SearchGraph, cell: int) -> NDArray[np.float64]:
        """Return zeros but for the pursuer's own cell."""
        row = np.zeros(len(graph))
        row[cell] = self.detection
        return row
