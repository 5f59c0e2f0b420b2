"""Cells as the paper suggests for future work: a minimum cover by prime implicants, overlaps collapsed.

What W. V. Quine (1952) and E. J. McCluskey (1956) do with terms of a Boolean function is done with pieces of floor:
pieces are joined into maximal nearly convex unions, the fewest unions that cover all pieces are found exactly, and
where two of them overlap the overlap goes to one.
"""

from collections.abc import Iterator, Sequence

import numpy as np
import shapely

from discretize.exact import exact_cells
from discretize.implicants import Pieces, Union, grow, prime_implicants
from discretize.rays import arrangement, extension_rays
from discretize.triangulation import door_edges
from maps import FloorPlan

__all__ = ["minimum_cover", "quine_mccluskey_cells"]

_RAYS, _PIECES = 1000, 1000
"""Most rays along which free space is cut into pieces, and most pieces; else pieces are exact cells."""

_NODES = 2000
"""Most nodes of the search for a minimum cover; beyond that the best cover found is taken."""


_SHUFFLES = 8
"""Orders tried at random in which overlaps are given away, besides the largest and the smallest union first."""


def quine_mccluskey_cells(plan: FloorPlan) -> list[shapely.Polygon]:
    """Cut free space into a minimum cover of nearly convex cells, overlaps collapsed.

    Pieces are made by the extensions of walls past reflex corners; where these are too many, as on scans, by
    :func:`exact_cells`.

    Parameters
    ----------
    plan : FloorPlan
        Free space and doors.
    """
    doors = door_edges(plan)
    rays = extension_rays(plan, doors)
    shapes = arrangement(plan, rays) if len(rays) <= _RAYS else []
    if not 0 < len(shapes) <= _PIECES:
        shapes = exact_cells(plan)
    pieces = Pieces(tuple(shapes), doors)
    cover = minimum_cover(len(shapes), prime_implicants(pieces))
    parts = _join(pieces, _collapse(pieces, cover))
    shapes = [shape for part in parts for shape in shapely.get_parts(pieces.shape(part))]
    return [shape for shape in shapes if isinstance(shape, shapely.Polygon)]


def minimum_cover(n: int, unions: Sequence[Union]) -> list[Union]:
    """Find the fewest unions that hold each of n pieces.

    Parameters
    ----------
    n : int
        How many pieces there are.
    unions : sequence of frozenset of int
        Together they hold every piece.
    """
    from scipy.optimize import Bounds, LinearConstraint, milp
    from scipy.sparse import csr_array

    which = np.repeat(np.arange(len(unions)), [len(union) for union in unions])
    piece = np.array([k for union in unions for k in sorted(union)])
    holds = csr_array((np.ones(len(piece)), (piece, which)), shape=(n, len(unions)))
    found = milp(
        np.ones(len(unions)),
        integrality=np.ones(len(unions), dtype=np.int64),
        bounds=Bounds(0, 1),
        constraints=LinearConstraint(holds, lb=1),
        options={"node_limit": _NODES},
    )
    if found.x is None:
        return _greedy_cover(n, unions)
    return [unions[k] for k in np.flatnonzero(found.x > 0.5).tolist()]


def _greedy_cover(n: int, unions: Sequence[Union]) -> list[Union]:
    """Take again and again the union that holds most of what is not yet held."""
    left, chosen = set(range(n)), []
    while left:
        chosen.append(max(unions, key=lambda union: len(left & union)))
        left -= chosen[-1]
    return chosen


def _collapse(pieces: Pieces, cover: list[Union]) -> list[Union]:
    """Give every piece to one union, in the order that leaves the fewest parts of those tried."""
    trials = []
    for order in _orders(pieces, cover):
        taken: Union = frozenset()
        parts: list[Union] = []
        for union in order:
            parts += _parts(pieces, union - taken)
            taken |= union
        trials.append(parts)
    return min(trials, key=len)


def _orders(pieces: Pieces, cover: list[Union]) -> Iterator[list[Union]]:
    large_first = sorted(cover, key=pieces.rank)
    yield large_first
    yield large_first[::-1]
    rng = np.random.default_rng(0)
    for _ in range(_SHUFFLES):
        yield [large_first[k] for k in rng.permutation(len(cover))]


def _parts(pieces: Pieces, rest: Union) -> list[Union]:
    """Cut what is left of a union into implicants, the largest first."""
    parts: list[Union] = []
    while rest:
        if len(rest) == 1 or (pieces.connected(rest) and pieces.holds(rest)):
            return [*parts, rest]
        part = grow(pieces, max(rest, key=lambda k: (round(float(pieces.areas[k]), 9), -k)), within=rest)
        parts.append(part)
        rest -= part
    return parts


def _join(pieces: Pieces, parts: list[Union]) -> list[Union]:
    """Join parts while two together are an implicant, the smallest first."""
    todo = sorted(parts, key=pieces.rank)
    left = set(parts)
    while todo:
        small = todo.pop()
        if small in left:
            near = {j for k in small for j in pieces.neighbours[k]}
            others = sorted((part for part in left if part != small and part & near), key=pieces.rank)
            other = next((part for part in others if pieces.holds(small | part)), None)
            if other is not None:
                left -= {small, other}
                left.add(small | other)
                todo.append(small | other)
    return sorted(left, key=pieces.rank)
