"""Rooms that a source draws apart, and the openings that its doors make between them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from maps.floorplan import Repair

__all__ = ["DOOR", "REACH", "WALL", "Opening", "long_axis", "open_door", "thick_walls", "wall_at"]

DOOR = 0.9
"""Width of a door whose source does not say how wide it is, metres."""

WALL = 0.1
"""Thickness of a wall whose source draws it without any, metres."""

REACH = 0.6
"""A door leads to rooms that are at most this far from its middle, metres: half the thickest wall."""

Opening = tuple[shapely.Polygon, shapely.LineString]


def open_door(
    centre: NDArray[np.float64], along: NDArray[np.float64], width: float, rooms: Sequence[shapely.Polygon]
) -> Opening | None:
    """Make the opening of a door through the wall between two rooms.

    Parameters
    ----------
    centre : ndarray, shape (2,)
        Middle of the door, metres.
    along : ndarray, shape (2,)
        Direction of its wall, length 1.
    width : float
        From jamb to jamb, metres.
    rooms : sequence of shapely.Polygon
        Free spaces, some of them near.

    Returns
    -------
    tuple of shapely.Polygon and shapely.LineString, or None
        The floor within the wall, a little of it in each room, and the door segment; None if there are not two
        different rooms on its two sides.
    """
    across = np.array([-along[1], along[0]])
    ends = [centre - along * width / 2, centre + along * width / 2]
    sides = []
    for sign in (-1.0, 1.0):
        strip = shapely.Polygon([*ends, ends[1] + sign * REACH * across, ends[0] + sign * REACH * across])
        near = [(room.distance(shapely.Point(centre)), k) for k, room in enumerate(rooms) if _overlap(room, strip)]
        sides.append(near)
    (left, right) = sides
    pairs = [(d + e, k, m) for d, k in left for e, m in right if k != m]
    if not pairs:
        return None
    _, first, second = min(pairs)
    depth = 2 * 0.02 + max(_depth(rooms[k], ends) for k in (first, second))
    corners = [ends[0] - depth * across, ends[1] - depth * across, ends[1] + depth * across, ends[0] + depth * across]
    floor = shapely.Polygon(corners)
    others = [room for k, room in enumerate(rooms) if k not in (first, second) and room.intersects(floor)]
    if others:
        rest = floor.difference(shapely.buffer(shapely.union_all(others), 0.02, join_style="mitre"))
        floor = max((p for p in shapely.get_parts(rest) if isinstance(p, shapely.Polygon)), key=lambda part: part.area)
    if not all(_overlap(rooms[k], floor) for k in (first, second)):
        return None
    return floor, shapely.LineString(ends)


def _overlap(room: shapely.Polygon, strip: shapely.Polygon) -> bool:
    return bool(room.intersects(strip)) and float(room.intersection(strip).area) > 1e-6


def _depth(room: shapely.Polygon, ends: list[NDArray[np.float64]]) -> float:
    """How far the further end or the middle of a door is from a room."""
    points = [*ends, (ends[0] + ends[1]) / 2]
    return min(REACH, max(room.distance(shapely.Point(point)) for point in points))


def thick_walls(rooms: Sequence[shapely.Polygon]) -> tuple[list[shapely.Polygon], Repair]:
    """Take half a wall's thickness off each room all around, where rooms are drawn edge to edge."""
    insets = shapely.buffer(np.array(rooms, dtype=object), -WALL / 2, join_style="mitre")
    kept = [part for part in shapely.get_parts(insets) if isinstance(part, shapely.Polygon) and not part.is_empty]
    message = f"Rooms are drawn without walls between them; each gave up {WALL / 2} m all around for walls of {WALL} m."
    return kept, Repair("thickened walls", message, shapely.GeometryCollection())


def wall_at(
    point: NDArray[np.float64], outline: shapely.Polygon
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Find the wall of an outline that is nearest to a point: the place on it, its direction and its length."""
    ring = min(shapely.get_rings(outline), key=lambda r: r.distance(shapely.Point(point)))
    xy = shapely.get_coordinates(ring)
    start, step = xy[:-1], np.diff(xy, axis=0)
    length2 = np.maximum((step**2).sum(axis=1), 1e-18)
    share = np.clip(((point - start) * step).sum(axis=1) / length2, 0.0, 1.0)
    foot = start + share[:, None] * step
    k = int(np.argmin(((foot - point) ** 2).sum(axis=1)))
    length = float(np.sqrt(length2[k]))
    return foot[k], step[k] / length, length


def long_axis(polygon: BaseGeometry) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Middle, direction and length of the longer side of the smallest box around a polygon."""
    box = shapely.get_coordinates(shapely.oriented_envelope(polygon))[:4]
    sides = np.roll(box, -1, axis=0) - box
    k = int(np.argmax((sides**2).sum(axis=1)))
    length = float(np.hypot(*sides[k]))
    return box.mean(axis=0), sides[k] / length, length
