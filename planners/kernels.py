"""The compiled part of branch and bound; importing this module imports numba.

A plan's value is linear in the mass that a look takes: mass taken from state ``s`` after step ``t`` is worth
``worth[t, s]``. All functions work on beliefs (N,) without the capture state and on looks as sparse rows.
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

__all__ = ["begin_search", "open_bound", "search"]

Array = NDArray[np.float64]
Whole = NDArray[np.int64]


@numba.njit(cache=True)
def disperse(free: Array, after: Array, motion: Any, unseen: Array) -> None:
    """Write to ``after`` the belief one step later; ``unseen`` (N,) is what the others leave of each state."""
    ptr, to, share = motion
    after[:] = 0.0
    for s in range(len(free)):
        mass = free[s]
        if mass != 0.0:
            for e in range(ptr[s], ptr[s + 1]):
                after[to[e]] += mass * share[e]
    after *= unseen


@numba.njit(cache=True)
def values_from(weight: Array, unseen: Array, motion: Any, worth: Array) -> None:
    """Write to ``worth`` (H + 1, N) what taking mass is worth beside looks that are already fixed.

    It is the weight of the step less what those looks, leaving ``unseen`` (H, N), would get for that mass later.
    """
    ptr, to, share = motion
    horizon, states = unseen.shape
    gets = np.zeros(states)
    worth[horizon] = weight[horizon]
    for t in range(horizon - 1, -1, -1):
        after = (1.0 - unseen[t]) * weight[t + 1] + unseen[t] * gets
        for s in range(states):
            total = 0.0
            for e in range(ptr[s], ptr[s + 1]):
                total += share[e] * after[to[e]]
            worth[t, s] = weight[t] - total
        gets = weight[t] - worth[t]


@numba.njit(cache=True)
def relax(
    t: int,
    cell: int,
    free: Array,
    unseen: Array,
    worth: Array,
    motion: Any,
    looks: Any,
    moves: Any,
    ahead: Array,
    reach: NDArray[np.bool_],
    bounds: Array,
) -> None:
    """Bound from above what one pursuer at a checkpoint can still get, for each of its moves.

    The relaxation: its looks take nothing from later ones, except that what one look has seen is not there for the
    next look (a step of memory; with none it is the MEAN bound of the search literature). Then the best path is
    found by dynamic programming over places and time. ``free[t]`` is the belief; later rows are overwritten.
    """
    ptr, to, share = motion
    row, state, chance, table = looks
    start, target, steps, views = moves
    horizon, cells = len(unseen), len(start) - 1
    for k in range(t, horizon):
        disperse(free[k], free[k + 1], motion, unseen[k])
    reach[t:] = False
    reach[t, cell] = True
    for k in range(t, horizon):
        for c in range(cells):
            if reach[k, c]:
                for m in range(start[c], start[c + 1]):
                    if k + steps[m] <= horizon:
                        reach[k + steps[m], target[m]] = True
    ahead[horizon] = 0.0
    for k in range(horizon - 1, t - 1, -1):
        for c in range(cells):
            if not reach[k, c]:
                continue
            best = -1.0
            for m in range(start[c], start[c + 1]):
                value, last = 0.0, c
                for j in range(min(steps[m], horizon - k)):
                    view = views[m, j]
                    now, after = free[k + j], free[k + j + 1]
                    for e in range(row[view], row[view + 1]):
                        value += chance[e] * after[state[e]] * worth[k + j + 1, state[e]]
                    for e in range(row[last], row[last + 1]):
                        mass = chance[e] * now[state[e]]
                        if mass != 0.0 and (k > t or j > 0):
                            for q in range(ptr[state[e]], ptr[state[e] + 1]):
                                s = to[q]
                                value -= mass * share[q] * unseen[k + j, s] * table[view, s] * worth[k + j + 1, s]
                    last = view
                if k + steps[m] < horizon:
                    value += ahead[k + steps[m], target[m]]
                if k == t:
                    bounds[m - start[c]] = value
                best = max(best, value)
            ahead[k, c] = best


@numba.njit(cache=True)
def look(view: int, free: Array, worth: Array, looks: Any) -> float:
    """Take from a belief what a viewpoint sees, and return what that is worth."""
    row, state, chance, _ = looks
    value = 0.0
    for e in range(row[view], row[view + 1]):
        mass = chance[e] * free[state[e]]
        value += mass * worth[state[e]]
        free[state[e]] -= mass
    return value


@numba.njit(cache=True)
def fix_looks(gaze: Whole, begin: int, until: int, before: Array, unseen: Array, looks: Any) -> None:
    """Write to ``unseen`` (H, N) what is left of each state by ``before`` and by looks ``gaze`` between two steps."""
    row, state, chance, _ = looks
    unseen[:] = before
    for t in range(begin, until):
        for e in range(row[gaze[t]], row[gaze[t] + 1]):
            unseen[t, state[e]] *= 1.0 - chance[e]


@numba.njit(cache=True)
def open_node(level: int, task: Any, nodes: Any, tables: Any) -> None:
    """Bound every move at a node: what is got so far, by the pursuer whose turn it is, and by those after it."""
    begin, motion, looks, moves, kind, first, twins, weight = task
    owner, when, where, value, bounds, used, _ = nodes
    free, unseen, worth, gaze, ahead, reach = tables
    q, t, cell = owner[level], when[level], where[level]
    team = len(kind)
    start, target, steps, views = moves
    own = (start, target, steps[kind[q]], views[kind[q]])
    certain = value[0]
    used[level] = False
    relax(t, cell, free[level], unseen[q], worth[q], motion, looks, own, ahead, reach, bounds[level])
    later = 0.0
    if q + 1 < team:
        # What the pursuers after this one can add at most, beside the looks that are certain by now.
        fix_looks(gaze[q], first[q, 0], t, unseen[q], unseen[team], looks)
        values_from(weight, unseen[team], motion, worth[team])
        spare, scratch = free[-1], bounds[-1]
        for p in range(q + 1, team):
            spare[0] = begin
            for k in range(first[p, 0]):
                disperse(spare[k], spare[k + 1], motion, unseen[team, k])
            other = (start, target, steps[kind[p]], views[kind[p]])
            t0, place = first[p, 0], first[p, 1]
            relax(t0, place, spare, unseen[team], worth[team], motion, looks, other, ahead, reach, scratch)
            later += ahead[t0, place]
    for i in range(start[cell + 1] - start[cell]):
        total = value[level] + bounds[level, i]
        # Of two pursuers that may change places, the first can be taken to be the one that alone would add more.
        bounds[level, i] = total + (min(later, total - certain) if twins and q == 0 else later)


@numba.njit(cache=True)
def start_pursuer(level: int, q: int, total: float, task: Any, nodes: Any, tables: Any) -> None:
    """Make a node the first one of a pursuer's path."""
    begin, motion, _, _, _, first, _, _ = task
    owner, when, where, value, _, _, _ = nodes
    free, unseen, _, _, _, _ = tables
    free[level, 0] = begin
    for k in range(first[q, 0]):
        disperse(free[level, k], free[level, k + 1], motion, unseen[q, k])
    owner[level], when[level], where[level], value[level] = q, first[q, 0], first[q, 1], total
    open_node(level, task, nodes, tables)


@numba.njit(cache=True)
def search(level: int, best: float, budget: int, task: Any, nodes: Any, tables: Any, answer: Whole) -> Any:
    """Go on with a depth-first branch and bound over one pursuer's moves after another's.

    Parameters
    ----------
    level : int
        Where the search stands; ``begin_search`` gives 0.
    best : float
        Value of the best plan known.
    budget : int
        Nodes to open before returning.
    task, nodes, tables : tuple
        What :class:`planners.branching.JointSearch` prepares; the last two hold the state of the search.
    answer : ndarray of int64, shape (levels,)
        The moves of the best plan found, one pursuer's after another's, -1 after the last.

    Returns
    -------
    tuple
        ``(level, best, opened)``; the search has ended when the level is below 0.
    """
    _, motion, looks, (start, target, steps, views), kind, first, _, weight = task
    owner, when, where, value, bounds, used, chosen = nodes
    free, unseen, worth, gaze, _, _ = tables
    team, horizon, opened = len(kind), unseen.shape[1], 0
    while level >= 0 and opened < budget:
        q, t, cell = owner[level], when[level], where[level]
        move, bound = -1, best * (1.0 + 1e-10) + 1e-14
        for m in range(start[cell], start[cell + 1]):
            if not used[level, m - start[cell]] and bounds[level, m - start[cell]] > bound:
                move, bound = m, bounds[level, m - start[cell]]
        if move < 0:
            level -= 1
            continue
        opened += 1
        used[level, move - start[cell]] = True
        chosen[level] = move
        total, end = value[level], min(t + steps[kind[q], move], horizon)
        path = free[level + 1]
        path[t] = free[level, t]
        for k in range(t, end):
            disperse(path[k], path[k + 1], motion, unseen[q, k])
            gaze[q, k] = views[kind[q], move, k - t]
            total += look(gaze[q, k], path[k + 1], worth[q, k + 1], looks)
        if end < horizon:
            level += 1
            owner[level], when[level], where[level], value[level] = q, end, target[move], total
            open_node(level, task, nodes, tables)
        elif q + 1 < team:
            fix_looks(gaze[q], first[q, 0], horizon, unseen[q], unseen[q + 1], looks)
            values_from(weight, unseen[q + 1], motion, worth[q + 1])
            level += 1
            start_pursuer(level, q + 1, total, task, nodes, tables)
        elif total > best:
            best = total
            answer[:] = -1
            answer[: level + 1] = chosen[: level + 1]
    return level, best, opened


@numba.njit(cache=True)
def begin_search(value: float, task: Any, nodes: Any, tables: Any) -> int:
    """Open the root and return its level; ``value`` is that of the looks that are certain."""
    _, motion, _, _, _, _, _, weight = task
    _, unseen, worth, _, _, _ = tables
    values_from(weight, unseen[0], motion, worth[0])
    start_pursuer(0, 0, value, task, nodes, tables)
    return 0


@numba.njit(cache=True)
def open_bound(level: int, best: float, task: Any, nodes: Any) -> float:
    """Return the most that any plan can be worth as far as the search has come."""
    start = task[3][0]
    _, _, where, _, bounds, used, _ = nodes
    bound = best
    for k in range(level + 1):
        for i in range(start[where[k] + 1] - start[where[k]]):
            if not used[k, i]:
                bound = max(bound, bounds[k, i])
    return bound
