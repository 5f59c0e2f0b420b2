"""Where the centre of a round body can be, and the shortest ways between such places."""

from dataclasses import dataclass
from functools import cached_property
from heapq import heappop, heappush
from math import cos, pi

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from discretize.navmesh import NavMesh, navmesh_of
from discretize.sharing import points_of, segment_tree
from maps import FreeSpace

__all__ = ["VOID", "Reach", "reach_of"]

_QUADRANT = 16
"""Chords for a quarter of a circle where the boundary goes around a corner of a wall."""

_LONGEST_CHORD = 1.5 * pi / (2 * _QUADRANT)
"""Angle of the longest chord that GEOS draws: it rounds the number of chords of an arc to the nearest, radians."""

_SPECK = 0.05
"""A place in which a body can stand but hardly move is no part of the reach beside a larger one, square metres."""

VOID = 50.0
"""Nor is one smaller than this, in squares of the radius, where no body twice as wide can be: the inside of a wall."""

_SHORT = 1e-6
"""Openings shorter than this are none, metres."""

_CORNERS = 600
"""Most corners among which the shortest way is sought."""

_TILE = 128
"""Vertices of a piece of the reach small enough to be intersected with one cell."""


@dataclass(frozen=True)
class Reach:
    """Places for the centre of a round body, in connected parts.

    Attributes
    ----------
    radius : float
        No place is nearer to a wall than this, metres.
    parts : tuple of shapely.Polygon
        Connected parts, the largest first, metres.
    """

    radius: float
    parts: tuple[shapely.Polygon, ...]

    @cached_property
    def area(self) -> shapely.MultiPolygon:
        """All parts as one geometry, prepared."""
        area = shapely.MultiPolygon(self.parts)
        shapely.prepare(area)
        return area

    @cached_property
    def _skin(self) -> BaseGeometry:
        """The reach with a hair around it, so that what lies on its boundary lies in it whatever the rounding."""
        skin = shapely.MultiPolygon(self._hairs.geometries.tolist())
        shapely.prepare(skin)
        return skin

    @cached_property
    def _rind(self) -> BaseGeometry:
        """Boundary of the skin; whether a line meets it is much quicker to tell than whether a polygon covers it."""
        rind = self._skin.boundary
        shapely.prepare(rind)
        return rind

    def part_of(self, points: NDArray[np.float64]) -> NDArray[np.intp]:
        """Part that holds each point, shape (k,); -1 where a body cannot be.

        Parameters
        ----------
        points : ndarray, shape (k, 2)
            Metres; NaN is in no part.
        """
        found = np.full(len(points), -1, dtype=np.intp)
        sane = np.flatnonzero(np.isfinite(points).all(axis=1))
        which, part = self._hairs.query(shapely.points(points[sane]))
        for k in np.unique(part).tolist():
            near = sane[which[part == k]]
            found[near[shapely.intersects_xy(self._hairs.geometries[k], points[near])]] = k
        return found

    def allows(self, ways: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Tell for each straight way, shape (k, 2, 2), whether a body can go along it without touching a wall."""
        inside = shapely.contains_xy(self._skin, ways[:, 0, 0], ways[:, 0, 1])
        return np.asarray(inside & ~shapely.intersects(self._rind, shapely.linestrings(ways)), dtype=np.bool_)

    def within(self, cell: shapely.Polygon) -> BaseGeometry:
        """Return the part of a cell in which a body can be."""
        near = [self._tiles.geometries[k] for k in self._tiles.query(cell, predicate="intersects")]
        return shapely.union_all([shapely.intersection(tile, cell) for tile in near])

    def openings(self, segments: NDArray[np.float64]) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
        """Stretches of segments along which a body's centre can lie.

        Parameters
        ----------
        segments : ndarray, shape (k, 2, 2)
            Metres.

        Returns
        -------
        owner : ndarray, shape (m,)
            Segment of each stretch.
        stretches : ndarray, shape (m, 2, 2)
            Their ends, in the direction of the segment.
        """
        n, edges = len(segments), self._edges
        edge, which = segment_tree(segments).query(shapely.linestrings(edges))
        at = _crossings(segments[which], edges[edge])
        hit = np.isfinite(at)
        owner = np.concatenate([which[hit], np.arange(n), np.arange(n)])
        at = np.concatenate([at[hit], np.zeros(n), np.ones(n)])
        order = np.lexsort((at, owner))
        owner, at = owner[order], at[order]
        piece = np.flatnonzero(owner[1:] == owner[:-1])
        owner, low, high = owner[piece], at[piece], at[piece + 1]
        middle = _along(segments[owner], (low + high) / 2)
        length = (high - low) * np.hypot(*(segments[owner, 1] - segments[owner, 0]).T)
        open_ = shapely.contains_xy(self.area, middle[:, 0], middle[:, 1]) & (length > _SHORT)
        owner, low, high = owner[open_], low[open_], high[open_]
        return owner, np.stack([_along(segments[owner], low), _along(segments[owner], high)], axis=1)

    def way(self, start: NDArray[np.float64], goal: NDArray[np.float64], margin: float) -> NDArray[np.float64] | None:
        """Shortest way for a body's centre that stays near.

        Parameters
        ----------
        start, goal : ndarray, shape (2,)
            Metres.
        margin : float
            The way may bend around corners this far beyond the rectangle that start and goal span, metres.

        Returns
        -------
        ndarray, shape (k, 2), or None
            None where there is no such way, or there are too many corners to look at.
        """
        if self.allows(np.stack([start, goal])[None])[0]:
            return np.stack([start, goal])
        if not self._joined(start, goal):
            return None
        low, high = np.minimum(start, goal) - margin, np.maximum(start, goal) + margin
        near = np.sort(self._corners.query(shapely.box(*low, *high)))
        if len(near) > _CORNERS:
            return None
        corners = shapely.get_coordinates(self._corners.geometries[near])
        return self._by_corners(np.concatenate([start[None], goal[None], corners]))

    def far_way(self, start: NDArray[np.float64], goal: NDArray[np.float64]) -> NDArray[np.float64] | None:
        """Short way for a body's centre, however far around; None where there is none.

        Parameters
        ----------
        start, goal : ndarray, shape (2,)
            Metres.
        """
        if not self._joined(start, goal):
            return None
        part = int(self.part_of(start[None])[0])
        if part not in self._meshes:
            self._meshes[part] = navmesh_of(self.parts[part])
        corners = self._meshes[part].corners(start, goal)
        return self._by_corners(np.concatenate([start[None], goal[None], corners]))

    def _joined(self, start: NDArray[np.float64], goal: NDArray[np.float64]) -> bool:
        part = self.part_of(np.stack([start, goal]))
        return bool(part[0] == part[1] >= 0)

    @cached_property
    def _meshes(self) -> dict[int, NavMesh]:
        """Triangles of the parts that were crossed so far."""
        return {}

    def _by_corners(self, nodes: NDArray[np.float64]) -> NDArray[np.float64] | None:
        """Shortest way from the first to the second node over the others: A*, sight looked up as nodes are reached."""
        ahead = np.hypot(*(nodes - nodes[1]).T)
        cost = np.full(len(nodes), np.inf)
        cost[0] = 0.0
        previous = np.full(len(nodes), -1)
        done = np.zeros(len(nodes), dtype=np.bool_)
        queue = [(float(ahead[0]), 0)]
        while queue:
            _, k = heappop(queue)
            if done[k]:
                continue
            done[k] = True
            if k == 1:
                path = [1]
                while path[-1] != 0:
                    path.append(int(previous[path[-1]]))
                return nodes[path[::-1]]
            over = cost[k] + np.hypot(*(nodes - nodes[k]).T)
            better = np.flatnonzero(~done & (over < cost))
            better = better[self.allows(np.stack([np.broadcast_to(nodes[k], (len(better), 2)), nodes[better]], axis=1))]
            cost[better] = over[better]
            previous[better] = k
            for j in better.tolist():
                heappush(queue, (float(over[j] + ahead[j]), j))
        return None

    @cached_property
    def _hairs(self) -> shapely.STRtree:
        """Every part with a nanometre around it, prepared."""
        hairs = [part.buffer(1e-9, join_style="mitre") for part in self.parts]
        shapely.prepare(hairs)
        return shapely.STRtree(hairs)

    @cached_property
    def _tiles(self) -> shapely.STRtree:
        return shapely.STRtree([tile for part in self.parts for tile in _tiles(part)])

    @cached_property
    def _edges(self) -> NDArray[np.float64]:
        """Edges of the boundary, shape (k, 2, 2)."""
        xy, ring = shapely.get_coordinates(shapely.get_rings(list(self.parts)), return_index=True)
        follows = ring[1:] == ring[:-1]
        return np.stack([xy[:-1][follows], xy[1:][follows]], axis=1)

    @cached_property
    def _corners(self) -> shapely.STRtree:
        """Corners around which a shortest way can bend."""
        turns = []
        for ring in shapely.get_rings(shapely.orient_polygons(np.array(self.parts, dtype=object))):
            xy = shapely.get_coordinates(ring)[:-1]
            before, after = xy - np.roll(xy, 1, axis=0), np.roll(xy, -1, axis=0) - xy
            turns.append(xy[before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] < 0])
        return shapely.STRtree(points_of(np.concatenate([np.empty((0, 2)), *turns])))


def reach_of(space: FreeSpace, radius: float) -> Reach:
    """Shrink free space by the radius of a body, such that no chord around a corner comes nearer to it than that.

    Parameters
    ----------
    space : shapely.Polygon or shapely.MultiPolygon
        Free space, metres.
    radius : float
        Metres, at least 0.
    """
    space = shapely.set_precision(space, 0)  # a geometry snapped to a grid would have its offsets snapped, too
    shrunk = space.buffer(-radius / cos(_LONGEST_CHORD / 2), quad_segs=_QUADRANT) if radius > 0 else space
    parts = [p for p in shapely.get_parts(shrunk) if isinstance(p, shapely.Polygon) and p.area > 0]
    parts.sort(key=lambda p: (-p.area, p.bounds))
    return Reach(radius, tuple(p for k, p in enumerate(parts) if k == 0 or _is_room(p, radius)))


def _is_room(part: shapely.Polygon, radius: float) -> bool:
    """Whether a place that is cut off from a larger one is worth a body's while."""
    return part.area > _SPECK and (part.area > VOID * radius**2 or not part.buffer(-radius).is_empty)


def _tiles(part: shapely.Polygon) -> list[shapely.Polygon]:
    """Cut a polygon into halves until no piece has many vertices."""
    if shapely.get_num_coordinates(part) <= _TILE:
        return [part]
    x0, y0, x1, y1 = part.bounds
    if x1 - x0 > y1 - y0:
        halves = [(x0, y0, (x0 + x1) / 2, y1), ((x0 + x1) / 2, y0, x1, y1)]
    else:
        halves = [(x0, y0, x1, (y0 + y1) / 2), (x0, (y0 + y1) / 2, x1, y1)]
    pieces = [p for half in halves for p in shapely.get_parts(shapely.intersection(part, shapely.box(*half)))]
    return [tile for p in pieces if isinstance(p, shapely.Polygon) for tile in _tiles(p)]


def _along(segments: NDArray[np.float64], at: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(segments[:, 0] + (segments[:, 1] - segments[:, 0]) * at[:, None])


def _crossings(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Where along each segment of ``a`` the segment of ``b`` beside it crosses, from 0 to 1; NaN where it does not."""
    d, e, w = a[:, 1] - a[:, 0], b[:, 1] - b[:, 0], b[:, 0] - a[:, 0]
    area = d[:, 0] * e[:, 1] - d[:, 1] * e[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (w[:, 0] * e[:, 1] - w[:, 1] * e[:, 0]) / area
        u = (w[:, 0] * d[:, 1] - w[:, 1] * d[:, 0]) / area
    return np.where((t > 0) & (t < 1) & (u >= 0) & (u <= 1), t, np.nan)
