"""The arrangement of walls and cuts: small faces, and which of them share how much boundary."""

from cmath import phase
from dataclasses import dataclass
from math import cos, sin

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.rooms.rays import lines_of

__all__ = ["GRID", "Border", "Faces", "arrangement"]

Array = NDArray[np.float64]

SILL = 0.6  # area of what lies within a doorway, in squares of its width: walls are thinner than doors are wide
GRID = 1e-3  # metres; everything before the last step lies on this grid, so that noding is exact


@dataclass(frozen=True, eq=False, slots=True)
class Border:
    """What two faces or two unions of faces share.

    Attributes
    ----------
    pieces : ndarray, shape (k, 2, 2)
        Segments, metres.
    length : float
        Of all of them, metres.
    door : float
        Length of those that lie in a doorway, metres.
    middle : ndarray, shape (2,)
        Of the whole, metres.
    doubled : complex
        Sum of each piece's length turned by twice its angle: directions add up so whichever way pieces point.
    """

    pieces: Array
    length: float
    door: float
    middle: Array
    doubled: complex

    def __add__(self, other: "Border") -> "Border":
        length = self.length + other.length
        return Border(
            np.concatenate([self.pieces, other.pieces]),
            length,
            self.door + other.door,
            (self.length * self.middle + other.length * other.middle) / length,
            self.doubled + other.doubled,
        )

    @property
    def direction(self) -> Array:
        """Unit vector along the border."""
        angle = 0.5 * phase(self.doubled)
        return np.array([cos(angle), sin(angle)])


@dataclass(frozen=True, slots=True)
class Faces:
    """Faces of an arrangement.

    Attributes
    ----------
    polygons : ndarray of shapely.Polygon, shape (F,)
        In an order that depends on where they lie, not on how the plan was written.
    borders : dict from (int, int) to Border
        For each pair of adjacent faces, the smaller number first.
    barred : frozenset of (int, int)
        Pairs that share a piece of a door that the source has; never joined.
    sill : ndarray of bool, shape (F,)
        Faces that lie within the thickness of a wall, between the two sides of a doorway.
    """

    polygons: NDArray[np.object_]
    borders: dict[tuple[int, int], Border]
    barred: frozenset[tuple[int, int]]
    sill: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.polygons)


def arrangement(space: shapely.Geometry, cuts: Array, doorways: Array, doors: Array) -> Faces:
    """Cut polygons along segments.

    Parameters
    ----------
    space : shapely.Geometry
        Polygons on the grid.
    cuts, doorways, doors : ndarray, shape (k, 2, 2)
        Segments in the free space, metres. No face crosses any; doorways are marked in the borders, doors of the
        source bar their two faces from each other.
    """
    segments = np.concatenate([cuts, doorways, doors])
    lines = lines_of(segments)
    linework = shapely.union_all([shapely.boundary(space), *lines.tolist()], grid_size=GRID)
    polygons = shapely.get_parts(shapely.polygonize(shapely.get_parts(linework)))
    shapely.prepare(space)
    polygons = polygons[shapely.intersects(space, shapely.point_on_surface(polygons))]
    middle = shapely.get_coordinates(shapely.centroid(polygons)).round(2)
    polygons = polygons[np.lexsort((shapely.area(polygons), middle[:, 1], middle[:, 0]))]
    return _adjacency(polygons, _gathered(doorways), _gathered(doors))


def _gathered(segments: Array) -> shapely.MultiLineString:
    lines = shapely.MultiLineString(lines_of(segments).tolist())
    shapely.prepare(lines)
    return lines


def _adjacency(polygons: NDArray[np.object_], doorways: shapely.Geometry, doors: shapely.Geometry) -> Faces:
    rings, owner = shapely.get_rings(polygons, return_index=True)
    coords, ring = shapely.get_coordinates(rings, return_index=True)
    inside = ring[1:] == ring[:-1]
    grid = np.round(coords / GRID).astype(np.int64)
    a, b = grid[:-1][inside], grid[1:][inside]
    face = owner[ring[:-1][inside]]
    swap = (a[:, 0] > b[:, 0]) | ((a[:, 0] == b[:, 0]) & (a[:, 1] > b[:, 1]))
    a[swap], b[swap] = b[swap], a[swap].copy()
    order = np.lexsort((face, b[:, 1], b[:, 0], a[:, 1], a[:, 0]))
    key = np.concatenate([a, b], axis=1)[order]
    shared = np.flatnonzero((key[1:] == key[:-1]).all(1))
    i, j = face[order[shared]], face[order[shared + 1]]
    d = GRID * (key[shared, 2:] - key[shared, :2])
    length = np.hypot(*d.T)
    doubled = (d[:, 0] + 1j * d[:, 1]) ** 2 / length
    ends = GRID * np.stack([key[shared, :2], key[shared, 2:]], axis=1)
    middle = shapely.points(ends.mean(1))
    in_doorway = np.where(shapely.dwithin(doorways, middle, 2 * GRID), length, 0.0)
    on_door = np.asarray(shapely.dwithin(doors, middle, 2 * GRID), dtype=np.bool_)
    first, second = np.minimum(i, j), np.maximum(i, j)
    order = np.flatnonzero(i != j)
    order = order[np.lexsort((second[order], first[order]))]
    pairs = np.stack([first, second], axis=1)[order]
    starts = np.flatnonzero((np.diff(pairs, axis=0, prepend=-1) != 0).any(1))
    borders: dict[tuple[int, int], Border] = {}
    barred = set()
    for start, stop in zip(starts.tolist(), np.append(starts[1:], len(pairs)).tolist(), strict=False):
        rows = order[start:stop]
        pair = (int(pairs[start, 0]), int(pairs[start, 1]))
        whole = float(length[rows].sum())
        centre = length[rows] @ ends[rows].mean(axis=1) / whole
        borders[pair] = Border(ends[rows], whole, float(in_doorway[rows].sum()), centre, complex(doubled[rows].sum()))
        if on_door[rows].any():
            barred.add(pair)
    return Faces(polygons, borders, frozenset(barred), _sills(polygons, borders))


def _sills(polygons: NDArray[np.object_], borders: dict[tuple[int, int], Border]) -> NDArray[np.bool_]:
    """Whether a face is as shallow as a wall is thick, has a doorway on one side and wall on the two next to it."""
    widest, shared = np.zeros(len(polygons)), np.zeros(len(polygons))
    for (i, j), border in borders.items():
        widest[[i, j]] = np.maximum(widest[[i, j]], border.door)
        shared[[i, j]] += border.length
    area = shapely.area(polygons)
    depth = area / np.maximum(widest, GRID)
    return (depth < SILL * widest) & (shapely.length(polygons) - shared >= depth)
