"""The compiled search for a team's joint plan: one pursuer's moves after another's, bounded by priced looks.

The bound. Let priced looks take a share ``y[t, s]`` of what is in state ``s`` after step ``t``, and let ``V(A)`` be the
value of looks ``A``. Since what looks add only shrinks as others are added, for any prices

    V(p_1, ..., p_n)  <=  V(y, p_1, ..., p_n)  <=  V(y) + sum_i (V(y, p_i) - V(y)).

Each term of the sum is largest for a path that one pursuer finds alone, by a search that takes a fraction of a
millisecond. Without prices the sum counts mass twice that two pursuers would like to take; prices that are low where
nobody looks and high where many would look are found by subgradient steps on the right-hand side, a bound for any
prices. (A Lagrangian relaxation of "everybody is caught at most once".) Importing this module imports numba.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from planners.kernels import (
    ANYWHERE,
    Array,
    Look,
    Mask,
    Motion,
    Path,
    Stack,
    Ways,
    Whole,
    best_path,
    compiled,
    disperse,
    gain_along,
    inner,
    keep,
    relax,
    take,
    values_from,
    weigh,
)

__all__ = ["AT_FIRST", "Nodes", "Room", "Task", "search"]

# The level of a search that has not begun.
AT_FIRST = -2

# A look is never priced away wholly, so that its price can fall again.
DEAREST = 0.98

# Branches of one pursuer's search that can close no more than this share of the gap are left out while prices are set.
SLACK = 0.3

# Rounds of prices at the root and at other nodes, and steps that must be left for them to cost less than they save.
ROOT_ROUNDS, ROUNDS, LEAST_LEFT = 15, 4, 3

# Polyak's step for prices is the gap to the best value known over the slope's square; it is taken so many times, and
# the gap as at least this share of the value. By measurement, see ``tests/benchmarks/planning.py``.
STRIDE, LEAST_GAP = 1.8, 0.005

# Longest search for one pursuer's path while prices are set, and for the last pursuer's path, nodes; what is not
# searched enters the bound.
LONGEST, LONGEST_LAST = 2_000, 1_000_000

# Plans that are better by less than this share are not looked for: rounding.
EQUAL = 1e-10


class Task(NamedTuple):
    """What to solve: belief, weights of steps, models, and for each pursuer its kind and when and where it is free."""

    begin: Array
    weight: Array
    motion: Motion
    looks: Look
    ways: Ways
    kind: Whole
    first: Whole
    alike: bool


class Nodes(NamedTuple):
    """The open nodes, a level for each move of each pursuer: whose move it is, when and where, and what is known.

    ``value`` is what fixed looks and prices are worth together, ``bounds`` the most that a plan with each move can be
    worth, ``later`` what the pursuers after this one can add at most. ``frame`` is the level whose ``price`` holds,
    with ``kept`` left by prices and earlier pursuers, and ``worth`` beside them. ``root`` (levels, H + 1, N) and
    ``gain`` are the belief beside the prices of the root, and what the first pursuer has added to them. ``gaze``
    (R, H) are the looks that are fixed.
    """

    owner: Whole
    when: Whole
    where: Whole
    value: Array
    bounds: Array
    used: Mask
    move: Whole
    later: Array
    free: Array
    frame: Whole
    price: Array
    kept: Array
    worth: Array
    root: Array
    gain: Array
    gaze: Whole


class Room(NamedTuple):
    """Arrays to work in, the paths of all pursuers, and the best plan.

    ``certain`` (R, H, N) is what is left by looks that are fixed before each pursuer's turn; ``moves``, ``gaze`` and
    ``place`` are paths that answered prices, a row for each pursuer; ``summary`` holds the most that a branch left out
    could be worth, what the root's prices are worth, and the root's bound.
    """

    certain: Array
    left: Array
    worth: Array
    spare: Array
    value: Array
    seen: Array
    slope: Array
    kept: Array
    cheapest: Array
    stack: Stack
    ahead: Array
    moves: Whole
    gaze: Whole
    place: Whole
    plan: Whole
    summary: Array


@inner
def ways_of(pursuer: int, task: Task) -> Ways:
    """Return the moves of one pursuer."""
    start, target, steps, views, ptr, tail, head, both = task.ways
    kind = task.kind[pursuer]
    return Ways(start, target, steps[kind], views[kind], ptr[kind], tail, head, both)


@inner
def origin(pursuer: int, level: int, task: Task, nodes: Nodes) -> Any:
    """Return when and where the free part of a pursuer's path begins, as seen from a node."""
    if pursuer == nodes.owner[level]:
        return nodes.when[level], nodes.where[level]
    return task.first[pursuer, 0], task.first[pursuer, 1]


@inner
def same_as(pursuer: int, level: int, task: Task, nodes: Nodes) -> int:
    """Return the first pursuer, from the node's own on, that has the same moves and origin."""
    for other in range(nodes.owner[level], pursuer):
        same_place = origin(other, level, task, nodes) == origin(pursuer, level, task, nodes)
        if same_place and task.kind[other] == task.kind[pursuer]:
            return other
    return pursuer


@inner
def answer(level: int, slack: float, task: Task, nodes: Nodes, room: Room) -> Any:
    """Return what the node's pursuer and those after it can add at most, each for itself, beside ``room.left``."""
    q, own, later = nodes.owner[level], 0.0, 0.0
    most = np.zeros(len(task.kind))
    for p in range(q, len(task.kind)):
        twin = same_as(p, level, task, nodes)
        if twin < p:
            most[p] = most[twin]
            room.gaze[p], room.place[p] = room.gaze[twin], room.place[twin]
        else:
            t, cell = origin(p, level, task, nodes)
            free, known = room.stack.free[0], -1.0
            free[0] = task.begin
            for k in range(t):
                disperse(free[k], free[k + 1], task.motion, room.left[k])
            if room.place[p, t] == cell:
                known = gain_along(room.gaze[p], t, free, room.left, room.worth, task.motion, task.looks)
            path = Path(room.moves[p], room.gaze[p], room.place[p])
            most[p] = best_path(
                t, cell, room.left, room.worth, task.motion, task.looks, ways_of(p, task), room.stack, path,
                ANYWHERE, known, slack, LONGEST,
            )[1]  # fmt: skip
        if p == q:
            own = most[p]
        else:
            later += most[p]
    return own, later


@inner
def find_slope(level: int, task: Task, nodes: Nodes, room: Room) -> float:
    """Write to ``room.slope`` how the bound changes with each price; return the square of its length.

    ``room.certain[-1]`` holds what fixed looks leave, ``room.seen`` and ``room.worth`` belong to the prices now.
    """
    q, team, certain, price = nodes.owner[level], len(task.kind), room.certain[-1], nodes.price[level]
    horizon, states = certain.shape
    slopes = room.slope
    for t in range(horizon):
        for s in range(states):
            slopes[t, s] = (q + 1 - team) * certain[t, s] * room.seen[t, s] * room.worth[t + 1, s]
    for p in range(q, team):
        begin, _ = origin(p, level, task, nodes)
        room.spare[:] = certain
        keep(room.gaze[p], begin, horizon, room.spare, task.looks)
        leave(room.spare, price, room.kept)
        values_from(task.weight, room.kept, task.motion, room.value)
        weigh(task.begin, task.weight, room.kept, task.motion, room.seen)
        for t in range(horizon):
            for s in range(states):
                slopes[t, s] += room.spare[t, s] * room.seen[t, s] * room.value[t + 1, s]
    length = 0.0
    for t in range(horizon):
        for s in range(states):
            slope = slopes[t, s]
            if (slope > 0 and price[t, s] <= 0) or (slope < 0 and price[t, s] >= DEAREST):
                slopes[t, s] = 0.0
            length += slopes[t, s] ** 2
    return length


@inner
def leave(certain: Array, price: Array, left: Array) -> None:
    """Write to ``left`` what certain looks and priced looks leave together, all (H, N)."""
    for t in range(len(left)):
        for s in range(left.shape[1]):
            left[t, s] = certain[t, s] * (1.0 - price[t, s])


@inner
def step_down(length: float, slope: Array, price: Array) -> None:
    """Change prices by a step against the slope."""
    for t in range(len(price)):
        for s in range(price.shape[1]):
            price[t, s] = min(DEAREST, max(0.0, price[t, s] - length * slope[t, s]))


@inner
def set_prices(level: int, rounds: int, gap: float, best: float, task: Task, nodes: Nodes, room: Room) -> float:
    """Find prices at a node by subgradient steps; return the lowest bound, and make the node a frame."""
    q, t, price, certain = nodes.owner[level], nodes.when[level], nodes.price[level], room.certain[-1]
    certain[:] = room.certain[q]
    keep(nodes.gaze[q], task.first[q, 0], t, certain, task.looks)
    lowest = np.inf
    for k in range(rounds):
        leave(certain, price, room.left)
        values_from(task.weight, room.left, task.motion, room.worth)
        value = weigh(task.begin, task.weight, room.left, task.motion, room.seen)
        own, later = answer(level, SLACK * gap / len(task.kind), task, nodes, room)
        bound = value + own + later
        if bound < lowest:
            lowest = bound
            room.cheapest[:] = price
            nodes.value[level], nodes.later[level] = value, later
        gap = max(0.0, lowest - best)
        if lowest <= best or k == rounds - 1:
            break
        length = find_slope(level, task, nodes, room)
        if length <= 0:
            break
        length = STRIDE * max(bound - best, LEAST_GAP * best) / length
        step_down(length, room.slope, price)
    price[:] = room.cheapest
    nodes.frame[level] = level
    leave(room.certain[q], price, nodes.kept[level])
    values_from(task.weight, nodes.kept[level], task.motion, nodes.worth[level])
    free = nodes.free[level]
    free[0] = task.begin
    for k in range(t):
        disperse(free[k], free[k + 1], task.motion, nodes.kept[level, k])
        if k >= task.first[q, 0]:
            take(nodes.gaze[q, k], free[k + 1], nodes.worth[level, k + 1], task.looks)
    return lowest


@inner
def open_node(level: int, most: float, best: float, task: Task, nodes: Nodes, room: Room) -> bool:
    """Bound every move at a node; return whether any plan through it can be better than the best one.

    Prices are found anew where a search is far from its end: there they cost less than they save.
    """
    q, t, cell = nodes.owner[level], nodes.when[level], nodes.where[level]
    left = len(task.weight) - 1 - t
    fresh = level == 0 or nodes.owner[level - 1] < q
    rounds = ROOT_ROUNDS if level == 0 else ROUNDS if fresh or left >= LEAST_LEFT else 0
    nodes.used[level] = False
    if rounds:
        if level:
            nodes.price[level] = nodes.price[nodes.frame[level - 1]]
        if set_prices(level, rounds, most - best, best, task, nodes, room) <= best:
            return False
    else:
        nodes.frame[level] = nodes.frame[level - 1]
        nodes.later[level] = min(nodes.later[level - 1], relax_later(level, task, nodes, room))
    frame, bounds = nodes.frame[level], nodes.bounds[level]
    relax(
        t, cell, nodes.free[level], nodes.kept[frame], nodes.worth[frame], task.motion, task.looks, ways_of(q, task),
        room.stack, bounds, ANYWHERE,
    )  # fmt: skip
    for i in range(len(bounds)):
        bounds[i] += nodes.value[level] + nodes.later[level]
    if level == 0:
        room.ahead[:] = room.stack.ahead
        room.summary[1] = nodes.value[0]
        nodes.root[0], nodes.gain[0] = nodes.free[0], 0.0
    return True


@inner
def relax_later(level: int, task: Task, nodes: Nodes, room: Room) -> float:
    """Bound what the pursuers after the node's own can add beside the looks fixed by now and the prices."""
    q, total, free = nodes.owner[level], 0.0, room.stack.free[0]
    room.left[:] = nodes.kept[nodes.frame[level]]
    keep(nodes.gaze[q], task.first[q, 0], nodes.when[level], room.left, task.looks)
    values_from(task.weight, room.left, task.motion, room.worth)
    for p in range(q + 1, len(task.kind)):
        t, cell = task.first[p, 0], task.first[p, 1]
        free[0] = task.begin
        for k in range(t):
            disperse(free[k], free[k + 1], task.motion, room.left[k])
        relax(
            t, cell, free, room.left, room.worth, task.motion, task.looks, ways_of(p, task), room.stack,
            room.stack.bounds[0], ANYWHERE,
        )  # fmt: skip
        total += room.stack.ahead[t, cell]
    return total


@inner
def advance(level: int, move: int, task: Task, nodes: Nodes, room: Room) -> bool:
    """Simulate a move into the next level; return whether it is left out, since its pursuer would add too little.

    Of pursuers that may change places, the first can be taken to be the one that adds most beside the root's prices.
    """
    q, t, frame = nodes.owner[level], nodes.when[level], nodes.frame[level]
    ways, horizon, total, gain = ways_of(q, task), len(task.weight) - 1, nodes.value[level], nodes.gain[level]
    free, root = nodes.free[level + 1], nodes.root[level + 1]
    end = min(t + ways.steps[move], horizon)
    free[t], root[t] = nodes.free[level, t], nodes.root[level, t]
    for k in range(t, end):
        view = ways.views[move, k - t]
        nodes.gaze[q, k] = view
        disperse(free[k], free[k + 1], task.motion, nodes.kept[frame, k])
        total += take(view, free[k + 1], nodes.worth[frame, k + 1], task.looks)
        if task.alike and q == 0:
            disperse(root[k], root[k + 1], task.motion, nodes.kept[0, k])
            gain += take(view, root[k + 1], nodes.worth[0, k + 1], task.looks)
    nodes.owner[level + 1], nodes.when[level + 1], nodes.where[level + 1] = q, end, ways.target[move]
    nodes.value[level + 1], nodes.gain[level + 1] = total, gain
    if not (task.alike and q == 0):
        return False
    return bool(room.summary[1] + len(task.kind) * (gain + room.ahead[end, ways.target[move]]) <= room.summary[0])


@inner
def answer_last(best: float, task: Task, room: Room) -> float:
    """Find the best path of the last pursuer beside all others'; return the value of the best plan known."""
    p, free = len(task.kind) - 1, room.stack.free[0]
    t, cell, left = task.first[p, 0], task.first[p, 1], room.certain[p]
    values_from(task.weight, left, task.motion, room.worth)
    value = weigh(task.begin, task.weight, left, task.motion, room.seen)
    free[0] = task.begin
    for k in range(t):
        disperse(free[k], free[k + 1], task.motion, left[k])
    path = Path(room.moves[p], room.gaze[p], room.place[p])
    wanted = best * (1.0 + EQUAL) - value
    gain, bound, _ = best_path(
        t, cell, left, room.worth, task.motion, task.looks, ways_of(p, task), room.stack, path, ANYWHERE, wanted, 0.0,
        LONGEST_LAST,
    )  # fmt: skip
    if bound > gain:
        room.summary[2] = max(room.summary[2], value + bound)
    return value + gain if gain > wanted else best


@inner
def write_plan(level: int, nodes: Nodes, room: Room) -> None:
    """Note the plan that the nodes and the last pursuer's path make."""
    room.plan[:] = -1
    room.plan[-1] = room.moves[-1]
    k = 0
    for i in range(level + 1):
        k = k + 1 if i and nodes.owner[i] == nodes.owner[i - 1] else 0
        room.plan[nodes.owner[i], k] = nodes.move[i]


@compiled
def search(level: int, best: float, budget: int, task: Task, nodes: Nodes, room: Room) -> Any:
    """Go on with a depth-first branch and bound over one pursuer's moves after another's.

    Parameters
    ----------
    level : int
        Where the search stands; :data:`AT_FIRST` to begin.
    best : float
        Value of the best plan known.
    budget : int
        Nodes to open before returning.
    task, nodes, room : tuple
        What :class:`planners.branching.JointSearch` prepares; the last two hold the state of the search.

    Returns
    -------
    tuple
        ``(level, best, opened)``; the search has ended when the level is below 0.
    """
    opened, team, horizon = 0, len(task.kind), len(task.weight) - 1
    if level == AT_FIRST:
        room.summary[0] = room.summary[2] = best
        nodes.owner[0], nodes.when[0], nodes.where[0] = 0, task.first[0, 0], task.first[0, 1]
        level = 0
        if not open_node(level, best, best, task, nodes, room):
            level = -1
    while level >= 0 and opened < budget:
        q, cell, first = nodes.owner[level], nodes.where[level], task.ways.start[nodes.where[level]]
        most, move = best * (1.0 + EQUAL), -1
        for i in range(task.ways.start[cell + 1] - first):
            if not nodes.used[level, i] and nodes.bounds[level, i] > most:
                most, move = nodes.bounds[level, i], first + i
        if move < 0:
            level -= 1
            continue
        opened += 1
        nodes.used[level, move - first] = True
        nodes.move[level] = move
        room.summary[0] = best
        if advance(level, move, task, nodes, room):
            continue
        if nodes.when[level + 1] == horizon:
            room.certain[q + 1] = room.certain[q]
            keep(nodes.gaze[q], task.first[q, 0], horizon, room.certain[q + 1], task.looks)
            if q + 2 == team:
                better = answer_last(best, task, room)
                if better > best:
                    best = better
                    write_plan(level, nodes, room)
                continue
            nodes.owner[level + 1] = q + 1
            nodes.when[level + 1], nodes.where[level + 1] = task.first[q + 1, 0], task.first[q + 1, 1]
        if open_node(level + 1, most, best * (1.0 + EQUAL), task, nodes, room):
            level += 1
    return level, best, opened
