"""The arrangement of walls and cuts: small faces, and which of them share how much boundary."""

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

__all__ = ["GRID", "Border", "Faces", "arrangement"]

Array = NDArray[np.float64]

GRID = 1e-3  # metres; everything before the last step lies on this grid, so that noding is exact


@dataclass(frozen=True, slots=True)
class Border:
    """What two faces or two unions of faces share.

    Attributes
    ----------
    length : float
        Metres.
    xx, xy : float
        Length times cosine and sine of twice the direction: the directions of pieces add up as doubled angles.
    """

    length: float
    xx: float
    xy: float

    def __add__(self, other: "Border") -> "Border":
        return Border(self.length + other.length, self.xx + other.xx, self.xy + other.xy)

    @property
    def direction(self) -> Array:
        """Unit vector along the border."""
        angle = 0.5 * np.arctan2(self.xy, self.xx)
        return np.array([np.cos(angle), np.sin(angle)])


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
    """

    polygons: NDArray[np.object_]
    borders: dict[tuple[int, int], Border]
    barred: frozenset[tuple[int, int]]

    def __len__(self) -> int:
        return len(self.polygons)


def arrangement(space: shapely.Geometry, cuts: Array, doors: Array) -> Faces:
    """Cut polygons along segments.

    Parameters
    ----------
    space : shapely.Geometry
        Polygons on the grid.
    cuts, doors : ndarray, shape (k, 2, 2)
        Segments in the free space, metres; no face crosses a cut, no cell may cross a door.
    """
    segments = np.concatenate([cuts, doors])
    lines = shapely.set_precision(shapely.linestrings(segments), GRID) if len(segments) else np.empty(0, dtype=object)
    linework = shapely.union_all([shapely.boundary(space), *lines], grid_size=GRID)
    polygons = shapely.get_parts(shapely.polygonize(shapely.get_parts(linework)))
    shapely.prepare(space)
    polygons = polygons[shapely.intersects(space, shapely.point_on_surface(polygons))]
    middle = shapely.get_coordinates(shapely.centroid(polygons)).round(2)
    polygons = polygons[np.lexsort((shapely.area(polygons), middle[:, 1], middle[:, 0]))]
    return _adjacency(polygons, shapely.multilinestrings(shapely.linestrings(doors)))


def _adjacency(polygons: NDArray[np.object_], doors: shapely.Geometry) -> Faces:
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
    cos2, sin2 = (d[:, 0] ** 2 - d[:, 1] ** 2) / length, 2.0 * d[:, 0] * d[:, 1] / length
    middle = shapely.points(GRID * (key[shared, 2:] + key[shared, :2]) / 2)
    on_door = shapely.dwithin(doors, middle, 2 * GRID) if not doors.is_empty else np.zeros(len(i), dtype=bool)
    borders: dict[tuple[int, int], Border] = {}
    barred = set()
    for x, y, *piece, door in zip(
        i.tolist(), j.tolist(), length.tolist(), cos2.tolist(), sin2.tolist(), on_door.tolist(), strict=True
    ):
        pair = (min(x, y), max(x, y))
        if x != y:
            borders[pair] = borders[pair] + Border(*piece) if pair in borders else Border(*piece)
            if door:
                barred.add(pair)
    return Faces(polygons, borders, frozenset(barred))
