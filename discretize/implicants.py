"""Prime implicants of a floor plan: the maximal nearly convex unions of the pieces between rays."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from discretize.rays import cross
from discretize.sharing import shared_segments

__all__ = ["CONVEXITY", "Pieces", "Union", "grow", "prime_implicants"]

Union = frozenset[int]

CONVEXITY = 0.9
"""Least share of its convex hull that a union of pieces fills."""

_NOTCH = 0.1
"""Deepest notch in a union: no corner of it lies further inside its convex hull, metres."""

_PIN = 1e-9
"""A smaller hole is rounding, square metres: walls are on a grid of a millimetre."""

_STRETCHES = ((1.0, 1.0), (1.0, 10.0), (10.0, 1.0))
"""Factors of distance along a piece's longest side and square to it, by which its neighbours are taken in turn."""


@dataclass(frozen=True)
class Pieces:
    """Convex pieces of free space, to be joined into cells.

    Attributes
    ----------
    shapes : tuple of shapely.Polygon
        Metres.
    doors : ndarray, shape (k, 2, 2)
        Segments across which pieces are not joined, metres.
    """

    shapes: tuple[shapely.Polygon, ...]
    doors: NDArray[np.float64]

    @cached_property
    def neighbours(self) -> tuple[tuple[int, ...], ...]:
        """Pieces that touch each piece along a segment without a door."""
        pairs, segments = shared_segments(self.shapes)
        shut = shapely.MultiLineString(list(self.doors))
        free = ~shapely.dwithin(shut, shapely.points(segments.mean(axis=1)), 1e-6)
        found: list[set[int]] = [set() for _ in self.shapes]
        for a, b in pairs[free].tolist():
            found[a].add(b)
            found[b].add(a)
        return tuple(tuple(sorted(near)) for near in found)

    @cached_property
    def areas(self) -> NDArray[np.float64]:
        """Area of each piece, shape (n,), square metres."""
        return np.asarray(shapely.area(np.array(self.shapes, dtype=object)))

    @cached_property
    def tree(self) -> shapely.STRtree:
        """Index of the centroids of the pieces."""
        return shapely.STRtree([shapely.Point(xy) for xy in self.centroids])

    @cached_property
    def centroids(self) -> NDArray[np.float64]:
        """Centroid of each piece, shape (n, 2), metres."""
        return shapely.get_coordinates(shapely.centroid(np.array(self.shapes, dtype=object)))

    def area(self, union: Union) -> float:
        """Area of a union, square metres."""
        return float(self.areas[list(union)].sum())

    def rank(self, union: Union) -> tuple[float, list[int]]:
        """Key that sorts unions from the largest to the smallest."""
        return -round(self.area(union), 9), sorted(union)

    def shape(self, union: Union) -> BaseGeometry:
        """Outline of a union, without the pin-holes that rounding leaves where many pieces meet."""
        outline = shapely.union_all([self.shapes[k] for k in sorted(union)])
        if isinstance(outline, shapely.Polygon) and outline.interiors:
            holes = [ring for ring in outline.interiors if shapely.Polygon(ring).area > _PIN]
            outline = shapely.Polygon(outline.exterior, holes)
        return outline

    def hull(self, union: Union) -> BaseGeometry:
        """Convex hull of a union."""
        return shapely.LineString(np.concatenate([self._rings[k] for k in union])).convex_hull

    def holds(self, union: Union) -> bool:
        """Tell whether a union is connected, without holes and nearly convex: an implicant."""
        if union not in self._known:
            self._known[union] = len(union) == 1 or self._nearly_convex(union)
        return self._known[union]

    def _nearly_convex(self, union: Union) -> bool:
        hull = self.hull(union)
        area = self.area(union)
        if area < CONVEXITY * hull.area or not self.connected(union):
            return False
        if area >= (1 - 1e-9) * hull.area:
            return True
        rim = shapely.get_coordinates(hull)
        along = np.diff(rim, axis=0)
        along /= np.hypot(*along.T)[:, None]
        beside = self._boundary(union)[:, None] - rim[None, :-1]
        depth = np.abs(along[:, 0] * beside[..., 1] - along[:, 1] * beside[..., 0]).min(axis=1)
        if depth.max() > _NOTCH:
            return False
        shape = self.shape(union)
        return isinstance(shape, shapely.Polygon) and not shape.interiors

    def _boundary(self, union: Union) -> NDArray[np.float64]:
        """Corners on the boundary of a union: those around which its pieces do not close."""
        xy, place, turn = self._corners
        members = sorted(union)
        at = np.concatenate([place[k] for k in members])
        angle = np.bincount(at, weights=np.concatenate([turn[k] for k in members]))
        return np.asarray(xy[np.flatnonzero((angle > 0) & (angle < 2 * np.pi - 1e-6))])

    @cached_property
    def _corners(self) -> tuple[NDArray[np.float64], list[NDArray[np.intp]], list[NDArray[np.float64]]]:
        """Places of all corners, shape (m, 2), and for each piece which are its own and the angles there."""
        rings = [ring[:-1] for ring in self._rings]
        xy, place = np.unique(np.round(np.concatenate(rings), 9), axis=0, return_inverse=True)
        ends = np.cumsum([len(ring) for ring in rings])[:-1]
        turns: list[NDArray[np.float64]] = []
        for ring in rings:
            onward, back = np.roll(ring, -1, axis=0) - ring, np.roll(ring, 1, axis=0) - ring
            turns.append(np.abs(np.arctan2(cross(onward, back), (onward * back).sum(axis=1))))
        return np.asarray(xy, dtype=np.float64), np.split(place.ravel(), ends), turns

    @cached_property
    def _rings(self) -> list[NDArray[np.float64]]:
        return [shapely.get_coordinates(shape) for shape in self.shapes]

    @cached_property
    def _known(self) -> dict[Union, bool]:
        return {}

    def connected(self, union: Union) -> bool:
        """Tell whether one can go from each piece of a union to each other within it."""
        seen, todo = set(), [min(union)]
        while todo:
            k = todo.pop()
            if k not in seen:
                seen.add(k)
                todo.extend(j for j in self.neighbours[k] if j in union)
        return len(seen) == len(union)

    def closed(self, union: Union) -> Union:
        """Add to a union what lies within its convex hull, until nothing more does."""
        while True:
            inside = union.union(self.tree.query(self.hull(union), predicate="contains").tolist())
            if inside == union:
                return union
            union = inside


def prime_implicants(pieces: Pieces) -> list[Union]:
    """Grow implicants until none can grow, from every piece that those found so far do not hold.

    A union grows by a neighbour and by all that its convex hull then holds. A neighbour that once was too much is too
    much for whatever the union grows into. From each piece three implicants grow: evenly, along its longest side
    first, and square to it first. As in the method of Quine and McCluskey an implicant that a larger one contains is
    dropped.

    Parameters
    ----------
    pieces : Pieces
        What to join.
    """
    primes: set[Union] = set()
    left = set(range(len(pieces.shapes)))
    for seed in np.argsort(-np.round(pieces.areas, 9), kind="stable").tolist():
        if seed in left:
            for stretch in _STRETCHES:
                prime = grow(pieces, seed, stretch)
                primes.add(prime)
                left -= prime
    return [p for p in sorted(primes, key=sorted) if not any(p < other for other in primes)]


def grow(pieces: Pieces, seed: int, stretch: tuple[float, float] = (1.0, 1.0), within: Union | None = None) -> Union:
    """Add the nearest neighbours to a piece for as long as that leaves an implicant.

    Parameters
    ----------
    pieces : Pieces
        What to join.
    seed : int
        The piece.
    stretch : pair of float
        Factors of distance along the longest side of the piece and square to it.
    within : frozenset of int, optional
        Pieces that may be taken; all where it is left out.
    """
    union: Union = frozenset([seed])
    distance = _distances(pieces, seed, stretch)
    refused: set[int] = set()
    while near := {j for i in union for j in pieces.neighbours[i]} - union - refused:
        nearest = min(near, key=lambda k: (round(float(distance[k]), 6), k))
        wider = pieces.closed(union | {nearest})
        if (within is None or wider <= within) and pieces.holds(wider):
            union = wider
        else:
            refused.add(nearest)
    return union


def _distances(pieces: Pieces, seed: int, stretch: tuple[float, float]) -> NDArray[np.float64]:
    """How far pieces are from one of them, along its longest side and square to it, by given factors."""
    ring = shapely.get_coordinates(pieces.shapes[seed])
    sides = np.diff(ring, axis=0)
    along = sides[np.round(np.hypot(*sides.T), 6).argmax()]
    along = along / np.hypot(*along)
    beside = pieces.centroids - pieces.centroids[seed]
    return np.asarray(stretch[0] * np.abs(beside @ along) + stretch[1] * np.abs(cross(along, beside)))
