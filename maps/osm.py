"""OpenStreetMap's Simple Indoor Tagging as GeoJSON (https://wiki.openstreetmap.org/wiki/Simple_Indoor_Tagging).

Rooms have walls, corridors and areas have none of their own; doors are points on a room's outline. OpenStreetMap draws
walls without thickness, so each room gives up half a wall's all around.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from maps.errors import PlanError
from maps.floorplan import FloorPlan, Label, Repair
from maps.geojson import features_of, load_geojson
from maps.levels import choose_level
from maps.making import make_plan
from maps.openings import DOOR, WALL, Opening, open_door, thick_walls, wall_at
from maps.units import frame_of

__all__ = ["read_osm"]

WALLED = ("room",)
OPEN = ("corridor", "area", "yes")


class _Feature(NamedTuple):
    geometry: BaseGeometry
    tags: dict[str, Any]


def read_osm(path: Path, *, level: str | int | None = None) -> FloorPlan:
    """Read one storey of a building.

    Parameters
    ----------
    path : Path
        A ``.geojson`` file whose features have the property ``indoor``.
    level : str, int or None
        The storey; by default the largest.

    Raises
    ------
    PlanError
        If the file is not GeoJSON, there is no room on it or no such storey.
    """
    where = str(path)
    features = [_Feature(*feature) for feature in features_of(load_geojson(path, where), where)]
    to_metres, _, repairs = frame_of(_rooms_xy(features, where), None, where)
    features = [_Feature(shapely.transform(f.geometry, to_metres), f.tags) for f in features]
    level, said = choose_level(_floor_areas(features), level, where)
    repairs += said
    here = [f for f in features if _is_on(level, f.tags.get("level"))]
    walled = _polygons(f for f in here if f.tags.get("indoor") in WALLED)
    walks = _polygons(f for f in here if f.tags.get("indoor") in OPEN)
    insets, thickened = thick_walls(walled)
    repairs += [thickened] if insets else []
    outside_rooms = shapely.difference(shapely.union_all(walks), shapely.union_all(walled))
    open_floors = [part for part in shapely.get_parts(outside_rooms) if isinstance(part, shapely.Polygon)]
    openings = _openings(here, walled, [*insets, *open_floors], repairs)
    return make_plan(
        [*insets, *open_floors, *(floor for floor, _ in openings)],
        name=path.stem,
        solid=_solid(here),
        doors=[door for _, door in openings],
        labels=_labels(here),
        source=where,
        repairs=repairs,
    )


def _rooms_xy(features: list[_Feature], where: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    rooms = [f.geometry for f in features if f.tags.get("indoor") in WALLED + OPEN and f.geometry.area > 0]
    if not rooms:
        raise PlanError(f"{where}: there is no free space in it, no polygon with indoor = room, corridor or area.")
    return shapely.get_coordinates(rooms)


def _floor_areas(features: list[_Feature]) -> dict[str, float]:
    """Floor area of each level that has a room of its own, in the order of the levels."""
    areas: dict[str, float] = {}
    for f in features:
        level = str(f.tags.get("level", "0"))
        if f.tags.get("indoor") in WALLED + OPEN and re.fullmatch(r"-?\d+(\.\d+)?", level):
            areas[level] = areas.get(level, 0.0) + float(f.geometry.area)
    return dict(sorted(areas.items(), key=lambda item: float(item[0])))


def _is_on(level: str, tag: Any) -> bool:
    """Whether a level is one of those that a tag names: "1", "0;2", "0-3" or "-1-3"; without a tag it is 0."""
    for part in str("0" if tag is None else tag).split(";"):
        span = re.fullmatch(r"\s*(-?\d+(?:\.\d+)?)\s*-\s*(-?\d+(?:\.\d+)?)\s*", part)
        if span and float(span[1]) <= float(level) <= float(span[2]):
            return True
        if part.strip() == level:
            return True
    return False


def _polygons(features: Iterable[_Feature]) -> list[shapely.Polygon]:
    valid = [shapely.make_valid(f.geometry, method="structure", keep_collapsed=False) for f in features]
    return [p for p in shapely.get_parts(valid) if isinstance(p, shapely.Polygon) and not p.is_empty]


def _solid(here: list[_Feature]) -> list[BaseGeometry]:
    """Walls and columns that are drawn on their own."""
    solid = []
    for f in here:
        if f.tags.get("indoor") in ("wall", "column") and f.geometry.length > 0:
            flat = f.geometry.area > 0
            solid.append(f.geometry if flat else shapely.buffer(f.geometry, WALL / 2, cap_style="flat"))
    return solid


def _openings(
    here: list[_Feature], walled: list[shapely.Polygon], floors: list[shapely.Polygon], repairs: list[Repair]
) -> list[Opening]:
    """Open the doors between two floors; doors to the outside lead nowhere on this plan."""
    found: list[Opening] = []
    assumed: list[shapely.Point] = []
    outer: list[shapely.Point] = []
    tree = shapely.STRtree(walled)
    for f in here:
        if not isinstance(f.geometry, shapely.Point) or "door" not in f.tags or not walled:
            continue
        room = walled[int(tree.nearest(f.geometry))]
        middle, along, _ = wall_at(shapely.get_coordinates(f.geometry)[0], room)
        width = _width(f.tags)
        opening = open_door(middle, along, width or DOOR, floors)
        if opening is None:
            outer.append(f.geometry)
            continue
        found.append(opening)
        if width is None:
            assumed.append(f.geometry)
    if assumed:
        message = f"{len(assumed)} door(s) without a width were taken to be {DOOR} m wide."
        repairs.append(Repair("assumed width", message, shapely.MultiPoint(assumed)))
    if outer:
        message = f"{len(outer)} door(s) that do not join two rooms of this level were left out."
        repairs.append(Repair("left out", message, shapely.MultiPoint(outer)))
    return found


def _width(tags: dict[str, Any]) -> float | None:
    match = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*m?\s*", str(tags.get("width", "")))
    return float(match[1]) if match and 0.4 <= float(match[1]) <= 10 else None


def _labels(here: list[_Feature]) -> list[Label]:
    found = []
    for f in here:
        name = f.tags.get("name") or f.tags.get("ref")
        if name and f.tags.get("indoor") in WALLED + OPEN and f.geometry.area > 0:
            point = shapely.point_on_surface(f.geometry)
            found.append(Label((point.x, point.y), str(name)))
    return found
