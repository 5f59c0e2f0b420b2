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
"""Widths (halved) of gaps in the outer walls that are taken for entrances and closed, tried in this order, metres."""

ROOM = 0.5
"""Something enclosed is a room if a disc of this radius fits into it, metres; the inside of a double wall is none."""


def enclosed(lines: list[BaseGeometry], where: str) -> tuple[list[shapely.Polygon], list[Repair]]:
    """Find the space that walls enclose.

    Everything that can be reached from outside is outside. Gaps in the outer walls are entrances: if the walls enclose
    less than half of what a rope around them would, gaps up to 1.2 m wide are closed from outside, then up to 2.4 m;
    what encloses most is taken, and that is listed.

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
    found = []
    for radius in ENTRANCES:
        reached = shapely.buffer(open_space, -radius) if radius else open_space
        outside = [part for part in shapely.get_parts(reached) if part.distance(paper.exterior) <= radius + 1e-6]
        beyond = shapely.buffer(shapely.union_all(outside), radius + 1e-3 if radius else 0.0)
        parts = [p for p in shapely.get_parts(open_space.difference(beyond)) if isinstance(p, shapely.Polygon)]
        rooms = sum(part.area for part in parts if not part.buffer(-ROOM).is_empty)
        found.append((rooms, radius, parts))
        if rooms > walls.convex_hull.area / 2:
            break
    rooms, radius, parts = found[-1] if rooms > walls.convex_hull.area / 2 else max(found, key=lambda f: f[0])
    if not rooms:
        raise PlanError(f"{where}: there is no free space in it; its walls enclose none.")
    message = f"Gaps of up to {2 * radius} m in the outer walls were taken for entrances and closed."
    return parts, [Repair("closed entrance", message, shapely.GeometryCollection())] if radius else []
