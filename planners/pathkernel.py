"""The compiled part of beam search for one pursuer's path; importing this module imports numba.

Beliefs (N,) are without the capture state, and looks are sparse rows. Motion is told by where the mass of each state
comes from: ``source`` and ``share`` (N,) name one state for each, and ``to``, ``also`` and ``more`` all others.
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

__all__ = ["best_path", "worth_of"]

Array = NDArray[np.float64]
Whole = NDArray[np.int64]


@numba.njit(cache=True, nogil=True)
def disperse(free: Array, after: Array, motion: Any) -> None:
    """Write to ``after`` the belief one step later.

    Nearly every place is come to from one other place only: that is one pass over the states; the rest is added.
    """
    source, share, to, also, more = motion
    for s in range(len(after)):
        after[s] = free[source[s]] * share[s]
    for e in range(len(to)):
        after[to[e]] += free[also[e]] * more[e]


@numba.njit(cache=True, nogil=True)
def take(free: Array, view: int, looks: Any) -> float:
    """Take from a belief what a viewpoint sees, and return how much that is; nothing for a viewpoint below 0."""
    row, state, chance = looks
    total = 0.0
    if view >= 0:
        for e in range(row[view], row[view + 1]):
            mass = chance[e] * free[state[e]]
            total += mass
            free[state[e]] -= mass
    return total


@numba.njit(cache=True, nogil=True)
def look_ahead(free: Array, after: Array, t: int, fixed: Whole, weight: Array, motion: Any, looks: Any) -> float:
    """Write to ``after`` the belief after the next step and all looks that are fixed; return what these are worth."""
    disperse(free, after, motion)
    mass = 0.0
    for k in range(len(fixed)):
        mass += take(after, fixed[k, t], looks)
    return float(weight[t + 1] * mass)


@numba.njit(cache=True, nogil=True)
def worth_of(begin: Array, fixed: Whole, weight: Array, motion: Any, looks: Any) -> float:
    """Return the value of looks ``fixed`` (K, H): the sum of what each takes times the weight of its step."""
    free, after, value = begin.copy(), np.empty_like(begin), 0.0
    for t in range(fixed.shape[1]):
        value += look_ahead(free, after, t, fixed, weight, motion, looks)
        free, after = after, free
    return value


@numba.njit(cache=True, nogil=True)
def best_path(
    begin: Array,
    fixed: Whole,
    first: int,
    cell: int,
    weight: Array,
    promise: Array,
    motion: Any,
    looks: Any,
    moves: Any,
    width: int,
    grain: int,
    known: float,
    begun: int,
) -> Any:
    """Search for the path of one pursuer that adds most to looks that are fixed.

    Paths that come to a checkpoint within the same ``grain`` steps compete, by their value so far and what they leave
    times ``promise``; the best ``width`` of them go on, at most one of those at the same checkpoint.

    Parameters
    ----------
    begin : ndarray, shape (N,)
        The belief now.
    fixed : ndarray of int64, shape (K, H)
        Viewpoints after each step that are certain, -1 where there is none.
    first, cell : int
        After how many steps the pursuer is at which checkpoint.
    weight : ndarray, shape (H + 1,)
        What mass is worth that is taken after each step.
    promise : ndarray, shape (H + 1,)
        What mass is worth that is left after each step.
    motion, looks, moves : tuple
        Arrays of the model.
    width, grain : int
        See above.
    begun : int
        The move with which the path must begin, -1 for any.
    known : float
        Only a path that makes the plan worth more than this is of interest.

    Returns
    -------
    tuple
        Value of the best plan, and the path's moves; ``known`` and none where no better one was found.
    """
    start, target, steps, views = moves
    horizon, windows = fixed.shape[1], fixed.shape[1] // grain + 1
    free, after, value = begin.copy(), np.empty_like(begin), 0.0
    for t in range(first):
        value += look_ahead(free, after, t, fixed, weight, motion, looks)
        free, after = after, free
    beliefs = np.empty((windows, width, len(begin)))
    held, when = np.zeros(windows, np.int64), np.empty((windows, width), np.int64)
    where, branch = np.empty_like(when), np.empty_like(when)
    gain, score = np.empty((windows, width)), np.empty((windows, width))
    parents, chosen = [-1], [-1]
    best, leaf = known, 0
    if first < horizon:
        w = first // grain
        held[w], when[w, 0], where[w, 0], gain[w, 0], branch[w, 0], beliefs[w, 0] = 1, first, cell, value, 0, free
    for w in range(windows):
        k = 0
        while k < held[w]:
            t0, here, root = when[w, k], where[w, k], branch[w, k]
            for m in range(start[here], start[here + 1]):
                if root == 0 and begun >= 0 and m != begun:
                    continue
                free[:] = beliefs[w, k]
                # one who waits does so until the next paths compete
                times = (w + 1) * grain - t0 if m == start[here] else 1
                value, end = gain[w, k], min(t0 + times * steps[m], horizon)
                for t in range(t0, end):
                    value += look_ahead(free, after, t, fixed, weight, motion, looks)
                    value += weight[t + 1] * take(after, views[m, (t - t0) % steps[m]], looks)
                    free, after = after, free
                for _ in range(times):
                    parents.append(root)
                    chosen.append(m)
                    root = len(parents) - 1
                root = branch[w, k]
                if end == horizon:
                    if value > best:
                        best, leaf = value, len(parents) - 1
                    continue
                v, there, left = end // grain, target[m], free.sum()
                if value + weight[end + 1] * left <= best:
                    continue
                mark = value + promise[end] * left
                slot = place_for(mark, there, held, where, score, v, width, k if v == w else -1)
                if slot >= 0:
                    held[v] = max(held[v], slot + 1)
                    when[v, slot], where[v, slot], gain[v, slot] = end, there, value
                    score[v, slot], branch[v, slot], beliefs[v, slot] = mark, len(parents) - 1, free
            k += 1
    path = [0]
    while leaf > 0:
        path.append(chosen[leaf])
        leaf = parents[leaf]
    return best, np.array(path[:0:-1], np.int64)


@numba.njit(cache=True, nogil=True)
def place_for(mark: float, cell: int, held: Whole, where: Whole, score: Array, w: int, width: int, done: int) -> int:
    """Return where a path that comes to a checkpoint is kept among others of its window, -1 if it is not.

    Those up to ``done`` have gone on already and are not replaced.
    """
    worst = -1
    for k in range(held[w]):
        if where[w, k] == cell:
            return k if k > done and score[w, k] < mark else -1
        if k > done and (worst < 0 or score[w, k] < score[w, worst]):
            worst = k
    if held[w] < width:
        return int(held[w])
    return worst if worst >= 0 and score[w, worst] < mark else -1
