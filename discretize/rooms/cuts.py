"""Where a person might cut: doorways first, then the walls' own lines carried on into the room.

A cut starts at a reflex vertex, a corner that juts into the free space. A *neck* joins it by the locally shortest way to
another wall or corner; a neck is a *doorway* when the room is wider than the neck on both sides of it. Corners that no
doorway ends at, in parts of the plan that are not nearly convex as they are, get the extensions of their two walls.
"""

from dataclasses import dataclass

import numpy as np
import shapely
from discretize.rooms.rays import Walls
from numpy.typing import NDArray

__all__ = ["Corners", "corners", "doorways", "extensions", "necks", "ring_segments"]

Array = NDArray[np.float64]
Index = NDArray[np.intp]

REFLEX = np.radians(8.0)  # a corner that turns by less is a bend of a wall, not a corner
SLACK = 0.25  # cosine by which a wall may lean towards a neck that still counts as locally shortest
OPENS = 1.25  # a doorway: the free space is this much wider than the neck on either side of it
CLEAR = 1.6  # as much wider as this, and nobody doubts that it is one
OFFSETS = (0.15, 0.35, 0.6)  # how far from the neck that is looked at, in widths of the neck


@dataclass(frozen=True, slots=True)
class Corners:
    """Reflex vertices of free space.

    Attributes
    ----------
    points : ndarray, shape (N, 2)
        Metres.
    before, after : ndarray, shape (N, 2)
        Unit vectors from the corner along its two walls.
    """

    points: Array
    before: Array
    after: Array

    def __len__(self) -> int:
        return len(self.points)


def ring_segments(space: shapely.Geometry) -> Array:
    """Return every edge of every ring of polygons, free space on the left, shape (M, 2, 2)."""
    rings = shapely.get_rings(shapely.orient_polygons(space))
    coords, ring = shapely.get_coordinates(rings, return_index=True)
    inside = ring[1:] == ring[:-1]
    return np.stack([coords[:-1][inside], coords[1:][inside]], axis=1)


def corners(space: shapely.Geometry, least: float = REFLEX) -> Corners:
    """Find the reflex vertices of polygons: those that turn right by more than ``least`` radians."""
    points, before, after = [np.empty((0, 2))], [np.empty((0, 2))], [np.empty((0, 2))]
    for ring in shapely.get_rings(shapely.orient_polygons(space)):
        p = shapely.get_coordinates(ring)[:-1]
        incoming, outgoing = _unit(p - np.roll(p, 1, 0)), _unit(np.roll(p, -1, 0) - p)
        turn = np.arctan2(_cross(incoming, outgoing), (incoming * outgoing).sum(1))
        reflex = turn < -least
        points.append(p[reflex])
        before.append(-incoming[reflex])
        after.append(outgoing[reflex])
    return Corners(np.concatenate(points), np.concatenate(before), np.concatenate(after))


def necks(space: shapely.Geometry, at: Corners, reach: float, most: int = 4) -> tuple[Array, Index]:
    """Find, for each corner, the locally shortest ways across the free space.

    Parameters
    ----------
    space : shapely.Geometry
        Polygons on a grid of a millimetre.
    at : Corners
        Corners to start from.
    reach : float
        Longest neck, metres.
    most : int
        At most so many for a corner, the shortest ones.

    Returns
    -------
    segments : ndarray, shape (K, 2, 2)
        From the corner to the other side, shortest first.
    ends : ndarray, shape (K, 2)
        Number of the corner at either end, -1 where the far end is not one.
    """
    walls = ring_segments(space)
    tree = shapely.STRtree(shapely.linestrings(walls))
    v, e = tree.query(shapely.points(at.points), predicate="dwithin", distance=reach)
    p, a, b = at.points[v], walls[e, 0], walls[e, 1]
    along = b - a
    t = np.clip(((p - a) * along).sum(1) / (along**2).sum(1), 0.0, 1.0)
    q = a + t[:, None] * along
    width = np.hypot(*(q - p).T)
    direction = (q - p) / np.maximum(width, 1e-12)[:, None]
    good = (width > 2e-3) & ((direction * at.before[v]).sum(1) <= SLACK) & ((direction * at.after[v]).sum(1) <= SLACK)
    v, e, t, q, width, direction = v[good], e[good], t[good], q[good], width[good], direction[good]

    far = np.full(len(v), -1, dtype=np.intp)
    at_end = (t == 0.0) | (t == 1.0)
    number = {tuple(np.round(1e3 * c).astype(int)): k for k, c in enumerate(at.points)}
    for k in np.flatnonzero(at_end):
        far[k] = number.get(tuple(np.round(1e3 * q[k]).astype(int)), -1)
    corner = far >= 0
    meets = np.ones(len(v), dtype=bool)
    meets[corner] = ((-direction[corner] * at.before[far[corner]]).sum(1) <= SLACK) & (
        (-direction[corner] * at.after[far[corner]]).sum(1) <= SLACK
    )
    keep = meets & (corner | ~at_end)
    v, q, width, far = v[keep], q[keep], width[keep], far[keep]

    order = np.lexsort((q[:, 1], q[:, 0], np.round(width, 3)))
    v, q, width, far = v[order], q[order], width[order], far[order]
    once, seen = [], set()
    for k in range(len(v)):
        key = (min(v[k], far[k]), max(v[k], far[k])) if far[k] >= 0 else (v[k], *np.round(100 * q[k]))
        if key not in seen:
            seen.add(key)
            once.append(k)
    v, q, far = v[once], q[once], far[once]
    segments = np.stack([at.points[v], q], axis=1)
    visible = _inside(space, segments)
    segments, v, far = segments[visible], v[visible], far[visible]
    keep = _rank_within(v) < most
    return segments[keep], np.stack([v, far], axis=1)[keep]


def doorways(space: shapely.Geometry, segments: Array, ends: Index, n: int) -> tuple[Index, NDArray[np.bool_]]:
    """Choose the necks that are doorways, the narrowest first, so that none crosses or repeats another.

    Parameters
    ----------
    space : shapely.Geometry
        Polygons.
    segments, ends
        What :func:`necks` returns, shortest first.
    n : int
        Number of corners.

    Returns
    -------
    chosen : ndarray of int
        Rows of ``segments``.
    clear : ndarray of bool
        Which of them nobody would doubt.
    """
    width = np.hypot(*(segments[:, 1] - segments[:, 0]).T)
    tree = shapely.STRtree(shapely.linestrings(segments))
    rivals: list[list[int]] = [[] for _ in segments]
    for x, y in tree.query(shapely.linestrings(segments), predicate="dwithin", distance=0.5).T.tolist():
        if y < x:
            rivals[x].append(y)
    chosen = np.zeros(len(segments), dtype=bool)
    opening = np.zeros(len(segments))
    settled = np.zeros(n + 1, dtype=bool)
    settled[-1] = True
    stone = ring_segments(space)
    # A doorway already found closes the view through it, so that a hallway between two doors is not wider there.
    for start, stop in _classes(width):
        opening[start:stop] = _opening(Walls(np.concatenate([stone, segments[chosen]])), segments[start:stop])
        for k in (start + np.flatnonzero(opening[start:stop] >= OPENS)).tolist():
            if settled[ends[k]].all():
                continue
            taken = [r for r in rivals[k] if chosen[r]]
            repeats = any(same_cut(segments[k], segments[r]) for r in taken)
            if repeats or not any(_crosses(segments[k], segments[r]) for r in taken):
                settled[ends[k]] = True
                chosen[k] = not repeats
    return np.flatnonzero(chosen), opening[chosen] >= CLEAR


def _classes(width: Array) -> list[tuple[int, int]]:
    """Split sorted widths into runs within which the widest is at most a quarter wider than the narrowest."""
    runs, start = [], 0
    while start < len(width):
        stop = int(np.searchsorted(width, 1.25 * width[start], side="right"))
        runs.append((start, stop))
        start = stop
    return runs


def extensions(walls: Walls, at: Corners, reach: float) -> Array:
    """Carry both walls of each corner on into the free space until they meet a wall; shape (2 N, 2, 2)."""
    origins = np.concatenate([at.points, at.points])
    directions = -np.concatenate([at.before, at.after])
    length = walls.hits(origins, directions, np.full(len(origins), reach))
    return np.stack([origins, origins + length[:, None] * directions], axis=1)


def same_cut(s: Array, o: Array) -> bool:
    """Whether two cuts do the same: their ends lie close to each other, measured by their own length."""
    near = 0.35 * min(np.hypot(*(s[1] - s[0])), np.hypot(*(o[1] - o[0])))
    straight = max(np.hypot(*(s[0] - o[0])), np.hypot(*(s[1] - o[1])))
    turned = max(np.hypot(*(s[0] - o[1])), np.hypot(*(s[1] - o[0])))
    return bool(min(straight, turned) <= min(near, 0.5))


def _opening(walls: Walls, segments: Array) -> Array:
    """Return how much wider than each neck the free space is on the less open of its two sides."""
    along = segments[:, 1] - segments[:, 0]
    width = np.hypot(*along.T)
    along = along / width[:, None]
    middle = segments.mean(1)
    result = np.full(len(segments), np.inf)
    for side in (1.0, -1.0):
        normal = side * np.stack([-along[:, 1], along[:, 0]], axis=1)
        depth = walls.hits(middle, normal, 0.8 * width)
        widest = np.zeros(len(segments))
        for offset in OFFSETS:
            seen = depth > offset * width + 1e-3
            origin = middle[seen] + (offset * width[seen])[:, None] * normal[seen]
            left = walls.hits(origin, along[seen], 1.5 * width[seen], skip=0.0)
            right = walls.hits(origin, -along[seen], 1.5 * width[seen], skip=0.0)
            widest[seen] = np.maximum(widest[seen], (left + right) / width[seen])
        result = np.minimum(result, widest)
    return result


def _inside(space: shapely.Geometry, segments: Array) -> NDArray[np.bool_]:
    """Whether each segment runs through the free space, its ends apart."""
    d = segments[:, 1] - segments[:, 0]
    d = 1.5e-3 * d / np.hypot(*d.T)[:, None]
    shapely.prepare(space)
    short = np.stack([segments[:, 0] + d, segments[:, 1] - d], axis=1)
    return np.asarray(shapely.covers(space, shapely.linestrings(short)))


def _crosses(s: Array, o: Array) -> bool:
    """Whether two segments cross at a point inside both."""
    d, e = s[1] - s[0], o[1] - o[0]
    side = _cross2(d, o[0] - s[0]), _cross2(d, o[1] - s[0]), _cross2(e, s[0] - o[0]), _cross2(e, s[1] - o[0])
    tiny = 2e-3 * max(np.hypot(*d), np.hypot(*e))
    return min(abs(x) for x in side) > tiny and side[0] * side[1] < 0 and side[2] * side[3] < 0


def _rank_within(group: Index) -> Index:
    """Return how many earlier rows have the same value."""
    order = np.argsort(group, kind="stable")
    start = np.searchsorted(group[order], group[order], side="left")
    rank = np.empty(len(group), dtype=np.intp)
    rank[order] = np.arange(len(group)) - start
    return rank


def _unit(d: Array) -> Array:
    return d / np.hypot(d[:, 0], d[:, 1])[:, None]


def _cross(a: Array, b: Array) -> Array:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _cross2(a: Array, b: Array) -> float:
    return float(a[0] * b[1] - a[1] * b[0])
