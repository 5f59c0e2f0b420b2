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
    parts = []
    for part in shapely.get_parts(space):
        holes = [ring for ring in part.interiors if _span(ring) > clutter]
        parts.append(shapely.Polygon(_from_outermost(part.exterior), [_from_outermost(ring) for ring in holes]))
    simple = shapely.simplify(shapely.MultiPolygon(parts), detail)
    simple = shapely.set_precision(simple, GRID)
    return shapely.MultiPolygon([p for p in shapely.get_parts(simple) if p.area > 0])


def _span(ring: shapely.LinearRing) -> float:
    """Longest side of the smallest rectangle around a ring, metres."""
    box = shapely.get_coordinates(shapely.minimum_rotated_rectangle(ring))
    return float(np.hypot(*(box[1:3] - box[:2]).T).max()) if len(box) >= 3 else float(ring.length / 2)


def _from_outermost(ring: shapely.LinearRing) -> np.ndarray:
    """Start a ring at its point farthest from its centroid: simplification keeps the start, wherever the file put it."""
    p = shapely.get_coordinates(ring)[:-1]
    c = shapely.get_coordinates(shapely.centroid(shapely.Polygon(ring)))[0]
    return np.roll(p, -int(np.argmax(np.round(np.hypot(*(p - c).T), 6))), axis=0)
