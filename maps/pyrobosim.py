"""Worlds of PyRoboSim (https://pyrobosim.readthedocs.io): rooms with footprints, and hallways that join them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from maps.errors import PlanError, nearest
from maps.floorplan import FloorPlan, Label, Repair
from maps.making import make_plan
from maps.texts import load_yaml

__all__ = ["read_pyrobosim"]


def read_pyrobosim(path: Path) -> FloorPlan:
    """Read the rooms and hallways of a world; metres. Furniture, whose sizes are in other files, is left out.

    Raises
    ------
    PlanError
        If a room or a hallway is not as PyRoboSim says.
    """
    where = str(path)
    data = load_yaml(path, where)
    rooms: dict[str, shapely.Polygon] = {}
    for i, room in enumerate(_entries(data, "rooms", where)):
        name = str(room.get("name", f"room_{i}"))
        rooms[name] = _room(room, f"{where}: room {name!r}")
    if not rooms:
        raise PlanError(f"{where}: there is no free space in it, no room at all.")
    halls = [
        _hallway(hall, rooms, f"{where}: hallway {i + 1}") for i, hall in enumerate(_entries(data, "hallways", where))
    ]
    repairs = []
    furniture = _entries(data, "locations", where)
    if furniture:
        message = f"{len(furniture)} piece(s) of furniture were left out; their sizes are not in this file."
        repairs.append(Repair("left out", message, shapely.GeometryCollection()))
    middles = [(name, shapely.point_on_surface(room)) for name, room in rooms.items()]
    return make_plan(
        [*rooms.values(), *halls],
        name=path.stem,
        labels=[Label((p.x, p.y), name) for name, p in middles],
        source=where,
        repairs=repairs,
    )


def _entries(data: dict[str, Any], key: str, where: str) -> list[dict[str, Any]]:
    entries = data.get(key) or []
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise PlanError(f"{where}: {key} must be a list of keys and values.")
    return entries


def _room(room: dict[str, Any], at: str) -> shapely.Polygon:
    footprint = room.get("footprint")
    kind = footprint.get("type") if isinstance(footprint, dict) else footprint
    shapes = ("polygon", "box", "circle")
    if not isinstance(footprint, dict) or kind not in shapes:
        raise PlanError(f"{at} has a footprint of type {kind!r}; {nearest(str(kind), shapes)}")
    try:
        if kind == "polygon":
            outline = shapely.Polygon([(float(x), float(y)) for x, y in footprint["coords"]])
        elif kind == "box":
            width, height = (float(v) for v in footprint["dims"])
            outline = shapely.box(-width / 2, -height / 2, width / 2, height / 2)
        else:
            outline = shapely.Point(0, 0).buffer(float(footprint["radius"]))
        x, y = (float(v) for v in footprint.get("offset", [0.0, 0.0]))
        return _placed(shapely.affinity.translate(outline, x, y), room.get("pose"))
    except (KeyError, TypeError, ValueError, AttributeError) as exc:
        raise PlanError(f"{at} has a footprint or a pose whose numbers are missing or wrong.") from exc


def _placed(outline: shapely.Polygon, pose: Any) -> shapely.Polygon:
    """Turn and move a footprint to its pose: a mapping, or a list x, y, z, yaw or x, y, z, roll, pitch, yaw."""
    if pose is None:
        return outline
    if isinstance(pose, list):
        x, y = float(pose[0]), float(pose[1])
        yaw = float(pose[3]) if len(pose) == 4 else float(pose[5]) if len(pose) == 6 else 0.0
    else:
        position, turn = pose.get("position", {}), pose.get("rotation_eul", {})
        x, y, yaw = float(position.get("x", 0.0)), float(position.get("y", 0.0)), float(turn.get("yaw", 0.0))
        yaw = math.radians(yaw) if turn.get("angle_units") == "degrees" else yaw
    turned = shapely.affinity.rotate(outline, yaw, origin=(0, 0), use_radians=True)
    return shapely.affinity.translate(turned, x, y)


def _hallway(hall: dict[str, Any], rooms: dict[str, shapely.Polygon], at: str) -> shapely.Polygon:
    names = hall.get("room_start"), hall.get("room_end")
    for name in names:
        if name not in rooms:
            raise PlanError(f"{at} leads to the room {name!r}, which is not there; {nearest(str(name), rooms)}")
    start, end = rooms[str(names[0])], rooms[str(names[1])]
    method = hall.get("conn_method", "auto")
    methods = ("auto", "angle", "points")
    if method not in methods:
        raise PlanError(f"{at} has the conn_method {method!r}; {nearest(str(method), methods)}")
    try:
        width, offset = float(hall["width"]), float(hall.get("offset", 0.0))
        line: shapely.LineString | None
        if method == "points":
            line = shapely.LineString([(float(x), float(y)) for x, y in hall["conn_points"]])
        else:
            line = _straight(start, end, offset, float(hall["conn_angle"]) if method == "angle" else None)
    except (KeyError, TypeError, ValueError) as exc:
        raise PlanError(f"{at} has numbers that are missing or wrong.") from exc
    if line is None or width <= 0:
        raise PlanError(f"{at} does not reach from the room {names[0]!r} to the room {names[1]!r}.")
    return shapely.buffer(line, width / 2, cap_style="flat", join_style="mitre")


def _straight(
    start: shapely.Polygon, end: shapely.Polygon, offset: float, angle: float | None
) -> shapely.LineString | None:
    """Line from one room's centroid into another room: towards its centroid, or at an angle; both moved sideways."""
    a, b = (np.array(room.centroid.coords[0]) for room in (start, end))
    step = b - a if angle is None else np.array([math.cos(angle), math.sin(angle)])
    if not np.hypot(*step) > 0:
        return None
    step = step / np.hypot(*step)
    a = a + offset * np.array([-step[1], step[0]])
    far = a + step * (np.hypot(*(b - a)) + end.length)
    inside = shapely.LineString([a, far]).intersection(end)
    if inside.is_empty:
        return None
    reach = max((shapely.get_coordinates(inside) - a) @ step) if angle is None else _first_middle(inside, a, step)
    return shapely.LineString([a, a + step * min(reach, np.hypot(*(b - a))) if angle is None else a + step * reach])


def _first_middle(inside: shapely.Geometry, a: np.ndarray[Any, Any], step: np.ndarray[Any, Any]) -> float:
    """How far it is to the middle of the stretch within the other room."""
    along = (shapely.get_coordinates(inside) - a) @ step
    return float((along.min() + along.max()) / 2)
