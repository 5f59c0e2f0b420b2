"""What the states of a belief are: the cells of a map, or parts of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["StateSpace"]


@dataclass(frozen=True, slots=True, eq=False)
class StateSpace:
    """N states, each of which lies in one of C cells.

    Attributes
    ----------
    cell : ndarray of intp, shape (N,)
        Cell in which each state lies, counted from 0.
    share : ndarray, shape (N,)
        Share of its cell's probability that a state has where nothing but the cell is known; sums to 1 in each cell.
    cells : int
        Number C of cells.

    Examples
    --------
    A first cell in two parts, one three times as large as the other, and a second cell in one:

    >>> import numpy as np
    >>> parts = StateSpace(np.array([0, 0, 1]), np.array([0.75, 0.25, 1.0]), 2)
    >>> parts.spread(np.array([0.2, 0.4, 0.4]))
    array([0.2, 0.3, 0.1, 0.4])
    >>> parts.gather(np.array([0.2, 0.3, 0.1, 0.4]))
    array([0.2, 0.4, 0.4])
    """

    cell: NDArray[np.intp]
    share: NDArray[np.float64]
    cells: int

    @classmethod
    def of_cells(cls, cells: int) -> StateSpace:
        """Return the space whose states are the cells themselves."""
        return cls(np.arange(cells), np.ones(cells), cells)

    def __len__(self) -> int:
        return len(self.cell)

    def spread(self, belief: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return a belief over the states, shape (N + 1,), from one over the cells, shape (C + 1,)."""
        return np.concatenate([belief[:1], belief[1:][self.cell] * self.share])

    def gather(self, belief: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the probability of each cell, shape (C + 1,), from a belief over the states, shape (N + 1,)."""
        cells = np.bincount(self.cell, weights=belief[1:], minlength=self.cells)
        return np.concatenate([belief[:1], cells])
