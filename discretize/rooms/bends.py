"""Faces that no corner cuts although they are far from convex: hallways that bend little by little."""

from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray

__all__ = ["diagonals"]


def diagonals(polygons: NDArray[np.object_], least: float) -> NDArray[np.float64]:
    """Return diagonals that cut each polygon that is not nearly convex into triangles, shape (k, 2, 2), metres.

    Parameters
    ----------
    polygons : ndarray of shapely.Polygon, shape (F,)
        On the grid, metres.
    least : float
        What fills this share of its convex hull is left whole.
    """
    bent = polygons[shapely.area(polygons) < least * shapely.area(shapely.convex_hull(polygons))]
    found: list[tuple[tuple[float, ...], tuple[float, ...]]] = []
    for polygon in bent.tolist():
        walls = {frozenset(edge) for ring in shapely.get_rings(polygon) for edge in pairwise(ring.coords)}
        triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(polygon))
        edges = {frozenset(edge) for triangle in triangles for edge in pairwise(triangle.exterior.coords)}
        found += sorted((min(edge), max(edge)) for edge in edges - walls)
    return np.array(found, dtype=np.float64).reshape(-1, 2, 2)
