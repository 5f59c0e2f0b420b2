"""From drawn walls to the space that they enclose."""

from __future__ import annotations

import shapely
from shapely.geometry.base import BaseGeometry

from maps.errors import PlanError
from maps.floorplan import Repair

__all__ = ["STROKE", "enclosed"]

STROKE = 0.02
"""Thickness of a wall that is drawn as a line, metres."""

ENTRANCES = (0.0, 0.6, 1.2)
"""Widths (halved) of gaps in the outer walls that are taken for entrances and closed, the smallest that does."""


def enclosed(lines: list[BaseGeometry], where: str) -> tuple[list[shapely.Polygon], list[Repair]]:
    """Find the space that walls enclose.

    Everything that can be reached from outside is outside. Gaps in the outer walls are entrances: if the walls enclose
    nothing, gaps up to 1.2 m wide are closed from outside, then up to 2.4 m, and that is listed.

    Parameters
    ----------
    lines : list of shapely geometries
        Walls as lines or polygons, metres.
    where : str
        What error sentences begin with.

    Raises
    ------
    PlanError
        If the walls enclose no space.
    """
    walls = shapely.union_all(shapely.buffer(lines, STROKE / 2, cap_style="square", join_style="mitre"), grid_size=1e-3)
    paper = shapely.box(*walls.bounds).buffer(4 * max(ENTRANCES), join_style="mitre")
    open_space = paper.difference(walls)
    for radius in ENTRANCES:
        reached = shapely.buffer(open_space, -radius) if radius else open_space
        outside = [part for part in shapely.get_parts(reached) if part.distance(paper.exterior) <= radius + 1e-6]
        beyond = shapely.buffer(shapely.union_all(outside), radius) if radius else shapely.union_all(outside)
        inside = open_space.difference(shapely.buffer(beyond, 1e-3) if radius else beyond)
        parts = [part for part in shapely.get_parts(inside) if isinstance(part, shapely.Polygon)]
        if sum(part.area for part in parts if not part.buffer(-0.5).is_empty) > walls.convex_hull.area / 10:
            message = f"Gaps of up to {2 * radius} m in the outer walls were taken for entrances and closed."
            closed = [Repair("closed entrance", message, shapely.GeometryCollection())] if radius else []
            return parts, closed
    raise PlanError(f"{where}: there is no free space in it; its walls enclose none.")
