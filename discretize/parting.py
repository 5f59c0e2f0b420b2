"""Cells of any shape that hold places a body cannot get to from one another are several cells."""

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.reach import Reach
from discretize.rooms.rays import lines_of
from discretize.sharing import segment_tree, shared_segments

__all__ = ["part_cells"]

_SHORT = 2.02
"""Longest chord, in radii, between two walls through which a body does not pass: its diameter and a hair."""

_SPECK = 0.05
"""A place smaller than this that belongs to the same part of the reach as a larger one needs no cell, square metres."""

_NOOK = 16.0
"""A place smaller than this that was cut off goes to the cell from which a body gets there, squares of its radius."""

_BEYOND = 1e-6
"""Chords are carried on so far beyond both ends, that they meet the outline whatever the rounding, metres."""

Polygons = NDArray[np.object_]


def part_cells(cells: Sequence[shapely.Polygon], reach: Reach) -> list[shapely.Polygon]:
    """Cut cells along chords on which the body's centre cannot be, where it can be on both sides.

    So every connected part of the reach has cells of its own, and a body can cross each cell that it can enter.

    Parameters
    ----------
    cells : sequence of shapely.Polygon
        They may have holes, metres.
    reach : Reach
        Where the body's centre can be.
    """
    done: list[shapely.Polygon] = []
    nooks: list[int] = []
    for cell in cells:
        places = _places(cell, reach)
        pieces = [cell] if len(places) < 2 else _parted(cell, places, reach)
        small = [reach.within(piece).area < _NOOK * reach.radius**2 for piece in pieces[1:]]
        nooks += [len(done) + 1 + k for k in np.flatnonzero(small).tolist()]
        done += pieces
    return _handed_over(done, nooks, reach) if nooks else done


def _handed_over(cells: list[shapely.Polygon], nooks: list[int], reach: Reach) -> list[shapely.Polygon]:
    """Join each nook to the neighbour with the widest opening, if a body can cross what they make together."""
    pairs, segments = shared_segments(cells)
    rows = np.flatnonzero(np.isin(pairs, nooks).any(axis=1))
    owner, openings = reach.openings(segments[rows])
    length = np.hypot(*(openings[:, 1] - openings[:, 0]).T)
    wide: dict[int, dict[int, float]] = {}
    for (a, b), width in zip(pairs[rows[owner]].tolist(), length.tolist(), strict=True):
        for nook, other in ((a, b), (b, a)):
            if nook in nooks and other not in nooks:
                beside = wide.setdefault(nook, {})
                beside[other] = beside.get(other, 0.0) + width
    joined = dict(enumerate(cells))
    for nook, beside in wide.items():
        other = max(beside, key=lambda k: (beside[k], -k))
        union = shapely.union(joined[nook], joined[other])
        if isinstance(union, shapely.Polygon) and len(_places(union, reach)) == 1:
            joined[other] = union
            del joined[nook]
    return list(joined.values())


def _places(cell: shapely.Polygon, reach: Reach) -> Polygons:
    """Connected places of a cell in which a body can be, but for specks; the largest first."""
    found: Polygons = shapely.get_parts(reach.within(cell))
    found = found[(shapely.get_dimensions(found) == 2) & (shapely.area(found) > 0)]
    if len(found) < 2:
        return found
    found = found[np.argsort(-shapely.area(found), kind="stable")]
    part = reach.part_of(shapely.get_coordinates(shapely.point_on_surface(found)))
    first = np.zeros(len(found), dtype=np.bool_)
    first[np.unique(part, return_index=True)[1]] = True
    return np.asarray(found[first | (shapely.area(found) > _SPECK)])


def _parted(cell: shapely.Polygon, places: Polygons, reach: Reach) -> list[shapely.Polygon]:
    """One polygon for every place that chords part from the others; what holds none goes to a neighbour."""
    chords = _chords(cell, _SHORT * reach.radius)
    chords = _uncrossed(chords[~shapely.intersects(reach.area, shapely.linestrings(chords))])
    if len(chords) == 0:
        return [cell]
    along = chords[:, 1] - chords[:, 0]
    along *= (_BEYOND / np.hypot(*along.T))[:, None]
    lines = lines_of(np.stack([chords[:, 0] - along, chords[:, 1] + along], axis=1))
    linework = shapely.union_all([shapely.boundary(cell), *lines])
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(linework)))
    faces = faces[shapely.intersects(cell, shapely.point_on_surface(faces))]
    owner = np.full(len(faces), -1, dtype=np.intp)
    place, face = shapely.STRtree(faces).query(shapely.point_on_surface(places), predicate="intersects")
    owner[face[::-1]] = place[::-1]  # of several places that nothing parts the largest counts
    owner = _spread(faces, owner)
    unions = [shapely.union_all(faces[owner == k]) for k in np.unique(owner)]  # the one of the largest place first
    return [part for union in unions for part in shapely.get_parts(union)]


def _spread(faces: Polygons, owner: NDArray[np.intp]) -> NDArray[np.intp]:
    """Give every face without an owner to the one with which it shares most boundary, again and again."""
    i, j = shapely.STRtree(faces).query(faces, predicate="intersects")
    shared = shapely.length(shapely.intersection(faces[i], faces[j]))
    real = (i != j) & (shared > 10 * _BEYOND)
    i, j, shared = i[real], j[real], shared[real]
    owner = owner.copy()
    while True:
        ready = np.flatnonzero((owner[i] < 0) & (owner[j] >= 0))
        if len(ready) == 0:
            return owner
        best = ready[np.argmax(shared[ready])]
        owner[i[best]] = owner[j[best]]


def _chords(cell: shapely.Polygon, longest: float) -> NDArray[np.float64]:
    """Shortest ways inside a cell from each corner to each edge near it, the shortest first, shape (k, 2, 2)."""
    xy, ring = shapely.get_coordinates(shapely.get_rings(cell), return_index=True)
    follows = ring[1:] == ring[:-1]
    edges = np.stack([xy[:-1][follows], xy[1:][follows]], axis=1)
    corner, edge = segment_tree(edges).query(shapely.points(edges[:, 0]), predicate="dwithin", distance=longest)
    start, span = edges[corner, 0], edges[edge, 1] - edges[edge, 0]
    along = ((start - edges[edge, 0]) * span).sum(axis=1) / (span * span).sum(axis=1)
    chords = np.stack([start, edges[edge, 0] + np.clip(along, 0.0, 1.0)[:, None] * span], axis=1)
    length = np.hypot(*(chords[:, 1] - chords[:, 0]).T)
    chords = chords[length > 10 * _BEYOND]
    short = 0.5 * chords.mean(axis=1, keepdims=True) + 0.5 * chords  # its middle half, off the outline at both ends
    shapely.prepare(cell)
    chords = chords[shapely.contains_properly(cell, shapely.linestrings(short))]
    return np.asarray(chords[np.argsort(np.hypot(*(chords[:, 1] - chords[:, 0]).T).round(9), kind="stable")])


def _uncrossed(chords: NDArray[np.float64]) -> NDArray[np.float64]:
    """Drop every chord that crosses one before it."""
    lines = lines_of(chords)
    later, earlier = shapely.STRtree(lines).query(lines, predicate="crosses")
    rivals: dict[int, list[int]] = {}
    for k, other in zip(later.tolist(), earlier.tolist(), strict=True):
        if other < k:
            rivals.setdefault(k, []).append(other)
    kept = np.ones(len(chords), dtype=np.bool_)
    for k in sorted(rivals):
        kept[k] = not kept[rivals[k]].any()
    return np.asarray(chords[kept])
