"""The best way to cover every face exactly once with pooled unions: a minimum set partition, solved exactly."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from discretize.rooms.merging import Region

if TYPE_CHECKING:
    from scipy.optimize import OptimizeResult
    from scipy.sparse import csc_array

__all__ = ["partition"]

Array = NDArray[np.float64]

NODES = (
    60  # branch-and-bound nodes for each part of a plan: a limit in seconds would make results depend on the machine
)
SLACK = 1.0  # cost of a cell: by how much a partition may well be dearer than the relaxation
WHOLE = 1e-6  # numbers this near to 0 and 1 are
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
    from scipy.sparse import csc_array

    pool = sorted(pool, key=lambda r: sorted(r.faces))
    number = {face: k for k, face in enumerate(sorted(set().union(*(r.faces for r in pool))))}
    rows = [number[face] for region in pool for face in region.faces]
    starts = np.cumsum([0, *(len(region.faces) for region in pool)])
    matrix = csc_array((np.ones(len(rows)), rows, starts), shape=(len(number), len(pool)))
    costs = np.array([cost(region) for region in pool])
    # Nearly always the relaxation is solved by a partition, and ten times sooner than by branch and bound.
    relaxed = _relaxed(costs, matrix)
    if relaxed.x is None:
        return _largest_first(pool)
    x = relaxed.x
    if ((x > WHOLE) & (x < 1.0 - WHOLE)).any():
        x = _branch(costs, matrix, costs - matrix.T @ relaxed.eqlin.marginals, relaxed.fun)
        if x is None:
            return _largest_first(pool)
    return [region for region, share in zip(pool, x, strict=True) if share > 0.5]


def _relaxed(costs: Array, equations: Any) -> OptimizeResult:
    """Solve the relaxation, in which a column may be taken in part."""
    from scipy.optimize import linprog

    return linprog(costs, A_eq=equations, b_eq=np.ones(equations.shape[0]), method="highs-ds")


def _branch(costs: Array, matrix: csc_array, dearer: Array, least: float) -> Array | None:
    """Choose columns that cover each row once, given their reduced costs and the least cost of the relaxation.

    A column whose reduced cost exceeds what a known partition costs above the relaxation is in no better one. So few
    columns are tried first, and more only where the partition found leaves room for them.
    """
    from scipy.optimize import Bounds, LinearConstraint, milp

    slack = SLACK
    while True:
        kept = np.flatnonzero(dearer <= slack)
        result = milp(
            costs[kept],
            integrality=np.ones(len(kept), dtype=np.int64),
            bounds=Bounds(0.0, 1.0),
            constraints=LinearConstraint(matrix[:, kept], 1.0, 1.0),
            options={"node_limit": NODES, "mip_rel_gap": GAP},
        )
        if result.x is not None and (len(kept) == len(costs) or result.fun - least <= slack):
            x = np.zeros(len(costs))
            x[kept] = result.x
            return x
        if len(kept) == len(costs):
            return None
        slack = 4.0 * slack if result.x is None else float(result.fun - least)


def _largest_first(pool: list[Region]) -> list[Region]:
    """Return a partition without an optimum, should none have been found within the limit."""
    taken: set[int] = set()
    chosen = []
    for region in sorted(pool, key=lambda r: (-r.area, sorted(r.faces))):
        if taken.isdisjoint(region.faces):
            taken |= region.faces
            chosen.append(region)
    return chosen
