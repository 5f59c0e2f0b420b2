"""Where a person might cut: doorways first, then the walls' own lines carried on into the room.

A cut starts at a reflex vertex, a corner that juts into the free space. A *neck* joins it by the locally shortest way
to another wall or corner; a neck is a *doorway* when the room is wider than the neck on both sides of it. Corners that
no doorway ends at, in parts of the plan that are not nearly convex as they are, get the extensions of their two walls.
"""

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.rooms.rays import Walls, lines_of

__all__ = ["ASKEW", "Corners", "askew", "corners", "distinct", "doorways", "extensions", "necks", "ring_segments"]

Array = NDArray[np.float64]
Index = NDArray[np.intp]

REFLEX = np.radians(8.0)  # a corner that turns by less is a bend of a wall, not a corner
SLACK = (
    0.25,
    0.5,
)  # cosine by which a wall may lean towards a neck, to a wall or corner, that counts as locally shortest
OPENS = 1.25  # a doorway: the free space is this much wider than the neck on either side of it
SHORT = 0.05  # metres
ASKEW = 1.6  # a neck that carries on no wall counts as that much wider when the narrowest come first
LONG = 0.5  # metres; a shorter wall does not show its direction well
WALL = (0.15, 0.3, 0.45)  # metres past the end of a neck where a wall should carry on
BUMP = 0.12  # metres by which that wall may stray
LEAN = np.radians(12.0)
COLLINEAR = np.cos(np.radians(15.0))
OFFSETS = (0.15, 0.35, 0.6)  # how far from a neck that is looked at, in its widths but at most in metres


@dataclass(frozen=True, slots=True)
class Corners:
    """Reflex vertices of free space.

    Attributes
    ----------
    points : ndarray, shape (N, 2)
        Metres.
    before, after : ndarray, shape (N, 2)
        Unit vectors from the corner along its two walls.
    lengths : ndarray, shape (N, 2)
        Of these two walls, metres.
    """

    points: Array
    before: Array
    after: Array
    lengths: Array

    def __len__(self) -> int:
        return len(self.points)

    def __getitem__(self, rows: NDArray[np.bool_]) -> "Corners":
        return Corners(self.points[rows], self.before[rows], self.after[rows], self.lengths[rows])


def ring_segments(space: shapely.Geometry) -> Array:
    """Return every edge of every ring of polygons, free space on the left, shape (M, 2, 2)."""
    rings = shapely.get_rings(shapely.get_parts(shapely.orient_polygons(space)))
    coords, ring = shapely.get_coordinates(rings, return_index=True)
    inside = ring[1:] == ring[:-1]
    return np.stack([coords[:-1][inside], coords[1:][inside]], axis=1)


def corners(space: shapely.Geometry, least: float = REFLEX) -> Corners:
    """Find the reflex vertices of polygons: those that turn right by more than ``least`` radians."""
    found = [np.empty((0, 8))]
    for ring in shapely.get_rings(shapely.get_parts(shapely.orient_polygons(space))):
        p = shapely.get_coordinates(ring)[:-1]
        incoming, outgoing = _unit(p - np.roll(p, 1, 0)), _unit(np.roll(p, -1, 0) - p)
        turn = np.arctan2(_cross(incoming, outgoing), (incoming * outgoing).sum(1))
        reflex = turn < -least
        length = np.hypot(*(p - np.roll(p, 1, 0)).T)
        columns = (p, -incoming, outgoing, length[:, None], np.roll(length, -1)[:, None])
        found.append(np.concatenate(columns, axis=1)[reflex])
    table = np.concatenate(found)
    return Corners(table[:, :2], table[:, 2:4], table[:, 4:6], table[:, 6:])


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
    tree = shapely.STRtree(lines_of(walls))
    v, e = tree.query(shapely.points(at.points), predicate="dwithin", distance=reach)
    p, a, b = at.points[v], walls[e, 0], walls[e, 1]
    along = b - a
    t = np.clip(((p - a) * along).sum(1) / (along**2).sum(1), 0.0, 1.0)
    q = a + t[:, None] * along
    width = np.hypot(*(q - p).T)
    direction = (q - p) / np.maximum(width, 1e-12)[:, None]
    lean = np.maximum((direction * at.before[v]).sum(1), (direction * at.after[v]).sum(1))
    good = (width > 2e-3) & (lean <= np.where((t == 0.0) | (t == 1.0), SLACK[1], SLACK[0]))
    v, e, t, q, width, direction = v[good], e[good], t[good], q[good], width[good], direction[good]

    far = np.full(len(v), -1, dtype=np.intp)
    at_end = (t == 0.0) | (t == 1.0)
    number = {tuple(np.round(1e3 * c).astype(int)): k for k, c in enumerate(at.points)}
    for k in np.flatnonzero(at_end):
        far[k] = number.get(tuple(np.round(1e3 * q[k]).astype(int)), -1)
    corner = far >= 0
    meets = np.ones(len(v), dtype=bool)
    meets[corner] = ((-direction[corner] * at.before[far[corner]]).sum(1) <= SLACK[1]) & (
        (-direction[corner] * at.after[far[corner]]).sum(1) <= SLACK[1]
    )
    keep = meets & (corner | ~at_end)
    v, q, width, far = v[keep], q[keep], width[keep], far[keep]

    order = np.lexsort((q[:, 1], q[:, 0], np.round(width, 3)))
    v, q, width, far = v[order], q[order], width[order], far[order]
    once: list[int] = []
    seen: set[tuple[int, ...]] = set()
    for row, (near, there, x, y) in enumerate(zip(v.tolist(), far.tolist(), *q.T.tolist(), strict=True)):
        key = (min(near, there), max(near, there)) if there >= 0 else (near, round(100 * x), round(100 * y))
        if key not in seen:
            seen.add(key)
            once.append(row)
    v, q, far = v[once], q[once], far[once]
    segments = np.stack([at.points[v], q], axis=1)
    visible = _inside(space, segments)
    segments, v, far = segments[visible], v[visible], far[visible]
    keep = _rank_within(v) < most
    return segments[keep], np.stack([v, far], axis=1)[keep]


def doorways(space: shapely.Geometry, at: Corners, segments: Array, ends: Index) -> tuple[Index, NDArray[np.bool_]]:
    """Choose the necks that are doorways, the narrowest first, so that none crosses or repeats another.

    Parameters
    ----------
    space : shapely.Geometry
        Polygons.
    at : Corners
        Where necks start.
    segments, ends
        What :func:`necks` returns.

    Returns
    -------
    chosen : ndarray of int
        Rows of ``segments``.
    clear : ndarray of bool
        Which of them nobody would doubt.
    """
    width = np.hypot(*(segments[:, 1] - segments[:, 0]).T)
    factor = askew(space, segments)
    straight, width = factor < ASKEW, factor * width
    order = np.argsort(width, kind="stable")
    segments, ends, width, straight = segments[order], ends[order], width[order], straight[order]
    tree = shapely.STRtree(lines_of(segments))
    rivals: list[list[int]] = [[] for _ in segments]
    for x, y in tree.query(shapely.linestrings(segments), predicate="dwithin", distance=0.5).T.tolist():
        if y < x:
            rivals[x].append(y)
    chosen = np.zeros(len(segments), dtype=bool)
    opening = np.zeros(len(segments))
    shut = np.zeros(len(segments), dtype=bool)
    settled = np.zeros(len(at) + 1, dtype=bool)
    settled[-1] = True
    # A doorway already found closes the view through it, so that a hallway between two doors is not wider there.
    for start, stop in _classes(width):
        opening[start:stop] = _opening(space, segments[shut], segments[start:stop])
        for k in (start + np.flatnonzero(opening[start:stop] >= OPENS)).tolist():
            if settled[ends[k]].all():
                continue
            taken = [r for r in rivals[k] if chosen[r]]
            repeated = [r for r in taken if same_cut(segments[k], segments[r])]
            crosses = any(_crosses(segments[k], segments[r]) for r in taken)
            if repeated or not crosses:
                settled[ends[k]] = True
                # The other face of the wall is a second place for the same cut; the wall's thickness lies between.
                chosen[k] = not crosses and all(_apart(segments[k], segments[r]) >= BUMP for r in repeated)
                shut[k] = True
    # Some hallways were only crossed because a wider doorway beside them had not been found yet.
    rows = np.flatnonzero(chosen)
    chosen[rows] = _opening(space, segments[shut], segments[rows]) >= OPENS
    return order[chosen], straight[chosen]


def _classes(width: Array) -> list[tuple[int, int]]:
    """Split sorted widths into runs within which the widest is at most a quarter wider than the narrowest."""
    runs, start = [], 0
    while start < len(width):
        stop = int(np.searchsorted(width, 1.25 * width[start], side="right"))
        runs.append((start, stop))
        start = stop
    return runs


def extensions(walls: Walls, at: Corners, reach: float) -> Array:
    """Carry the lines of walls on from each corner into the free space until they meet a wall; shape (k, 2, 2).

    The lines are those of the corner's own two walls and of the main directions of all walls, as far as they leave no
    reflex angle at the corner.
    """
    mains = main_directions(walls.segments)
    origins: list[Array] = []
    directions: list[Array] = []
    for k in range(len(at)):
        kept: list[Array] = []
        own = [-wall for wall, length in zip((at.before[k], at.after[k]), at.lengths[k], strict=True) if length >= LONG]
        for direction in [*own, *mains, *-mains]:
            if _splits(at, k, direction) and not any(direction @ other > COLLINEAR for other in kept):
                kept.append(direction)
        origins += [at.points[k]] * len(kept)
        directions += kept
    o, d = np.array(origins).reshape(-1, 2), np.array(directions).reshape(-1, 2)
    length = walls.hits(o, d, np.full(len(o), reach))
    return np.stack([o, o + length[:, None] * d], axis=1)


def main_directions(segments: Array, most: int = 4, least: float = 0.1) -> Array:
    """Return the directions in which at least so large a share of wall runs, as unit vectors with angles in [0, pi)."""
    d = segments[:, 1] - segments[:, 0]
    length = np.hypot(d[:, 0], d[:, 1])
    doubled = (d[:, 0] + 1j * d[:, 1]) ** 2 / np.maximum(length, 1e-12)
    left = np.ones(len(d), dtype=bool)
    found: list[Array] = []
    width = np.cos(2 * np.radians(6.0))
    while len(found) < most and left.any():
        k = int(np.argmax(np.where(left, length, -1.0)))
        near = left & ((doubled * np.conj(doubled[k])).real >= width * length * length[k])
        if length[near].sum() >= least * length.sum():
            angle = 0.5 * np.angle(doubled[near].sum()) % np.pi
            found.append(np.array([np.cos(angle), np.sin(angle)]))
        left &= ~near
    return np.array(found).reshape(-1, 2)


def _splits(at: Corners, k: int, direction: Array) -> bool:
    """Whether a ray from a corner leaves no reflex angle on either side of it."""
    lean = np.sin(np.radians(10.0))
    a, b = at.after[k], at.before[k]
    # The free sector runs counterclockwise from the wall after the corner to the wall before it, by more than pi.
    return bool(_cross2(a, direction) >= -lean and _cross2(direction, b) >= -lean and direction @ (a + b) < 0.2)


def askew(space: shapely.Geometry, segments: Array) -> Array:
    """Return by how much wider each neck should count when the narrowest come first, from 1 to ``ASKEW``.

    A doorway closes a gap in a wall: carried on past one of its ends it runs along that wall (1), or inside a wall and
    square to the walls of the plan (1 to 1.6, the more it leans). Any other neck counts as ``ASKEW``.
    """
    d = segments[:, 1] - segments[:, 0]
    d = d / np.hypot(*d.T)[:, None]
    mains = main_directions(ring_segments(space), most=8, least=0.03)
    square = np.abs(np.concatenate([d @ mains.T, d @ np.stack([-mains[:, 1], mains[:, 0]])], axis=1)).max(1)
    lean = np.arccos(np.minimum(square, 1.0))
    walls = shapely.boundary(space)
    shapely.prepare(walls)
    result = np.full(len(d), ASKEW)
    for end, outward in ((segments[:, 0], -d), (segments[:, 1], d)):
        along, inside = np.ones(len(d), dtype=bool), lean <= LEAN
        for step in WALL:
            points = shapely.points(end + step * outward)
            near = shapely.dwithin(walls, points, BUMP)
            along &= near
            inside &= near | ~shapely.covers(space, points)
        leaning = 1.0 + (ASKEW - 1.0) * lean / LEAN
        factor = np.where(along, np.minimum(leaning, 1.3), np.where(inside, np.minimum(leaning, ASKEW - 1e-6), ASKEW))
        result = np.minimum(result, factor)
    return result


def same_cut(s: Array, o: Array) -> bool:
    """Whether two cuts do the same: their ends lie close to each other, measured by their own length."""
    return bool(_same(s[None], o[None])[0])


def distinct(cuts: Array) -> Array:
    """Drop cuts that do the same as an earlier one, and those too short to matter; shape (k, 2, 2)."""
    cuts = cuts[np.hypot(*(cuts[:, 1] - cuts[:, 0]).T) > SHORT]
    middles = np.asarray(shapely.points(cuts.mean(1)), dtype=object)
    i, j = shapely.STRtree(middles).query(middles, predicate="dwithin", distance=0.5)
    i, j = i[j < i], j[j < i]
    same = _same(cuts[i], cuts[j])
    earlier: dict[int, list[int]] = {}
    for x, y in zip(i[same].tolist(), j[same].tolist(), strict=True):
        earlier.setdefault(x, []).append(y)
    kept = np.ones(len(cuts), dtype=bool)
    for k in sorted(earlier):
        kept[k] = not kept[earlier[k]].any()
    return cuts[kept]


def _same(s: Array, o: Array) -> NDArray[np.bool_]:
    lengths = np.hypot(*(s[:, 1] - s[:, 0]).T), np.hypot(*(o[:, 1] - o[:, 0]).T)
    near = np.minimum(0.35 * np.minimum(*lengths), 0.5)
    straight = np.maximum(np.hypot(*(s[:, 0] - o[:, 0]).T), np.hypot(*(s[:, 1] - o[:, 1]).T))
    turned = np.maximum(np.hypot(*(s[:, 0] - o[:, 1]).T), np.hypot(*(s[:, 1] - o[:, 0]).T))
    return np.asarray(np.minimum(straight, turned) <= near)


def _apart(s: Array, o: Array) -> float:
    """Return the least distance between an end of one segment and the other segment, metres."""
    return float(shapely.distance(shapely.LineString(s), shapely.LineString(o)))


def _opening(space: shapely.Geometry, shut: Array, segments: Array) -> Array:
    """Return how much wider than each neck the free space is on the less open of its two sides, some doorways shut."""
    stone = ring_segments(space)
    ahead, aside = Walls(stone), Walls(np.concatenate([stone, shut]))
    along = segments[:, 1] - segments[:, 0]
    width = np.hypot(*along.T)
    along = along / width[:, None]
    middle = segments.mean(1)
    result = np.full(len(segments), np.inf)
    for side in (1.0, -1.0):
        normal = side * np.stack([-along[:, 1], along[:, 0]], axis=1)
        unit = np.minimum(width, 1.0)
        depth = ahead.hits(middle, normal, 0.8 * unit)
        widest = np.zeros(len(segments))
        for offset in OFFSETS:
            seen = depth > offset * unit + 1e-3
            origin = middle[seen] + (offset * unit[seen])[:, None] * normal[seen]
            left = aside.hits(origin, along[seen], 1.5 * width[seen], skip=0.0)
            right = aside.hits(origin, -along[seen], 1.5 * width[seen], skip=0.0)
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
