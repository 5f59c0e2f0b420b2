"""Lines of sight among walls, compiled.

Imported late: numba takes half a second to import, and the first run after an installation some seconds to compile.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, cast

import numba
import numpy as np
from numpy.typing import NDArray

from discretize.wallgrid import WallGrid

__all__ = ["blocking_wall", "blocks", "compiled", "free_line", "seen_among", "seen_from", "seen_pairs"]

#: pairs of an eye and a target that are looked at in one go: a megabyte or so
_CHUNK = 1_000_000


def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a function when it is first called; it lets other threads run."""
    return cast(Callable[..., Any], numba.njit(cache=True, nogil=True, error_model="numpy")(function))


@compiled
def blocks(walls, w, ax, ay, bx, by):  # type: ignore[no-untyped-def]
    """Whether wall ``w``, from p to q, is between a and b.

    A ray that touches the end of a wall is blocked; one that only ends on a wall, or runs along one, is not. These
    are the rules of pymunk's segment queries.
    """
    px, py, qx, qy = walls[w, 0], walls[w, 1], walls[w, 2], walls[w, 3]
    dx, dy = bx - ax, by - ay
    p = dx * (py - ay) - dy * (px - ax)
    q = dx * (qy - ay) - dy * (qx - ax)
    if p * q > 0.0:
        return False
    ex, ey = qx - px, qy - py
    a = ex * (ay - py) - ey * (ax - px)
    b = ex * (by - py) - ey * (bx - px)
    return a * b < 0.0


@compiled
def blocking_wall(grid, ax, ay, bx, by):  # type: ignore[no-untyped-def]
    """Return a wall that is between a and b, or -1; squares are visited in the order in which the ray goes on."""
    size, columns, rows, (x0, y0) = grid.size, grid.columns, grid.rows, grid.origin
    dx, dy = bx - ax, by - ay
    i = min(max(math.floor((ax - x0) / size), 0), columns - 1)
    j = min(max(math.floor((ay - y0) / size), 0), rows - 1)
    last_i = min(max(math.floor((bx - x0) / size), 0), columns - 1)
    last_j = min(max(math.floor((by - y0) / size), 0), rows - 1)
    step_i, step_j = (1 if dx > 0 else -1), (1 if dy > 0 else -1)
    # share of the ray at which it leaves the square, and for one square's side
    side_x, side_y = np.inf, np.inf
    leave_x, leave_y = np.inf, np.inf
    if dx != 0.0:
        side_x = size / abs(dx)
        leave_x = (x0 + (i + (1 if dx > 0 else 0)) * size - ax) / dx
    if dy != 0.0:
        side_y = size / abs(dy)
        leave_y = (y0 + (j + (1 if dy > 0 else 0)) * size - ay) / dy
    for _ in range(abs(last_i - i) + abs(last_j - j) + 1):
        square = j * columns + i
        for m in range(grid.first[square], grid.first[square + 1]):
            w = grid.members[m]
            if blocks(grid.walls, w, ax, ay, bx, by):
                return w
        if j == last_j or (i != last_i and leave_x < leave_y):
            i += step_i
            leave_x += side_x
        else:
            j += step_j
            leave_y += side_y
    return -1


@compiled
def free_line(grid, ax, ay, bx, by):  # type: ignore[no-untyped-def]
    """Whether no wall is between a and b."""
    return blocking_wall(grid, ax, ay, bx, by) < 0


@compiled
def _pairs(grid, a, b):  # type: ignore[no-untyped-def]
    seen = np.empty(len(a), dtype=np.bool_)
    for k in range(len(a)):
        seen[k] = free_line(grid, a[k, 0], a[k, 1], b[k, 0], b[k, 1])
    return seen


@compiled
def _rows(grid, eyes, targets, reach, seen):  # type: ignore[no-untyped-def]
    for i in range(len(eyes)):
        ax, ay = eyes[i, 0], eyes[i, 1]
        for k in range(len(targets)):
            bx, by = targets[k, 0], targets[k, 1]
            seen[i, k] = math.hypot(bx - ax, by - ay) <= reach and free_line(grid, ax, ay, bx, by)


def seen_pairs(grid: WallGrid, a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return whether no wall is between ``a[k]`` and ``b[k]``, both of shape (K, 2), metres."""
    return cast(NDArray[np.bool_], _pairs(grid, np.asarray(a, np.float64), np.asarray(b, np.float64)))


def seen_from(
    grid: WallGrid, eye: NDArray[np.float64], targets: NDArray[np.float64], reach: float = math.inf
) -> NDArray[np.bool_]:
    """Return whether one eye, shape (2,), sees each target, shape (N, 2), at most ``reach`` metres away."""
    seen = np.empty((1, len(targets)), dtype=np.bool_)
    _rows(grid, np.asarray(eye, np.float64)[np.newaxis], targets, reach, seen)
    return cast(NDArray[np.bool_], seen[0])


def seen_among(
    grid: WallGrid, eyes: NDArray[np.float64], targets: NDArray[np.float64], reach: float = math.inf
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Find which targets each eye sees, on all cores.

    Parameters
    ----------
    grid : WallGrid
        Walls.
    eyes, targets : ndarray, shape (K, 2) and (N, 2)
        Metres; a place that is NaN sees nothing and is not seen.
    reach : float
        No eye sees further than this, metres.

    Returns
    -------
    indptr : ndarray of int64, shape (K + 1,)
        Where what each eye sees begins in ``indices``.
    indices : ndarray of int32
        Targets in sight, in rising order, eye after eye.
    """
    k, n = len(eyes), len(targets)
    size = max(1, min(64, _CHUNK // max(1, n)))

    def look(begin: int) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
        seen = np.empty((min(size, k - begin), n), dtype=np.bool_)
        _rows(grid, eyes[begin : begin + size], targets, reach, seen)
        return seen.sum(axis=1), np.nonzero(seen)[1].astype(np.int32)

    with ThreadPoolExecutor(os.cpu_count()) as threads:
        found = list(threads.map(look, range(0, k, size)))
    counts = [np.zeros(1, dtype=np.int64), *(count for count, _ in found)]
    return np.cumsum(np.concatenate(counts)), np.concatenate(
        [np.empty(0, dtype=np.int32), *(seen for _, seen in found)]
    )
