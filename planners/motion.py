"""How the evader is believed to move: dispersion matrices, row-stochastic and sparse."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from maps import GeomsimError
from planners.graph import SearchGraph

if TYPE_CHECKING:
    from scipy.sparse import csr_array

    Sparse: TypeAlias = csr_array[Any, tuple[int, int]]

__all__ = [
    "AreaSpeedDegree",
    "DwellTime",
    "GivenMotion",
    "MotionError",
    "MotionModel",
    "StationaryMotion",
    "UniformMotion",
    "check_transition",
    "fit_motion",
]


class MotionError(GeomsimError):
    """A transition matrix or the parameter of a motion model that cannot be right."""


@runtime_checkable
class MotionModel(Protocol):
    """Gives the dispersion matrix P of Eq. 1 for a time step."""

    def matrix(self, graph: SearchGraph, time_step: float) -> Sparse:
        """Return P over the capture state and N states, one row for where the evader is.

        A state is a cell of the graph in the models here; it may be anything finer, as long as the capture model
        of the same problem speaks of the same states.

        Parameters
        ----------
        graph : SearchGraph
            Cells and the ways between them.
        time_step : float
            Time from one belief to the next, seconds.

        Returns
        -------
        csr_array, shape (N + 1, N + 1)
            Row-stochastic; row and column 0 are the capture state's, which nothing enters or leaves.
        """
        ...


@dataclass(frozen=True, slots=True)
class UniformMotion:
    """Stay, or move to any one neighbour, all equally likely at each step whatever its length.

    The worked example of the paper (Section IV-B, the printed 10 x 10 matrix).

    Examples
    --------
    Cell 4 of the paper's house, Fig. 2, which has five neighbours (the emboldened row, in sixths):

    >>> from planners import SearchGraph, UniformMotion
    >>> doors = [(1, 4), (1, 8), (2, 8), (2, 9), (3, 4), (4, 5), (4, 6), (4, 9), (5, 7), (6, 7)]
    >>> house = SearchGraph.from_edges(9, [(a - 1, b - 1) for a, b in doors])
    >>> print(6 * UniformMotion().matrix(house, 1.0).toarray()[4])
    [0. 1. 0. 1. 1. 1. 1. 0. 0. 1.]
    """

    def matrix(self, graph: SearchGraph, time_step: float) -> Sparse:  # noqa: ARG002  (the same for every step)
        """Return P with 1 / (degree + 1) for the cell itself and for each neighbour."""
        share = np.asarray(1.0 / (graph.degree + 1.0), dtype=np.float64)
        return _dispersion(graph, share, share)


@dataclass(frozen=True, slots=True)
class AreaSpeedDegree:
    """Dwell longer in a larger cell, leave it sooner at a higher speed, by any of its doors alike.

    Section V names three quantities on which staying and moving depend - the area of the cell, the speed of the
    evader, the number of adjacent cells - but prints no formula. Here a cell of area A takes a time
    ``tau = sqrt(A) / speed`` to cross on average, leaving is memoryless with that mean, and every one of the ``k``
    neighbours is as likely as another::

        P[i, i] = exp(-time_step / tau_i),    P[i, j] = (1 - P[i, i]) / k_i

    which is row-stochastic for every time step. The evader changes cell at most once in a step, so the step should
    not be much longer than the shortest ``tau``.

    Attributes
    ----------
    speed : float
        Speed of the evader, metres a second; above 0.

    Raises
    ------
    MotionError
        If the speed is not a number above 0.
    """

    speed: float = 1.0

    def __post_init__(self) -> None:
        check_speed(self.speed)

    def matrix(self, graph: SearchGraph, time_step: float) -> Sparse:
        """Return P for a step of any length above 0, seconds."""
        degree = graph.degree
        stay = np.where(degree == 0, 1.0, np.exp(-time_step * self.speed / np.sqrt(graph.area)))
        move = np.asarray((1.0 - stay) / np.maximum(degree, 1), dtype=np.float64)
        return _dispersion(graph, stay.astype(np.float64), move)


@dataclass(frozen=True, slots=True)
class DwellTime:
    """Leave each cell after the time that an evader between checkpoints and portals takes on average.

    An evader that walks from portal to checkpoint to portal (Section V-A), each portal of the cell as likely as
    another, comes in by every portal equally often too, since it goes over each edge as often in one direction as in
    the other. So it dwells for ``tau = 2 * mean(leg) / speed``, with the ways ``leg`` from the cell's checkpoint to
    its portals; and::

        P[i, i] = 1 - min(1, time_step / tau_i),    P[i, j] = (1 - P[i, i]) / k_i

    so that a memoryless evader dwells as long on average. It changes cell at most once in a step. Where it dwells
    longer than a step, the capture curve of a team that stands is predicted to 0.02 on the bundled office and museum;
    of a team that follows the belief, to 0.03 to 0.16, since a real evader's dwell is not memoryless.

    Attributes
    ----------
    speed : float
        Speed of the evader, metres a second; above 0.

    Raises
    ------
    MotionError
        If the speed is not a number above 0.
    """

    speed: float = 1.0

    def __post_init__(self) -> None:
        check_speed(self.speed)

    def matrix(self, graph: SearchGraph, time_step: float) -> Sparse:
        """Return P for a step of any length above 0, seconds."""
        degree = graph.degree
        cell = np.repeat(np.arange(len(graph)), degree)
        legs = np.bincount(cell, weights=graph.leave, minlength=len(graph))
        mean = legs / np.maximum(degree, 1)
        leave = np.minimum(1.0, time_step * self.speed / np.maximum(2.0 * mean, 1e-9))
        leave = np.where(degree == 0, 0.0, leave).astype(np.float64)
        move = np.asarray(leave / np.maximum(degree, 1), dtype=np.float64)
        return _dispersion(graph, np.asarray(1.0 - leave, dtype=np.float64), move)


@dataclass(frozen=True, slots=True)
class GivenMotion:
    """A transition matrix of the user's own, or one fitted by :func:`fit_motion`.

    Attributes
    ----------
    transition : csr_array, shape (N + 1, N + 1)
        As :func:`check_transition` wants it.
    time_step : float
        The step for which it holds, seconds.
    """

    transition: Sparse
    time_step: float = 1.0

    def matrix(self, graph: SearchGraph, time_step: float) -> Sparse:
        """Return the matrix; MotionError if it is none for this graph, or holds for another step."""
        if not np.isclose(time_step, self.time_step):
            raise MotionError(f"The transition matrix is for steps of {self.time_step} s; asked for {time_step} s.")
        check_transition(self.transition, graph)
        return self.transition


def fit_motion(
    graph: SearchGraph, trajectories: Iterable[ArrayLike], time_step: float = 1.0, prior: float = 1.0
) -> GivenMotion:
    """Fit a transition matrix to cells in which evaders were observed.

    The estimate is ``(count[i, j] + prior * U[i, j]) / (count[i] + prior)`` with U the matrix of uniform motion: the
    mean of the posterior under a Dirichlet prior, so that a cell nobody was seen in falls back to uniform motion.

    Parameters
    ----------
    graph : SearchGraph
        The cells.
    trajectories : iterable of array_like of int, each of shape (T,)
        Cells, counted from 0, one for every time step.
    time_step : float
        Time between two observations, seconds.
    prior : float
        How many observations the prior is worth; above 0.

    Raises
    ------
    MotionError
        If a trajectory names a cell that does not exist, or leaps between cells that are not neighbours, or the prior
        is not above 0.
    """
    from scipy.sparse import coo_array

    if not prior > 0:
        raise MotionError(f"The prior of a fitted motion must be worth more than 0 observations; got {prior}.")
    n = len(graph)
    pairs = []
    for k, cells in enumerate(np.asarray(t, dtype=np.intp) for t in trajectories):
        for cell in cells[(cells < 0) | (cells >= n)][:1]:
            raise MotionError(f"Trajectory {k} names cell {cell + 1}; cells are numbered from 1 to {n}.")
        pairs.append(np.stack([cells[:-1], cells[1:]]))
    i, j = np.concatenate([np.empty((2, 0), dtype=np.intp), *pairs], axis=1) + 1
    counted = coo_array((np.ones(len(i)), (i, j)), shape=(n + 1, n + 1)).tocsr()
    counted = counted + prior * UniformMotion().matrix(graph, time_step)
    total = np.asarray(counted.sum(axis=1)).ravel()
    counted.data /= np.repeat(total, np.diff(counted.indptr))
    check_transition(counted, graph)
    return GivenMotion(counted, time_step)


@dataclass(frozen=True, slots=True)
class StationaryMotion:
    """Stay for ever: the identity as dispersion matrix (Section V, last paragraph)."""

    def matrix(self, graph: SearchGraph, time_step: float) -> Sparse:  # noqa: ARG002  (the same for every step)
        """Return the identity."""
        return _dispersion(graph, np.ones(len(graph)), np.zeros(len(graph)))


def check_speed(speed: float) -> None:
    if not (np.isfinite(speed) and speed > 0):
        raise MotionError(f"The evader's speed must be a number above 0; got {speed}.")


def _dispersion(graph: SearchGraph, stay: NDArray[np.float64], move: NDArray[np.float64]) -> Sparse:
    """Return P from each cell's probability of staying and of moving to any one neighbour, both of shape (N,)."""
    from scipy.sparse import csr_array

    n, degree = len(graph), graph.degree
    cell = np.arange(n)
    rows = np.concatenate([[0], cell + 1, np.repeat(cell, degree) + 1])
    columns = np.concatenate([[0], cell + 1, graph.indices + 1])
    matrix = csr_array((np.concatenate([[1.0], stay, np.repeat(move, degree)]), (rows, columns)), shape=(n + 1, n + 1))
    matrix.eliminate_zeros()
    return matrix


def check_transition(matrix: Sparse | NDArray[np.float64], graph: SearchGraph | None = None) -> None:
    """Check that a matrix can be the dispersion matrix P of Eq. 1.

    Parameters
    ----------
    matrix : csr_array or ndarray, shape (N + 1, N + 1)
        Row and column 0 are the capture state's.
    graph : SearchGraph, optional
        If given, states are its cells, and the evader may only stay or move to a neighbour.

    Raises
    ------
    MotionError
        If the matrix has another shape, an entry that is negative or no number, a row whose sum is not 1 (within
        1e-9), a way into or out of the capture state, or a move between cells that are not neighbours. Cells are
        named as people see them, from 1.
    """
    from scipy.sparse import coo_array

    entries = coo_array(matrix)
    rows, columns = entries.shape
    if rows != columns or (graph is not None and rows != len(graph) + 1):
        want = "square" if graph is None else f"{len(graph) + 1} x {len(graph) + 1} (capture state and every cell)"
        raise MotionError(f"A transition matrix must be {want}; got {rows} x {columns}.")
    i, j = entries.coords
    value = entries.data
    for k in np.flatnonzero(~(np.isfinite(value) & (value >= 0)))[:1]:
        raise MotionError(f"The probability of moving from state {i[k]} to state {j[k]} is {value[k]}.")
    total = np.bincount(i, weights=value, minlength=rows)
    for row in np.flatnonzero(np.abs(total - 1.0) > 1e-9)[:1]:
        raise MotionError(f"Row {row} of the transition matrix sums to {total[row]:.12g}, not to 1.")
    crossing = ((i == 0) != (j == 0)) & (value > 0)
    for k in np.flatnonzero(crossing)[:1]:
        raise MotionError(f"Moving from state {i[k]} to state {j[k]} enters or leaves the capture state 0.")
    if graph is not None:
        tail = np.repeat(np.arange(len(graph)), graph.degree)
        known = set(zip((tail + 1).tolist(), (graph.indices + 1).tolist(), strict=True))
        for a, b, share in zip(i.tolist(), j.tolist(), value.tolist(), strict=True):
            if share > 0 and a != b and (a, b) not in known:
                raise MotionError(f"The matrix moves the evader from cell {a} to cell {b}, which are not neighbours.")
