"""Constrained Delaunay triangulation of free space in exact arithmetic, with door segments among its edges.

GEOS triangulates; here its triangles get integer coordinates, are checked exactly, and doors are made edges of theirs
(M. V. Anglada, An improved incremental algorithm for constructing restricted Delaunay triangulations, 1997).
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.errors import DiscretizeError
from discretize.sharing import segment_tree
from maps import FloorPlan

__all__ = ["Edge", "Triangulation", "Vertex", "door_edges", "orientation", "triangulate", "turns_left"]

Edge = tuple[int, int]
Vertex = tuple[int, int]

_FINE = 20
"""Coordinates count in 2**-20 mm: grid points stay exact, and the foot of a door on a slanted wall is exact enough."""

_SNAP = 0.002
"""A door's end this close to a wall stands on it, metres (two steps of the grid)."""

_ON = 1e-9
"""A point this near to an edge lies on it, metres: rounding alone comes between them."""

_REACH = 0.3
"""A door that ends short of a wall is drawn out to it by up to this much, metres."""


@dataclass(frozen=True, slots=True)
class Triangulation:
    """Triangles that cover one part of the free space exactly.

    Attributes
    ----------
    xy : ndarray, shape (V, 2)
        Vertices as the plan has them, metres.
    grid : list of pairs of int
        The same in integers, relative to a local origin.
    triangles : list of triples of int
        Vertices of each triangle, counter-clockwise.
    doors : frozenset of pairs of int
        Edges that lie on a door, the smaller vertex first.
    """

    xy: NDArray[np.float64]
    grid: list[Vertex]
    triangles: list[tuple[int, int, int]]
    doors: frozenset[Edge]


def orientation(a: Vertex, b: Vertex, c: Vertex) -> int:
    """Twice the signed area of a triangle of integer points: positive where a, b, c turn left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def turns_left(a: Vertex, b: Vertex, c: Vertex) -> bool:
    """Tell whether the way from a over b to c keeps left or goes straight.

    A vertex that a door has put on a slanted wall lies up to a step of the integers (1e-12 m) beside it; that much is
    straight. On the grid of one millimetre the test is exact: there no turn is that slight.
    """
    steps = abs(b[0] - a[0]) + abs(b[1] - a[1]) + abs(c[0] - b[0]) + abs(c[1] - b[1])
    return orientation(a, b, c) >= -steps


def triangulate(part: shapely.Polygon, doors: tuple[shapely.LineString, ...]) -> Triangulation:
    """Triangulate a polygon with holes so that every door in it is a chain of edges.

    Parameters
    ----------
    part : shapely.Polygon
        Valid, metres; its rings may touch at points.
    doors : tuple of shapely.LineString
        From jamb to jamb. Ends may lie anywhere on the boundary. What lies outside ``part`` does not count, nor does a
        door that reaches no wall, runs along one or crosses an earlier door.

    Raises
    ------
    DiscretizeError
        If the triangles do not fill the polygon, which a valid polygon does not bring about.
    """
    part = shapely.normalize(shapely.orient_polygons(shapely.set_precision(part, 0)))
    shapely.prepare(part)
    near = [shapely.set_precision(door, 0) for door in doors if part.dwithin(door, _SNAP)]
    feet = [foot for door in near if (foot := _on_walls(door, part)) is not None]
    part = _noded(part, feet)
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(part))
    corners = shapely.get_coordinates(triangles).reshape(-1, 4, 2)[:, :3].reshape(-1, 2)
    xy, index = np.unique(corners, axis=0, return_inverse=True)
    grid = _integers(xy)
    apex: dict[Edge, int] = {}
    for a, b, c in index.reshape(-1, 3).tolist():
        if orientation(grid[a], grid[b], grid[c]) < 0:
            b, c = c, b
        apex[a, b], apex[b, c], apex[c, a] = c, a, b
    _check(part, xy, grid, apex)
    mesh = _Mesh(grid, apex)
    for foot in feet:
        for piece in shapely.get_parts(shapely.intersection(shapely.LineString(foot), part)):
            if isinstance(piece, shapely.LineString) and part.boundary.distance(piece.centroid) > _SNAP:
                ends = shapely.get_coordinates(piece)[[0, -1]]
                gap = np.hypot(*(xy[None] - ends[:, None]).transpose(2, 0, 1))
                a, b = gap.argmin(axis=1).tolist()
                if a != b and gap.min(axis=1).max() <= _SNAP:
                    mesh.insert(a, b)
    return Triangulation(xy, grid, mesh.triangles(), frozenset(mesh.fixed))


def door_edges(plan: FloorPlan) -> NDArray[np.float64]:
    """Segments of a plan's doors that part its free space, shape (k, 2, 2), metres; no cell reaches across one.

    Parameters
    ----------
    plan : FloorPlan
        Free space and doors.
    """
    meshes = [triangulate(part, plan.doors) for part in plan.parts if plan.doors]
    edges = [mesh.xy[np.array(sorted(mesh.doors), dtype=np.intp).reshape(-1, 2)] for mesh in meshes]
    return np.concatenate([np.empty((0, 2, 2)), *edges])


def _integers(xy: NDArray[np.float64]) -> list[Vertex]:
    """Points in steps of 2**-20 mm from a local origin; points on the grid of one millimetre exactly."""
    mm = xy * 1000.0
    near = np.rint(mm)
    rest = np.where(np.abs(mm - near) < 1e-5, 0.0, mm - near)
    origin = near.min(axis=0)
    whole = (near - origin).astype(np.int64).tolist()
    fine = np.rint(rest * (1 << _FINE)).astype(np.int64).tolist()
    return [((x << _FINE) + fx, (y << _FINE) + fy) for (x, y), (fx, fy) in zip(whole, fine, strict=True)]


def _on_walls(door: shapely.LineString, part: shapely.Polygon) -> NDArray[np.float64] | None:
    """Ends of a door moved onto the boundary, shape (2, 2); None where it meets none."""
    walls = part.boundary
    a, b = shapely.get_coordinates(door)[[0, -1]]
    ends = []
    for end, other in ((a, b), (b, a)):
        point = shapely.Point(end)
        if walls.distance(point) > _SNAP and part.contains(point):
            out = end + (end - other) * (_REACH / max(float(np.hypot(*(end - other))), 1e-9))
            hit = shapely.intersection(shapely.LineString([end, out]), walls)
            if hit.is_empty:
                return None
            point = shapely.shortest_line(point, hit).boundary.geoms[-1]
        if walls.distance(point) <= _SNAP:
            corners = shapely.get_coordinates(walls)
            gap = np.hypot(*(corners - [point.x, point.y]).T)
            on_edge = shapely.Point(shapely.shortest_line(walls, point).coords[0])
            point = shapely.Point(corners[gap.argmin()]) if gap.min() <= _SNAP else on_edge
        ends.append([point.x, point.y])
    return np.array(ends)


def _noded(part: shapely.Polygon, feet: list[NDArray[np.float64]]) -> shapely.Polygon:
    """Give the rings of a polygon a vertex wherever a door ends or another ring touches between two of theirs."""
    rings = shapely.get_rings(part)
    xy, ring = shapely.get_coordinates(rings, return_index=True)
    start = np.flatnonzero(ring[1:] == ring[:-1])
    points = np.unique(np.concatenate([xy, *feet]), axis=0)
    which, edge = segment_tree(np.stack([xy[start], xy[start + 1]], axis=1)).query(
        shapely.points(points), predicate="dwithin", distance=_ON
    )
    points, at = points[which], start[edge]
    before, after = np.hypot(*(points - xy[at]).T), np.hypot(*(points - xy[at + 1]).T)
    between = (before > _ON) & (after > _ON)
    if not between.any():
        return part
    points, at, before = points[between], at[between], before[between]
    order = np.lexsort((before, at))
    points, at = points[order], at[order] + 1
    xy, ring = np.insert(xy, at, points, axis=0), np.insert(ring, at, ring[at])
    shell, *holes = (xy[ring == k] for k in range(len(rings)))
    return shapely.Polygon(shell, holes)


def _check(part: shapely.Polygon, xy: NDArray[np.float64], grid: list[Vertex], apex: dict[Edge, int]) -> None:
    """Check exactly that the triangles fill the polygon: their open edges are its edges, and no triangle is flat."""
    place = {(float(x), float(y)): i for i, (x, y) in enumerate(xy)}
    walls: set[Edge] = set()
    for ring in (part.exterior, *part.interiors):
        turn = [place.get((x, y), -1) for x, y in ring.coords]
        walls.update(pairwise(turn))
    opened = {(u, v) for u, v in apex if (v, u) not in apex}
    flat = any(orientation(grid[u], grid[v], grid[w]) <= 0 for (u, v), w in apex.items())
    if flat or opened not in (walls, {(v, u) for u, v in walls}):
        x, y = part.representative_point().coords[0]
        raise DiscretizeError(f"The free space around ({x:.3f}, {y:.3f}) cannot be triangulated.")


class _Mesh:
    """Triangles that change while doors are put in: ``apex[u, v]`` is the third corner left of the edge u to v."""

    def __init__(self, grid: list[Vertex], apex: dict[Edge, int]) -> None:
        self.grid = grid
        self.apex = apex
        self.fixed: set[Edge] = set()

    def triangles(self) -> list[tuple[int, int, int]]:
        return [(u, v, w) for (u, v), w in self.apex.items() if u < v and u < w]

    def insert(self, a: int, b: int) -> None:
        """Make the segment from a to b a chain of edges; leave it out where it would cross an earlier door."""
        at = self.grid
        while a != b:
            if (a, b) in self.apex or (b, a) in self.apex:
                self.fixed.add((min(a, b), max(a, b)))
                return
            fan = [(u, v) for (u, v), w in self.apex.items() if w == a]
            end, left, right, gone = self._crossed(a, b, fan)
            if end < 0:
                return
            for u, v in gone:
                w = self.apex.pop((u, v))
                self.apex.pop((v, w))
                self.apex.pop((w, u))
            if gone:
                self._fill(a, end, left)
                self._fill(end, a, right[::-1])
            self.fixed.add((min(a, end), max(a, end)))
            if orientation(at[a], at[end], at[b]) != 0:
                return
            a = end

    def _crossed(self, a: int, b: int, fan: list[Edge]) -> tuple[int, list[int], list[int], list[Edge]]:
        """Walk from a to b: the vertex reached, the vertices left and right of the way, an edge of each triangle.

        The vertex is -1 where a wall or an earlier door is in the way.
        """
        at = self.grid
        for u, v in fan:
            for w in (u, v):
                if orientation(at[a], at[b], at[w]) == 0 and _ahead(at[a], at[b], at[w]):
                    return w, [], [], []
        ways = [
            (u, v)
            for u, v in fan
            if orientation(at[a], at[b], at[u]) < 0 < orientation(at[a], at[b], at[v])
            and orientation(at[u], at[v], at[b]) < 0
        ]
        if not ways:
            return -1, [], [], []
        (u, v), gone = ways[0], [ways[0]]
        right, left = [u], [v]
        while (v, u) in self.apex and (min(u, v), max(u, v)) not in self.fixed:
            w = self.apex[v, u]
            gone.append((v, u))
            side = orientation(at[a], at[b], at[w])
            if side == 0:
                return w, left, right, gone
            if side > 0:
                left.append(w)
                v = w
            else:
                right.append(w)
                u = w
        return -1, [], [], []

    def _fill(self, a: int, b: int, chain: list[int]) -> None:
        """Triangulate what lies left of the edge from a to b, bounded by the chain of vertices from a to b."""
        if not chain:
            return
        best = 0
        for i in range(1, len(chain)):
            if _in_circle(self.grid[a], self.grid[b], self.grid[chain[best]], self.grid[chain[i]]):
                best = i
        c = chain[best]
        self.apex[a, b], self.apex[b, c], self.apex[c, a] = c, a, b
        self._fill(a, c, chain[:best])
        self._fill(c, b, chain[best + 1 :])


def _ahead(a: Vertex, b: Vertex, p: Vertex) -> bool:
    return (p[0] - a[0]) * (b[0] - a[0]) + (p[1] - a[1]) * (b[1] - a[1]) > 0


def _in_circle(a: Vertex, b: Vertex, c: Vertex, d: Vertex) -> bool:
    """Tell whether d lies inside the circle through a, b and c, which turn left."""
    rows = [(p[0] - d[0], p[1] - d[1]) for p in (a, b, c)]
    (ax, ay), (bx, by), (cx, cy) = rows
    a2, b2, c2 = (x * x + y * y for x, y in rows)
    return ax * (by * c2 - b2 * cy) - ay * (bx * c2 - b2 * cx) + a2 * (bx * cy - by * cx) > 0
