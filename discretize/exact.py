"""Strictly convex cells: triangles merged while they stay convex.

The partition has at most four times as many cells as the smallest one (S. Hertel and K. Mehlhorn, Fast triangulation
of simple polygons, 1983).
"""

from collections.abc import Callable, Sequence
from math import hypot

import shapely

from discretize.triangulation import Triangulation, Vertex, orientation, triangulate, turns_left
from maps import FloorPlan

__all__ = ["exact_cells"]


def exact_cells(plan: FloorPlan) -> list[shapely.Polygon]:
    """Cut free space into strictly convex cells that cover it exactly; no cell reaches across a door.

    All decisions are made in integers. Every vertex of a cell is a vertex of the plan or the end of a door, and two
    cells that touch along a segment have both its ends as vertices.

    Parameters
    ----------
    plan : FloorPlan
        On its grid of one millimetre.

    Returns
    -------
    list of shapely.Polygon
        Counter-clockwise, in no particular order.
    """
    cells: list[shapely.Polygon] = []
    for part in plan.parts:
        mesh = triangulate(part, plan.doors)
        faces = min((_merge(mesh, order) for order in _ORDERS), key=len)
        cells.extend(shapely.Polygon(mesh.xy[face]) for face in faces)
    return cells


_Order = Callable[[float, int], tuple[float, float]]

_ORDERS: tuple[_Order, ...] = (
    lambda length, _: (-length, 0),
    lambda length, reflex: (reflex, -length),
    lambda length, _: (length, 0),
)
"""In which order diagonals are taken away, from their length and how many of their ends need a diagonal."""


def _merge(mesh: Triangulation, order: _Order) -> list[list[int]]:
    """Take away every diagonal without which both its ends stay convex, in the given order; return the faces left."""
    at = mesh.grid
    n = 3 * len(mesh.triangles)
    origin = [v for triangle in mesh.triangles for v in triangle]
    after = [h + 1 if h % 3 < 2 else h - 2 for h in range(n)]
    before = [h - 1 if h % 3 > 0 else h + 2 for h in range(n)]
    side = {(origin[h], origin[after[h]]): h for h in range(n)}
    twin = [side.get((origin[after[h]], origin[h]), -1) for h in range(n)]

    def convex_without(h: int, t: int) -> bool:
        a, b = origin[before[h]], origin[after[after[t]]]
        return a != b and turns_left(at[a], at[origin[h]], at[b])

    reflex = _reflex(mesh, side)
    inner = [h for h in range(n) if twin[h] > h and (min(e := _ends(origin, after, h)), max(e)) not in mesh.doors]

    def rank(h: int) -> tuple[tuple[float, float], list[Vertex]]:
        u, v = _ends(origin, after, h)
        (ux, uy), (vx, vy) = at[u], at[v]
        return order(hypot(ux - vx, uy - vy), (u in reflex) + (v in reflex)), sorted((at[u], at[v]))

    gone = [False] * n
    for h in sorted(inner, key=rank):
        t = twin[h]
        if convex_without(h, t) and convex_without(t, h):
            for a, b in ((h, t), (t, h)):
                after[before[a]] = after[b]
                before[after[b]] = before[a]
            gone[h] = gone[t] = True
    return _faces(origin, after, gone)


def _ends(origin: Sequence[int], after: Sequence[int], h: int) -> tuple[int, int]:
    return origin[h], origin[after[h]]


def _reflex(mesh: Triangulation, side: dict[tuple[int, int], int]) -> set[int]:
    """Vertices at which the boundary turns right."""
    at = mesh.grid
    onward: dict[int, list[int]] = {}
    for u, v in side:
        if (v, u) not in side:
            onward.setdefault(u, []).append(v)
    return {
        v for u, vs in onward.items() for v in vs for w in onward.get(v, ()) if orientation(at[u], at[v], at[w]) < 0
    }


def _faces(origin: Sequence[int], after: Sequence[int], gone: Sequence[bool]) -> list[list[int]]:
    """Walk around every face that is left."""
    seen = list(gone)
    faces = []
    for start in range(len(origin)):
        if not seen[start]:
            face, h = [], start
            while not seen[h]:
                seen[h] = True
                face.append(origin[h])
                h = after[h]
            faces.append(face)
    return faces
