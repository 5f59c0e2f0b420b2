"""Whether cells cover the free space of a plan once."""

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from maps import FloorPlan

__all__ = ["cover", "cover_problems"]

_SHARE = 1e-9
"""Share of the free space that may be left out or covered twice."""


def cover(plan: FloorPlan, cells: Sequence[shapely.Polygon]) -> tuple[float, float]:
    """Share of the free space that cells cover, and share that they cover twice or beyond its walls.

    Sums of areas and of what pairs of cells share: a union of thousands of cells would move vertices.
    """
    shapes, space = np.array(cells, dtype=object), shapely.set_precision(plan.space, 0)
    i, j = _overlapping(cells)
    twice = float(shapely.area(shapely.intersection(shapes[i], shapes[j])).sum())
    shapely.prepare(space)
    outside = float(shapely.area(shapely.difference(shapes[~shapely.covers(space, shapes)], space)).sum())
    covered = float(shapely.area(shapes).sum()) - twice - outside
    if twice > _SHARE * space.area:  # three cells may share a place
        covered = float(shapely.intersection(shapely.union_all(shapes), space).area)
    return min(covered / space.area, 1.0), (twice + outside) / space.area


def cover_problems(plan: FloorPlan, cells: Sequence[shapely.Polygon]) -> list[str]:
    """Say where cells leave out free space, cover it twice or lie outside it; empty where they do not."""
    coverage, overlap = cover(plan, cells)
    problems = []
    if coverage < 1 - _SHARE:
        left = shapely.difference(plan.space, shapely.union_all(np.array(cells, dtype=object)))
        problems.append(f"{(1 - coverage) * plan.area:.3g} m² of the free space lie in no cell, {_place(left)}.")
    if overlap > _SHARE:
        shapes = np.array(cells, dtype=object)
        i, j = _overlapping(cells)
        both, beyond = shapely.intersection(shapes[i], shapes[j]), shapely.difference(shapes, plan.space)
        place = _place(*both, *beyond)
        problems.append(f"{overlap * plan.area:.3g} m² lie in two cells or outside the free space, {place}.")
    return problems


def _overlapping(cells: Sequence[shapely.Polygon]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Pairs of cells that meet, the first before the second."""
    i, j = shapely.STRtree(list(cells)).query(np.array(cells, dtype=object), predicate="intersects")
    return i[i < j], j[i < j]


def _place(*geometries: shapely.Geometry) -> str:
    """Words for where the largest piece of something is."""
    pieces = shapely.get_parts(np.array(geometries, dtype=object))
    point = shapely.point_on_surface(max(pieces, key=shapely.area))
    return f"the most of it at ({shapely.get_x(point):.3f}, {shapely.get_y(point):.3f})"
