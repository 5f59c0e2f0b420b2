"""The compiled part of a search for one pursuer's best path; importing this module imports numba.

A plan's value is linear in the mass that a look takes: mass taken from state ``s`` after step ``t`` is worth
``worth[t, s]``. All functions work on beliefs (N,) without the capture state, over ``H`` steps, and on looks as sparse
rows; ``kept`` (H, N) is the share of each state that looks already fixed leave at each step.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar, cast

import numba
import numpy as np
from numpy.typing import NDArray

__all__ = [
    "ANYWHERE",
    "Look",
    "Motion",
    "Path",
    "Stack",
    "Ways",
    "best_path",
    "compiled",
    "disperse",
    "gain_along",
    "keep",
    "link_looks",
    "new_path",
    "new_stack",
    "take",
    "values_back",
    "values_from",
    "weigh",
]

Array = NDArray[np.float64]
Whole = NDArray[np.int64]
Mask = NDArray[np.bool_]

# The goal of a path that may end in any cell, or between two.
ANYWHERE = -1

Kernel = TypeVar("Kernel", bound=Callable[..., Any])


def compiled(function: Kernel) -> Kernel:
    """Compile a function that Python calls."""
    return cast(Kernel, numba.njit(cache=True)(function))


def inner(function: Kernel) -> Kernel:
    """Compile a function that compiled ones call: without the wrappers, which take longer to compile than itself."""
    without: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    return cast(Kernel, numba.njit(cache=True, **without)(function))


class Motion(NamedTuple):
    """The evader's transition matrix in compressed sparse rows."""

    ptr: Whole
    to: Whole
    share: Array


class Look(NamedTuple):
    """What each viewpoint sees, in compressed sparse rows."""

    row: Whole
    state: Whole
    chance: Array


class Ways(NamedTuple):
    """The moves of one kind of pursuer, as :class:`planners.simulation.Moves`, and what links two looks in a row.

    The links of step ``j`` of move ``m`` are those from ``ptr[m, j]`` to ``ptr[m, j + 1]``: the look sees a share
    ``both`` of what the evader carries from state ``tail`` to state ``head``, and so did the look before.
    """

    start: Whole
    target: Whole
    steps: Whole
    views: Whole
    ptr: Whole
    tail: Whole
    head: Whole
    both: Array


class Stack(NamedTuple):
    """The open nodes of a depth-first search for a path, a level for each move, and tables of its bound."""

    when: Whole
    where: Whole
    value: Array
    bounds: Array
    used: Mask
    move: Whole
    free: Array
    gaze: Whole
    ahead: Array
    reach: Mask
    sight: Array
    priced: Array


class Path(NamedTuple):
    """A path: the moves that it begins (-1 after the last), the viewpoint after each step, and where it is when.

    ``place[t]`` is the cell at whose checkpoint the pursuer stands after ``t`` steps, -1 if it is on its way.
    """

    moves: Whole
    gaze: Whole
    place: Whole


def new_stack(horizon: int, states: int, views: int, cells: int, widest: int) -> Stack:
    """Return room for a search over so many steps."""
    levels = horizon + 1
    return Stack(
        np.zeros(levels, dtype=np.int64),
        np.zeros(levels, dtype=np.int64),
        np.zeros(levels),
        np.zeros((levels, widest)),
        np.zeros((levels, widest), dtype=np.bool_),
        np.zeros(levels, dtype=np.int64),
        np.zeros((levels, horizon + 1, states)),
        np.zeros(horizon, dtype=np.int64),
        np.zeros((horizon + 1, cells)),
        np.zeros((horizon + 1, cells), dtype=np.bool_),
        np.zeros((horizon, views)),
        np.zeros((horizon, states)),
    )


def new_path(horizon: int) -> Path:
    """Return a path that is nowhere yet."""
    return Path(np.full(horizon, -1), np.full(horizon, -1), np.full(horizon + 1, -1))


@compiled
def link_looks(
    start: Whole, steps: Whole, views: Whole, motion: Motion, looks: Look, ptr: Whole, fill: bool,
    tail: Whole, head: Whole, both: Array,
) -> None:  # fmt: skip
    """Write to ``ptr`` where the links of each step of each move begin, and with ``fill`` the links, see `Ways`."""
    count = ptr[0, 0]
    cell = 0
    for m in range(len(steps)):
        if m == start[cell + 1]:
            cell += 1
        last = cell
        for j in range(steps[m]):
            ptr[m, j] = count
            view = views[m, j]
            for a in range(looks.row[last], looks.row[last + 1]):
                for q in range(motion.ptr[looks.state[a]], motion.ptr[looks.state[a] + 1]):
                    for b in range(looks.row[view], looks.row[view + 1]):
                        if looks.state[b] == motion.to[q]:
                            if fill:
                                tail[count], head[count] = looks.state[a], looks.state[b]
                                both[count] = looks.chance[a] * motion.share[q] * looks.chance[b]
                            count += 1
            last = view
        ptr[m, steps[m] :] = count


@inner
def disperse(free: Array, after: Array, motion: Motion, kept: Array) -> None:
    """Write to ``after`` the belief one step later; ``kept`` (N,) is what the others leave of each state."""
    after[:] = 0.0
    for s in range(len(free)):
        mass = free[s]
        if mass != 0.0:
            for e in range(motion.ptr[s], motion.ptr[s + 1]):
                after[motion.to[e]] += mass * motion.share[e]
    for s in range(len(after)):
        after[s] *= kept[s]


@compiled
def values_from(weight: Array, kept: Array, motion: Motion, worth: Array) -> None:
    """Write to ``worth`` (H + 1, N) what taking mass is worth beside looks that are already fixed.

    It is the weight of the step less what those looks, leaving ``kept`` (H, N), would get for that mass later.
    """
    worth[len(kept)] = weight[len(kept)]
    values_back(weight, kept, motion, worth)


@compiled
def values_back(weight: Array, kept: Array, motion: Motion, worth: Array) -> None:
    """Write all rows of ``worth`` before the last one, as :func:`values_from` does; the last row is known."""
    horizon, states = kept.shape
    for t in range(horizon - 1, -1, -1):
        for s in range(states):
            total = 0.0
            for e in range(motion.ptr[s], motion.ptr[s + 1]):
                to = motion.to[e]
                total += motion.share[e] * (weight[t + 1] - kept[t, to] * worth[t + 1, to])
            worth[t, s] = weight[t] - total


@compiled
def weigh(begin: Array, weight: Array, kept: Array, motion: Motion, seen: Array) -> float:
    """Return the value of looks that leave ``kept`` (H, N), and write to ``seen`` (H, N) the mass they could take."""
    total, free, ones = 0.0, begin.copy(), np.ones(len(begin))
    for t in range(len(kept)):
        disperse(free, seen[t], motion, ones)
        for s in range(len(free)):
            total += weight[t + 1] * seen[t, s] * (1.0 - kept[t, s])
            free[s] = seen[t, s] * kept[t, s]
    return total


@inner
def take(view: int, free: Array, worth: Array, looks: Look) -> float:
    """Take from a belief what a viewpoint sees, and return what that is worth."""
    value = 0.0
    for e in range(looks.row[view], looks.row[view + 1]):
        s = looks.state[e]
        mass = looks.chance[e] * free[s]
        value += mass * worth[s]
        free[s] -= mass
    return value


@inner
def keep(gaze: Whole, begin: int, until: int, kept: Array, looks: Look) -> None:
    """Take from ``kept`` (H, N) what looks ``gaze`` between two steps see."""
    for t in range(begin, until):
        for e in range(looks.row[gaze[t]], looks.row[gaze[t] + 1]):
            kept[t, looks.state[e]] *= 1.0 - looks.chance[e]


@inner
def gain_along(gaze: Whole, t: int, free: Array, kept: Array, worth: Array, motion: Motion, looks: Look) -> float:
    """Return what looks ``gaze`` from step ``t`` on add; ``free[t]`` is the belief, later rows are overwritten."""
    total = 0.0
    for k in range(t, len(kept)):
        disperse(free[k], free[k + 1], motion, kept[k])
        total += take(gaze[k], free[k + 1], worth[k + 1], looks)
    return total


@inner
def relax(
    t: int,
    cell: int,
    free: Array,
    kept: Array,
    worth: Array,
    motion: Motion,
    looks: Look,
    ways: Ways,
    stack: Stack,
    bounds: Array,
    goal: int,
) -> None:
    """Bound from above what one pursuer at a checkpoint can still get, for each of its moves.

    The relaxation: its looks take nothing from later ones, except that what one look has seen is not there for the
    next look (a step of memory; with none it is the MEAN bound of the search literature). Then the best path is
    found by dynamic programming over places and time. ``free[t]`` is the belief; later rows are overwritten.
    """
    # Arrays by names of their own, and neither rows nor calls inside the loops: each would cost more than the work.
    start, target, steps, views, ptr, tail, head, both = ways
    row, state, chance = looks
    ahead, reach, sight, priced = stack.ahead, stack.reach, stack.sight, stack.priced
    horizon, cells = len(kept), len(start) - 1
    reach[t:] = False
    reach[t, cell] = True
    for k in range(t, horizon):
        disperse(free[k], free[k + 1], motion, kept[k])
        for s in range(priced.shape[1]):
            priced[k, s] = kept[k, s] * worth[k + 1, s]
        sight[k] = -1.0
    for k in range(t, horizon):
        for c in range(cells):
            if not reach[k, c]:
                continue
            for m in range(start[c], start[c + 1]):
                for j in range(k, min(k + steps[m], horizon)):
                    view = views[m, j - k]
                    if sight[j, view] < 0.0:
                        seen = 0.0
                        for e in range(row[view], row[view + 1]):
                            seen += chance[e] * free[j + 1, state[e]] * worth[j + 1, state[e]]
                        sight[j, view] = seen
                if k + steps[m] <= horizon:
                    reach[k + steps[m], target[m]] = True
    ahead[horizon] = 0.0
    if goal >= 0:
        ahead[horizon] = -np.inf
        ahead[horizon, goal] = 0.0
    for k in range(horizon - 1, t - 1, -1):
        for c in range(cells):
            if not reach[k, c]:
                continue
            best = -np.inf
            for m in range(start[c], start[c + 1]):
                value, end = 0.0, k + steps[m]
                for j in range(k, min(end, horizon)):
                    value += sight[j, views[m, j - k]]
                    if j > t:
                        for e in range(ptr[m, j - k], ptr[m, j - k + 1]):
                            value -= both[e] * free[j, tail[e]] * priced[j, head[e]]
                if end <= horizon:
                    value += ahead[end, target[m]]
                elif goal >= 0:
                    value = -np.inf
                if k == t:
                    bounds[m - start[c]] = value
                best = max(best, value)
            ahead[k, c] = best


@compiled
def best_path(
    t: int,
    cell: int,
    kept: Array,
    worth: Array,
    motion: Motion,
    looks: Look,
    ways: Ways,
    stack: Stack,
    path: Path,
    goal: int,
    best: float,
    slack: float,
    budget: int,
) -> Any:
    """Find the path from a checkpoint that adds most, by depth-first branch and bound.

    Parameters
    ----------
    t, cell : int
        When and at whose checkpoint the path begins; ``stack.free[0, t]`` is the belief then.
    kept, worth : ndarray
        The looks that are fixed, and what mass is worth beside them.
    path : Path
        Overwritten from step ``t`` on if a path is found that adds more than ``best``.
    goal : int
        The cell at whose checkpoint the path must be at the end, or :data:`ANYWHERE`.
    best : float
        What the path adds that is known already.
    slack : float
        Branches that can add no more than so much above the best are left out.
    budget : int
        The search ends after about this many nodes.

    Returns
    -------
    tuple
        ``(best, bound, nodes)``: what the best path known adds, the most that any can add, nodes opened.
    """
    horizon, bound, nodes, level = len(kept), best, 0, 0
    stack.when[0], stack.where[0], stack.value[0] = t, cell, 0.0
    fresh = True
    while level >= 0:
        if fresh:
            stack.used[level] = False
            relax(
                stack.when[level], stack.where[level], stack.free[level], kept, worth, motion, looks, ways, stack,
                stack.bounds[level], goal,
            )  # fmt: skip
        fresh = False
        now, here = stack.when[level], stack.where[level]
        first, most, move = ways.start[here], -1.0, -1
        for i in range(ways.start[here + 1] - first):
            if not stack.used[level, i] and stack.value[level] + stack.bounds[level, i] > most:
                most, move = stack.value[level] + stack.bounds[level, i], first + i
        if move < 0 or most <= best + slack or nodes >= budget:
            bound = max(bound, most)
            level -= 1
            continue
        nodes += 1
        stack.used[level, move - first] = True
        stack.move[level] = move
        total, end = stack.value[level], min(now + ways.steps[move], horizon)
        free = stack.free[level + 1]
        free[now] = stack.free[level, now]
        for k in range(now, end):
            disperse(free[k], free[k + 1], motion, kept[k])
            stack.gaze[k] = ways.views[move, k - now]
            total += take(stack.gaze[k], free[k + 1], worth[k + 1], looks)
        if end < horizon:
            level += 1
            stack.when[level], stack.where[level], stack.value[level], fresh = end, ways.target[move], total, True
        elif total > best:
            best = total
            write_path(level, t, stack, path)
    return best, max(best, bound), nodes


@inner
def write_path(level: int, t: int, stack: Stack, path: Path) -> None:
    """Write the path to the node at a level, from step ``t`` on."""
    path.gaze[t:] = stack.gaze[t:]
    path.moves[:] = -1
    path.place[:] = -1
    for k in range(level + 1):
        path.moves[k] = stack.move[k]
        path.place[stack.when[k]] = stack.where[k]
