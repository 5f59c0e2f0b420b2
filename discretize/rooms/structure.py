"""The plan without its clutter: what cuts and convexity are judged on."""

from collections.abc import Sequence

import numpy as np
import shapely

__all__ = ["structure"]

GRID = 1e-3
SOLID = 0.4  # least share of that rectangle that furniture fills; walls that meet fill less
SLENDER = 3.0  # how many times longer than wide a piece of wall is at least


def structure(
    space: shapely.Geometry, detail: float, clutter: float, furniture: float, doors: Sequence[shapely.LineString] = ()
) -> shapely.MultiPolygon:
    """Fill small obstacles that stand free and straighten walls.

    Parameters
    ----------
    space : shapely.Polygon or shapely.MultiPolygon
        Free space, metres.
    detail : float
        Walls move by at most this, metres.
    clutter : float
        An obstacle that touches no wall and is no longer than this is filled, metres.
    furniture : float
        So is one no longer than this that is not slender, as a piece of wall is, metres.
    doors : sequence of shapely.LineString
        Walls stay where they are at the ends of these.
    """
    parts, thin = [], []
    for part in shapely.get_parts(space):
        holes = [ring for ring in part.interiors if not _is_clutter(ring, clutter, furniture)]
        slim = [shapely.area(hole := shapely.Polygon(ring)) / hole.length < detail for ring in holes]
        thin += [shapely.Polygon(ring) for ring, is_slim in zip(holes, slim, strict=True) if is_slim]
        thick = [_from_outermost(ring) for ring, is_slim in zip(holes, slim, strict=True) if not is_slim]
        parts.append(shapely.Polygon(_from_outermost(part.exterior), thick))
    simple = shapely.set_precision(_straightened(shapely.MultiPolygon(parts), detail, doors), GRID)
    # Straightening would flatten a free-standing wall thinner than this to nothing and so open what it divides.
    walls = shapely.union_all(shapely.simplify(np.array(thin, dtype=object), detail / 4))
    simple = shapely.difference(simple, walls, grid_size=GRID)
    return shapely.MultiPolygon([p for p in shapely.get_parts(simple) if p.geom_type == "Polygon"])


def _straightened(space: shapely.MultiPolygon, detail: float, doors: Sequence[shapely.LineString]) -> shapely.Geometry:
    """Drop vertices by which walls move by at most ``detail``, but none at which a door ends."""
    if not doors:
        return shapely.simplify(space, detail)
    ends = [line for door in doors for line in _carried_on(door)]
    # Simplification keeps the ends of lines, so walls are taken apart where a door meets them.
    pieces = shapely.get_parts(shapely.union_all([shapely.boundary(space), *ends]))
    lines = shapely.simplify(shapely.MultiLineString(pieces.tolist()), detail)
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(shapely.union_all(lines))))
    free = shapely.area(shapely.intersection(faces, space)) > 0.5 * shapely.area(faces)
    return shapely.union_all(faces[free])


def _carried_on(door: shapely.LineString) -> list[shapely.LineString]:
    """Return short lines across both ends of a door, so that they surely cross the walls there."""
    p = shapely.get_coordinates(door)[[0, -1]]
    along = GRID * (p[1] - p[0]) / np.hypot(*(p[1] - p[0]))
    return [shapely.LineString([end - along, end + along]) for end in p]


def _is_clutter(ring: shapely.LinearRing, clutter: float, furniture: float) -> bool:
    """Whether an obstacle is small enough to be no wall, judged by the smallest rectangle around it."""
    box = shapely.get_coordinates(shapely.minimum_rotated_rectangle(ring))
    if len(box) < 5:
        return float(ring.length / 2) <= clutter
    width, length = np.sort(np.hypot(*(box[1:3] - box[:2]).T))
    solid = shapely.area(shapely.Polygon(ring)) >= SOLID * width * length
    return bool(length <= clutter or (length <= furniture and length < SLENDER * width and solid))


def _from_outermost(ring: shapely.LinearRing) -> np.ndarray:
    """Start a ring at its point farthest from its centroid: simplification keeps the start, wherever that was."""
    p = shapely.get_coordinates(ring)[:-1]
    c = shapely.get_coordinates(shapely.centroid(shapely.Polygon(ring)))[0]
    return np.roll(p, -int(np.argmax(np.round(np.hypot(*(p - c).T), 6))), axis=0)
