"""What is compiled: the first look of a team at each of many evaders.

Imported late: numba takes half a second to import, and the first run after an installation some seconds to compile.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from discretize import WallGrid
from discretize.raycast import blocking_wall, blocks, compiled, free_line

__all__ = ["Looked", "Lookers", "blocked_moves", "first_looks", "first_meetings"]


@compiled
def _blocked(grid, track):  # type: ignore[no-untyped-def]
    size, (x0, y0) = grid.size, grid.origin
    count = 0
    for t in range(len(track) - 1):
        for k in range(track.shape[1]):
            ax, ay, bx, by = track[t, k, 0], track[t, k, 1], track[t + 1, k, 0], track[t + 1, k, 1]
            i, j = math.floor((ax - x0) / size), math.floor((ay - y0) / size)
            if i == math.floor((bx - x0) / size) and j == math.floor((by - y0) / size):
                square = min(max(j, 0), grid.rows - 1) * grid.columns + min(max(i, 0), grid.columns - 1)
                if grid.first[square] == grid.first[square + 1]:
                    continue  # most moves stay within a square that holds no wall
            if (ax != bx or ay != by) and not free_line(grid, ax, ay, bx, by):
                count += 1
    return count


@compiled
def _looks(  # type: ignore[no-untyped-def]
    grid, eyes, headings, reach, half, rates, targets, which, patience, looked, when, who
):
    free = which.copy()
    left = len(free)
    # the wall that hid an evader a step ago mostly hides it still
    hides = np.full(looked.shape, -1, dtype=np.int32)
    for t in range(len(targets)):
        kept = 0
        for n in range(left):
            k = free[n]
            bx, by = float(targets[t, k, 0]), float(targets[t, k, 1])
            caught = False
            for i in range(eyes.shape[1]):
                ax, ay = eyes[t, i, 0], eyes[t, i, 1]
                dx, dy = bx - ax, by - ay
                if math.hypot(dx, dy) > reach[i]:
                    continue
                if half[i] < math.pi and (dx != 0.0 or dy != 0.0):
                    off = math.atan2(dy, dx) - headings[t, i]
                    off -= 2 * math.pi * np.rint(off / (2 * math.pi))
                    if abs(off) > half[i]:
                        continue
                w = hides[k, i]
                if w >= 0 and blocks(grid.walls, w, ax, ay, bx, by):
                    continue
                hides[k, i] = blocking_wall(grid, ax, ay, bx, by)
                if hides[k, i] < 0:
                    looked[k, i] += rates[i]
                    if looked[k, i] >= patience[k, i]:
                        when[k], who[k] = t, i
                        caught = True
                        break
            if not caught:
                free[kept] = k
                kept += 1
        left = kept
        if left == 0:
            break


@compiled
def _meetings(occupied, rates, hidden, which, patience, looked, when, who):  # type: ignore[no-untyped-def]
    free = which.copy()
    left = len(free)
    for t in range(len(hidden)):
        kept = 0
        for n in range(left):
            k = free[n]
            caught = False
            for i in range(occupied.shape[1]):
                if occupied[t, i] == hidden[t, k]:
                    looked[k, i] += rates[i]
                    if looked[k, i] >= patience[k, i]:
                        when[k], who[k] = t, i
                        caught = True
                        break
            if not caught:
                free[kept] = k
                kept += 1
        left = kept
        if left == 0:
            break


def blocked_moves(grid: WallGrid, track: NDArray[Any]) -> int:
    """Count the moves that went through a wall, which must be none; ``track`` has shape (T, K, 2), metres."""
    return int(_blocked(grid, track))


@dataclass(frozen=True, slots=True)
class Lookers:
    """P robots with their eyes.

    Attributes
    ----------
    reach : ndarray, shape (P,)
        How far each sees, metres.
    half : ndarray, shape (P,)
        Half of its field of view, radians.
    rates : ndarray, shape (P,)
        Attention that it pays in a physics step, see :attr:`geomsim.sensing.Sensor.attention`.
    """

    reach: NDArray[np.float64]
    half: NDArray[np.float64]
    rates: NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Looked:
    """What robots have seen of K evaders so far; changed by every pass.

    Attributes
    ----------
    patience : ndarray, shape (K, P)
        Attention at which each robot notices each evader.
    paid : ndarray, shape (K, P)
        Attention paid so far.
    """

    patience: NDArray[np.float64]
    paid: NDArray[np.float64]


def first_looks(
    grid: WallGrid,
    lookers: Lookers,
    eyes: NDArray[np.float64],
    headings: NDArray[np.float64],
    targets: NDArray[np.float32],
    which: NDArray[np.intp],
    looked: Looked,
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Find the first time at which a team notices each evader by sight.

    Parameters
    ----------
    grid : WallGrid
        Walls.
    lookers : Lookers
        P robots.
    eyes, headings : ndarray, shape (T, P, 2) and (T, P)
        Where they are, metres, and look, radians.
    targets : ndarray of float32, shape (T, K, 2)
        Where the evaders are, metres.
    which : ndarray of intp
        The evaders to be looked for.
    looked : Looked
        What was seen before.

    Returns
    -------
    when, who : ndarray of intp, shape (K,)
        Index into T and into P; -1 for an evader that was not noticed or not looked for.
    """
    when, who = _none(targets.shape[1])
    sharp = lookers.reach, lookers.half, lookers.rates
    _looks(grid, eyes, headings, *sharp, targets, which, looked.patience, looked.paid, when, who)
    return when, who


def first_meetings(
    lookers: Lookers,
    occupied: NDArray[np.int32],
    hidden: NDArray[np.int32],
    which: NDArray[np.intp],
    looked: Looked,
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Find the first time at which a team notices each evader in a robot's own cell.

    Like :func:`first_looks`, with the cells of the robots, shape (T, P), and of the evaders, shape (T, K).
    """
    when, who = _none(hidden.shape[1])
    _meetings(occupied, lookers.rates, hidden, which, looked.patience, looked.paid, when, who)
    return when, who


def _none(count: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    return np.full(count, -1, dtype=np.intp), np.full(count, -1, dtype=np.intp)
