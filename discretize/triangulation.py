"""Constrained Delaunay triangulation of free space in exact arithmetic, with door segments among its edges.

GEOS triangulates; here its triangles get integer coordinates, are checked exactly, and doors are made edges of theirs.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.errors import DiscretizeError
from discretize.mesh import Edge, Mesh, Vertex, orientation
from discretize.sharing import segment_tree
from maps import FloorPlan

__all__ = ["Triangulation", "door_edges", "triangulate"]

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
    inside = [piece for door in near for piece in _within(door, part)]
    feet = [foot for piece in inside if (foot := _on_walls(piece, part)) is not None]
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
    mesh = Mesh(grid, apex)
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


def _within(door: shapely.LineString, part: shapely.Polygon) -> list[shapely.LineString]:
    """The pieces of a door that lie in free space: people draw doors into the walls beside them."""
    pieces = shapely.get_parts(shapely.intersection(door, part))
    return [piece for piece in pieces if isinstance(piece, shapely.LineString) and piece.length > _SNAP] or [door]


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
