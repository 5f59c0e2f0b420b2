"""The best way to cover every face exactly once with pooled unions: a minimum set partition, solved exactly."""

from collections.abc import Callable, Sequence

import numpy as np

from discretize.rooms.merging import Region

__all__ = ["partition"]

NODES = (
    60  # branch-and-bound nodes for each part of a plan: a limit in seconds would make results depend on the machine
)
GAP = 0.002  # a partition whose cost is within this share of the least possible is good enough


def partition(
    pool: Sequence[Region],
    n: int,
    cost: Callable[[Region], float],
    sound: Callable[[Region], bool],
) -> list[Region]:
    """Choose regions that cover each face exactly once at least cost.

    Parameters
    ----------
    pool : sequence of Region
        Must contain every single face.
    n : int
        Number of faces.
    cost : callable
        Of a region; their sum is minimised.
    sound : callable
        A slower test that a chosen region must pass; others are chosen until all do.
    """
    parent = list(range(n))

    def root(x: int) -> int:
        while parent[x] != x:
            parent[x] = parent[parent[x]]
            x = parent[x]
        return x

    for region in pool:
        first, *rest = region.faces
        for face in rest:
            parent[root(face)] = root(first)
    groups: dict[int, list[Region]] = {}
    for region in pool:
        groups.setdefault(root(next(iter(region.faces))), []).append(region)
    chosen: list[Region] = []
    for group in groups.values():
        chosen += group if len(group) == 1 else _sound(group, cost, sound)
    return chosen


def _sound(pool: list[Region], cost: Callable[[Region], float], sound: Callable[[Region], bool]) -> list[Region]:
    """Solve, and again within every chosen region that is not sound, without it."""
    chosen: list[Region] = []
    for region in _solve(pool, cost):
        if len(region.faces) == 1 or sound(region):
            chosen.append(region)
        else:
            chosen += _sound([part for part in pool if part.faces < region.faces], cost, sound)
    return chosen


def _solve(pool: list[Region], cost: Callable[[Region], float]) -> list[Region]:
    from scipy.optimize import Bounds, LinearConstraint, milp
    from scipy.sparse import csc_array

    pool = sorted(pool, key=lambda r: sorted(r.faces))
    number = {face: k for k, face in enumerate(sorted(set().union(*(r.faces for r in pool))))}
    rows = [number[face] for region in pool for face in region.faces]
    starts = np.cumsum([0, *(len(region.faces) for region in pool)])
    matrix = csc_array((np.ones(len(rows)), rows, starts), shape=(len(number), len(pool)))
    result = milp(
        [cost(region) for region in pool],
        integrality=np.ones(len(pool), dtype=np.int64),
        bounds=Bounds(0.0, 1.0),
        constraints=LinearConstraint(matrix, 1.0, 1.0),
        options={"node_limit": NODES, "mip_rel_gap": GAP},
    )
    if result.x is None:
        return _largest_first(pool)
    return [region for region, x in zip(pool, result.x, strict=True) if x > 0.5]


def _largest_first(pool: list[Region]) -> list[Region]:
    """Return a partition without an optimum, should none have been found within the limit."""
    taken: set[int] = set()
    chosen = []
    for region in sorted(pool, key=lambda r: (-r.area, sorted(r.faces))):
        if taken.isdisjoint(region.faces):
            taken |= region.faces
            chosen.append(region)
    return chosen
