"""Join faces while the union stays nearly convex and the neck between the two is wide, in many random orders.

Two rooms that a thin wall parts fill their convex hull well, so the hull alone would join them; that is why the shared
boundary is also compared with the width of both sides.
"""

import heapq
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from discretize.rooms.faces import Border, Faces
from discretize.rooms.shaking import Field

__all__ = ["Limits", "Region", "Regions"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Limits:
    """What a cell may look like.

    Attributes
    ----------
    convexity : float
        Least area of a cell as a share of its convex hull's.
    sight : float
        Least share of pairs of points of a cell that see each other.
    gate : float
        Least length of a boundary that is dissolved, as a share of the extent, along it, of the smaller side.
    through : float
        Least share of pairs of points, one on either side of a boundary that is dissolved, that see each other.
    """

    convexity: float
    sight: float
    gate: float
    through: float


@dataclass(frozen=True, eq=False, slots=True)
class Region:
    """A union of faces.

    Attributes
    ----------
    faces : frozenset of int
        Which ones.
    area : float
        Square metres.
    hull : ndarray, shape (k, 2)
        Corners of its convex hull, metres.
    hull_area : float
        Square metres.
    points : ndarray, shape (p, 2)
        Some points of it, spread evenly, metres.
    sight : float
        Estimate of the share of pairs of its points that see each other.
    open : float
        Length of its boundary that is neither wall nor doorway, metres.
    sill : bool
        Whether it lies within the thickness of a wall, between the two faces of a doorway.
    """

    faces: frozenset[int]
    area: float
    hull: Array
    hull_area: float
    points: Array
    sight: float
    open: float
    sill: bool = False

    @property
    def convexity(self) -> float:
        """Area as a share of the convex hull's."""
        return self.area / self.hull_area

    def extent(self, direction: Array) -> float:
        """Length of its shadow on a line, metres."""
        along = self.hull @ direction
        return float(along.max() - along.min())


class Regions:
    """The faces of a plan and every union of them met so far; unions are computed once.

    Parameters
    ----------
    faces : Faces
        What to join.
    limits : Limits
        What a union may look like.
    """

    def __init__(self, faces: Faces, limits: Limits) -> None:
        self._faces = faces
        self._limits = limits
        hulls = shapely.convex_hull(faces.polygons)
        shut = np.zeros(len(faces))
        for (i, j), border in faces.borders.items():
            shut[[i, j]] += border.length - border.door
        self.single = [
            Region(
                frozenset([k]),
                p.area,
                shapely.get_coordinates(h)[:-1],
                h.area,
                spread(p),
                1.0,
                shut[k],
                bool(faces.sill[k]),
            )
            for k, (p, h) in enumerate(zip(faces.polygons, hulls, strict=True))
        ]
        self.pool: dict[frozenset[int], Region] = {r.faces: r for r in self.single}
        self._tried: dict[tuple[frozenset[int], frozenset[int]], tuple[Region | None, float]] = {}

    def merge(self, start: Sequence[Region], rng: np.random.Generator, noise: float) -> list[Region]:
        """Join regions greedily, best first, until nothing can be joined; every union made enters the pool.

        Parameters
        ----------
        start : sequence of Region
            Regions that cover every face once.
        rng : numpy.random.Generator
            Shuffles the order.
        noise : float
            Standard deviation of what is added to each union's merit; 0 gives the plain greedy order.
        """
        alive: dict[int, Region] = dict(enumerate(start))
        near, barred = self._neighbours(start)
        field = Field(rng)
        heap: list[tuple[float, int, int]] = []

        def offer(pairs: list[tuple[int, int]]) -> None:
            pairs = [(i, j) for i, j in pairs if j not in barred[i]]
            found = self._unions([(alive[i], alive[j], near[i][j]) for i, j in pairs])
            shake = np.zeros(len(pairs))
            if noise and pairs:
                shake = noise * field(np.array([near[i][j].middle for i, j in pairs]))
            for (i, j), (union, merit), extra in zip(pairs, found, shake.tolist(), strict=True):
                if union is not None:
                    heapq.heappush(heap, (-merit - extra, i, j))

        offer([(i, j) for i in alive for j in sorted(near[i]) if i < j])
        fresh = len(alive)
        while heap:
            _, i, j = heapq.heappop(heap)
            if i not in alive or j not in alive:
                continue
            union = self._tried[_key(alive[i], alive[j])][0]
            if union is None:
                continue
            del alive[i], alive[j]
            alive[fresh] = union
            self.pool.setdefault(union.faces, union)
            barred[fresh] = barred.pop(i) | barred.pop(j)
            for other in barred[fresh]:
                barred[other] = barred[other] - {i, j} | {fresh}
            around: dict[int, Border] = {}
            for old in (i, j):
                for other, border in near.pop(old).items():
                    if other in alive:
                        around[other] = around[other] + border if other in around else border
                        del near[other][old]
            near[fresh] = around
            for other, border in around.items():
                near[other][fresh] = border
            offer([(other, fresh) for other in sorted(around)])
            fresh += 1
        return list(alive.values())

    def _neighbours(self, start: Sequence[Region]) -> tuple[dict[int, dict[int, Border]], dict[int, set[int]]]:
        """Return the borders between regions, and which of them a door keeps apart."""
        owner = {face: k for k, region in enumerate(start) for face in region.faces}
        near: dict[int, dict[int, Border]] = {k: {} for k in range(len(start))}
        barred: dict[int, set[int]] = {k: set() for k in range(len(start))}
        for (a, b), border in self._faces.borders.items():
            i, j = owner[a], owner[b]
            if i != j:
                near[i][j] = near[j][i] = near[i][j] + border if j in near[i] else border
        for a, b in self._faces.barred:
            i, j = owner[a], owner[b]
            if i != j:
                barred[i].add(j)
                barred[j].add(i)
        return near, barred

    def _unions(self, pairs: Sequence[tuple[Region, Region, Border]]) -> list[tuple[Region | None, float]]:
        """Return each union, or None where it is not allowed, and its merit."""
        todo = [(a, b, border) for a, b, border in pairs if _key(a, b) not in self._tried]
        if todo:
            points = [corner for a, b, _ in todo for corner in (a.hull, b.hull)]
            which = np.repeat(np.arange(len(todo)), [len(a.hull) + len(b.hull) for a, b, _ in todo])
            lines = shapely.linestrings(np.concatenate(points), indices=which)
            hulls = np.asarray(shapely.convex_hull(lines), dtype=object)
            areas = np.asarray(shapely.area(hulls))
            for (a, b, border), hull, hull_area in zip(todo, hulls, areas.tolist(), strict=True):
                self._tried[_key(a, b)] = self._union(a, b, border, hull, hull_area)
        return [self._tried[_key(a, b)] for a, b, _ in pairs]

    def _union(
        self, a: Region, b: Region, border: Border, hull: shapely.Polygon, hull_area: float
    ) -> tuple[Region | None, float]:
        """Return the union of two regions if it is allowed, and its merit."""
        limits = self._limits
        area = a.area + b.area
        convexity = area / hull_area
        # What lies within the thickness of a wall may join the room on either side of the doorway.
        sill = a.sill or b.sill
        if convexity < limits.convexity or (border.door > 0.3 * border.length and not sill):
            return None, 0.0
        direction = border.direction
        gate = border.length / max(min(a.extent(direction), b.extent(direction)), 1e-9)
        if gate < limits.gate and convexity < 0.995:
            return None, 0.0
        through = crossing(a.points, b.points, border.pieces)
        sight = (a.sight * a.area**2 + b.sight * b.area**2 + 2 * a.area * b.area * through) / area**2
        if sight < limits.sight or (through < limits.through and not sill):
            return None, 0.0
        faces = a.faces | b.faces
        union = self.pool.get(faces)
        if union is None:
            shut = a.open + b.open - 2 * (border.length - border.door)
            union = Region(faces, area, shapely.get_coordinates(hull)[:-1], hull_area, _thin(a, b), sight, shut)
        return union, convexity + sight + 0.2 * min(gate, 1.0) - 2.0 * sill


def _key(a: Region, b: Region) -> tuple[frozenset[int], frozenset[int]]:
    return a.faces, b.faces


def spread(polygon: BaseGeometry, n: int = 8) -> Array:
    """Return about ``n`` points of a polygon, spread evenly, shape (p, 2), metres."""
    x0, y0, x1, y1 = polygon.bounds
    for tries in (2 * n, 16 * n):
        points = np.array([x0, y0]) + LATTICE[:tries] * np.array([x1 - x0, y1 - y0])
        points = points[np.asarray(shapely.contains_xy(polygon, points), dtype=bool)]
        if len(points) >= n // 2:
            return np.asarray(points[:n])
    return np.asarray(np.concatenate([points, shapely.get_coordinates(shapely.point_on_surface(polygon))]))


def crossing(p: Array, q: Array, pieces: Array) -> float:
    """Return the share of pairs of points, one of ``p`` and one of ``q``, whose segment crosses one of ``pieces``."""
    d = (q[None] - p[:, None]).reshape(-1, 2)
    # The cross product of d and (end - p) tells on which side of the segment an end of a piece lies.
    normal = np.stack([-d[:, 1], d[:, 0]], axis=1)
    own = (normal.reshape(len(p), len(q), 2) * p[:, None]).sum(2).reshape(-1, 1)
    sides = normal @ pieces.reshape(-1, 2).T - own
    return np.count_nonzero((sides[:, ::2] * sides[:, 1::2] <= 0.0).any(1)) / len(d)


def _thin(a: Region, b: Region, most: int = 16) -> Array:
    """Return points of both regions in proportion to their areas."""
    n = min(most, len(a.points) + len(b.points))
    of_a = min(max(round(n * a.area / (a.area + b.area)), 1), n - 1)
    kept_a, kept_b = _evenly(len(a.points), of_a), _evenly(len(b.points), n - of_a)
    return np.concatenate([a.points[kept_a], b.points[kept_b]])


@cache
def _evenly(n: int, count: int) -> NDArray[np.intp]:
    """Return at most ``count`` of ``n`` numbers, spread evenly."""
    return np.linspace(0, n - 1, min(count, n)).round().astype(np.intp)


# The plastic number's lattice: any leading part of it is spread evenly over the unit square.
LATTICE = np.mod(0.5 + np.arange(1, 129)[:, None] * np.array([0.7548776662466927, 0.5698402909980532]), 1.0)
