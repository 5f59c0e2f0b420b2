"""The plan without its clutter: what cuts and convexity are judged on."""

import numpy as np
import shapely

__all__ = ["structure"]

GRID = 1e-3


def structure(space: shapely.Geometry, detail: float, clutter: float) -> shapely.MultiPolygon:
    """Fill small obstacles that stand free and straighten walls.

    Parameters
    ----------
    space : shapely.Polygon or shapely.MultiPolygon
        Free space, metres.
    detail : float
        Walls move by at most this, metres.
    clutter : float
        An obstacle that touches no wall and is no longer than this is filled, metres.
    """
    parts, thin = [], []
    for part in shapely.get_parts(space):
        holes = [ring for ring in part.interiors if _span(ring) > clutter]
        slim = [shapely.area(hole := shapely.Polygon(ring)) / hole.length < detail for ring in holes]
        thin += [shapely.Polygon(ring) for ring, is_slim in zip(holes, slim, strict=True) if is_slim]
        thick = [_from_outermost(ring) for ring, is_slim in zip(holes, slim, strict=True) if not is_slim]
        parts.append(shapely.Polygon(_from_outermost(part.exterior), thick))
    simple = shapely.set_precision(shapely.simplify(shapely.MultiPolygon(parts), detail), GRID)
    # Straightening would flatten a free-standing wall thinner than this to nothing and so open what it divides.
    walls = shapely.union_all(shapely.simplify(np.array(thin, dtype=object), detail / 4))
    simple = shapely.difference(simple, walls, grid_size=GRID)
    return shapely.MultiPolygon([p for p in shapely.get_parts(simple) if p.geom_type == "Polygon"])


def _span(ring: shapely.LinearRing) -> float:
    """Longest side of the smallest rectangle around a ring, metres."""
    box = shapely.get_coordinates(shapely.minimum_rotated_rectangle(ring))
    return float(np.hypot(*(box[1:3] - box[:2]).T).max()) if len(box) >= 3 else float(ring.length / 2)


def _from_outermost(ring: shapely.LinearRing) -> np.ndarray:
    """Start a ring at its point farthest from its centroid: simplification keeps the start, wherever the file put it."""
    p = shapely.get_coordinates(ring)[:-1]
    c = shapely.get_coordinates(shapely.centroid(shapely.Polygon(ring)))[0]
    return np.roll(p, -int(np.argmax(np.round(np.hypot(*(p - c).T), 6))), axis=0)
