"""Where the evader is believed to be: a probability vector with a capture state, and its forward step."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planners.graph import GraphError, SearchGraph

if TYPE_CHECKING:
    from planners.motion import Sparse

__all__ = ["advance", "point_belief", "uniform_belief"]


def uniform_belief(
    graph: SearchGraph, *, exclude: Iterable[int] = (), component: int | None = None
) -> NDArray[np.float64]:
    """Return the belief of an evader that is as likely in any one cell as in another (Section V).

    Parameters
    ----------
    graph : SearchGraph
        Cells and the ways between them.
    exclude : iterable of int
        Cells without the evader, such as those that the pursuers start in, counted from 0.
    component : int, optional
        Only cells of this connected component; without it every cell that can be entered.

    Returns
    -------
    ndarray, shape (N + 1,)
        Sums to 1; index 0 is the capture state, with probability 0.

    Raises
    ------
    GraphError
        If an excluded cell does not exist, or no cell is left.
    """
    free = graph.component >= 0 if component is None else graph.component == component
    for cell in exclude:
        _check_cell(graph, cell)
        free[cell] = False
    if not free.any():
        raise GraphError("No cell is left in which the evader could be.")
    return np.concatenate([[0.0], free / free.sum()])


def point_belief(graph: SearchGraph, cell: int) -> NDArray[np.float64]:
    """Return the belief of an evader known to be in one ``cell`` of ``graph``, counted from 0; shape (N + 1,).

    Raises
    ------
    GraphError
        If there is no such cell.
    """
    _check_cell(graph, cell)
    belief = np.zeros(len(graph) + 1)
    belief[cell + 1] = 1.0
    return belief


def advance(
    belief: NDArray[np.float64], transition: Sparse | NDArray[np.float64], rows: ArrayLike
) -> NDArray[np.float64]:
    """Return the belief one step later: dispersion, then capture by every pursuer.

    Eq. 3 of the paper, ``p(t+1) = p(t) P prod_i C_i``. A capture matrix is given by its row of detection
    probabilities: what it takes from each state goes to the capture state.

    Parameters
    ----------
    belief : ndarray, shape (..., N + 1)
        One belief or any batch of them; index 0 is the capture state.
    transition : csr_array or ndarray, shape (N + 1, N + 1)
        Dispersion matrix P, see :class:`planners.MotionModel`.
    rows : array_like, shape (R, N) or (..., R, N)
        Detection probability of each state for each of R pursuers; R may be 0.

    Returns
    -------
    ndarray, shape (..., N + 1)
        A new array; the one given is not changed.

    Examples
    --------
    Three cells in a row, a pursuer in the first one, and an evader that stays or goes to a neighbour, all alike. From
    the middle one a third comes into the first, and is captured there:

    >>> import numpy as np
    >>> from planners import SameCell, SearchGraph, UniformMotion, advance, uniform_belief
    >>> row = SearchGraph.from_edges(3, [(0, 1), (1, 2)])
    >>> belief = uniform_belief(row, exclude=[0])
    >>> after = advance(belief, UniformMotion().matrix(row, 1.0), [SameCell().row(row, 0)])
    >>> print(6 * after)  # in sixths: captured, and in each cell
    [1.  0.  2.5 2.5]
    """
    states = belief.shape[-1]
    after: NDArray[np.float64] = np.asarray(belief.reshape(-1, states) @ transition).reshape(belief.shape)
    seen = np.asarray(rows, dtype=np.float64)
    missed = np.prod(1.0 - (seen.reshape(-1, states - 1) if seen.ndim == 1 else seen), axis=-2)
    kept = after[..., 1:] * missed
    captured = after[..., 0] + (after[..., 1:] - kept).sum(axis=-1)
    return np.concatenate([captured[..., np.newaxis], kept], axis=-1)


def _check_cell(graph: SearchGraph, cell: int) -> None:
    if not 0 <= cell < len(graph):
        raise GraphError(f"There is no cell {cell + 1}; cells are numbered from 1 to {len(graph)}.")
