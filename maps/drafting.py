"""Draw a floor plan as a tiling of convex rooms whose walls have a thickness and whose doors have none.

Rooms meet edge to edge, as on a sketch. Each gives up half a wall's thickness all around, except where it has a door:
its free space is the convex hull of the inset room and of its door segments. So every room stays exactly convex, two
rooms touch exactly in their door segment, and a wall grows from nothing at a door jamb to its full thickness at the
next corner.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from maps.errors import PlanError
from maps.floorplan import FloorPlan, Label
from maps.making import make_plan

__all__ = ["Door", "Room", "draft_plan", "draft_rooms"]


@dataclass(frozen=True, slots=True)
class Room:
    """A convex room of a sketch.

    Attributes
    ----------
    number : int
        Number of its cell, from 1.
    name : str
        What people call it.
    corners : tuple of pairs of float
        In order, metres; two opposite corners stand for a rectangle.
    """

    number: int
    name: str
    corners: tuple[tuple[float, float], ...]

    @property
    def outline(self) -> shapely.Polygon:
        """The room up to the middle of its walls."""
        if len(self.corners) == 2:
            (x0, y0), (x1, y1) = self.corners
            return shapely.box(min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1))
        return shapely.Polygon(self.corners)


@dataclass(frozen=True, slots=True)
class Door:
    """A door in the wall between two rooms.

    Attributes
    ----------
    rooms : tuple of int
        Numbers of the two rooms.
    width : float
        From jamb to jamb, metres.
    at : float
        Where along the wall that they share, as a share of the room that there is for it: 0 is one end, 1 the other.
    """

    rooms: tuple[int, int]
    width: float = 0.9
    at: float = 0.5


def draft_plan(
    name: str,
    rooms: Sequence[Room],
    doors: Sequence[Door],
    *,
    wall: float = 0.03,
    start: Sequence[int] = (),
    source: str = "",
) -> FloorPlan:
    """Draw a floor plan.

    Parameters
    ----------
    name : str
        What to call it.
    rooms : sequence of Room
        Convex, not overlapping, their numbers 1 to N in any order.
    doors : sequence of Door
        At most one between two rooms.
    wall : float
        Largest thickness of a wall, metres.
    start : sequence of int
        Numbers of the rooms in which a team starts.
    source : str
        What the plan says that it comes from.

    Raises
    ------
    PlanError
        If a room is not convex or two overlap, or a wall has not enough length for its door.
    """
    cells, segments = draft_rooms(rooms, doors, wall=wall)
    labels = [
        Label(_middle(cells[room.number]), room.name, room.number) for room in sorted(rooms, key=lambda r: r.number)
    ]
    return make_plan(list(cells.values()), name=name, doors=segments, labels=labels, start=start, source=source)


def draft_rooms(
    rooms: Sequence[Room], doors: Sequence[Door], *, wall: float = 0.03
) -> tuple[dict[int, shapely.Polygon], list[shapely.LineString]]:
    """Return the exactly convex free space of each room by its number, and the door segments of a sketch.

    Parameters
    ----------
    rooms, doors : sequence of Room, Door
        The sketch.
    wall : float
        Thickness of the walls, metres.
    """
    outlines = {room.number: room.outline for room in rooms}
    _check_rooms(rooms, outlines)
    segments = [_segment(door, outlines, wall) for door in doors]
    cells: dict[int, shapely.Polygon] = {}
    for number, outline in outlines.items():
        inset = shapely.buffer(outline, -wall / 2, join_style="mitre")
        own = [segment for door, segment in zip(doors, segments, strict=True) if number in door.rooms]
        cells[number] = _hull(shapely.GeometryCollection([inset, *own]))
    return cells, segments


def _check_rooms(rooms: Sequence[Room], outlines: dict[int, shapely.Polygon]) -> None:
    if sorted(room.number for room in rooms) != list(range(1, len(rooms) + 1)):
        raise PlanError(f"The numbers of the {len(rooms)} rooms must be 1 to {len(rooms)}, each once.")
    for number, outline in outlines.items():
        if outline.area == 0 or not outline.is_valid or outline.area < outline.convex_hull.area * (1 - 1e-9):
            raise PlanError(f"Room {number} is not convex.")
    numbers, shapes = list(outlines), list(outlines.values())
    for i, j in shapely.STRtree(shapes).query(shapes, predicate="intersects").T:
        if i < j and shapes[i].intersection(shapes[j]).area > 1e-6:
            raise PlanError(f"Rooms {numbers[i]} and {numbers[j]} overlap.")


def _segment(door: Door, outlines: dict[int, shapely.Polygon], wall: float) -> shapely.LineString:
    """Place a door in the wall that its rooms share, clear of the thickness of the walls at its ends."""
    a, b = (outlines[number] for number in door.rooms)
    shared = shapely.line_merge(a.intersection(b))
    room = shared.length - wall - door.width
    if shared.geom_type != "LineString" or room < -1e-9:
        raise PlanError(
            f"Rooms {door.rooms[0]} and {door.rooms[1]} share {shared.length:.3g} m of wall, "
            f"too little for a door of {door.width} m between walls of {wall} m."
        )
    ends = np.array(sorted(shared.coords[i] for i in (0, -1)))
    along = (ends[1] - ends[0]) / shared.length
    first = ends[0] + along * (wall / 2 + max(room, 0.0) * door.at)
    return shapely.LineString(np.round([first, first + along * door.width], 3))


def _hull(geometry: shapely.GeometryCollection) -> shapely.Polygon:
    """Convex hull on the millimetre grid, exactly convex: computed with whole numbers of millimetres."""
    millimetres = np.round(shapely.get_coordinates(geometry) * 1000.0)
    hull = shapely.convex_hull(shapely.MultiPoint(millimetres))
    return shapely.Polygon(shapely.get_coordinates(hull) / 1000.0)


def _middle(cell: shapely.Polygon) -> tuple[float, float]:
    return cell.centroid.x, cell.centroid.y
