"""Flats of the ResPlan data set: rooms, doors and walls as well-known text in JSON, several flats to a file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import shapely

from maps.errors import PlanError
from maps.floorplan import FloorPlan, Label
from maps.levels import choose_level
from maps.making import make_plan
from maps.openings import long_axis
from maps.texts import load_json
from maps.units import check_resolution

__all__ = ["read_resplan"]

NOT_ROOMS = ("door", "front_door", "window", "wall")


def read_resplan(path: Path, *, resolution: float | None = None, level: str | int | None = None) -> FloorPlan:
    """Read one flat: its rooms and the doors between them.

    Parameters
    ----------
    path : Path
        A ``.json`` file with a list of flats.
    resolution : float
        Size of a unit, metres. There is no default.
    level : str, int or None
        The ``id`` of the flat; by default the largest.

    Raises
    ------
    PlanError
        If there is no resolution, no such flat, or a geometry is not well-known text.
    """
    where = str(path)
    if resolution is None:
        raise PlanError(f"{where}: ResPlan's coordinates have no unit; give the resolution, metres for each of them.")
    metres = check_resolution(resolution, where)
    flats = dict(_shapes(flat, str(k), metres, where) for k, flat in enumerate(load_json(path, where)))
    areas = {
        name: sum(r.area for kind, rs in flat.items() if kind not in NOT_ROOMS for r in rs)
        for name, flat in flats.items()
    }
    chosen, repairs = choose_level(areas, level, where)
    flat = flats[chosen]
    rooms = [(kind, room) for kind, found in flat.items() if kind not in NOT_ROOMS for room in found]
    middles = [(kind, shapely.point_on_surface(room)) for kind, room in rooms]
    doors = [long_axis(door) for door in flat.get("door", [])]
    return make_plan(
        [*(room for _, room in rooms), *flat.get("door", [])],
        name=f"{path.stem}-{chosen}",
        doors=[shapely.LineString([m - u * width / 2, m + u * width / 2]) for m, u, width in doors],
        labels=[Label((p.x, p.y), kind) for kind, p in middles],
        source=where,
        repairs=repairs,
    )


def _shapes(flat: Any, name: str, metres: float, where: str) -> tuple[str, dict[str, list[shapely.Polygon]]]:
    try:
        name = str(flat.get("id", name))
        found = {kind: shapely.from_wkt(np.array(texts, dtype=object)) for kind, texts in flat["geometries"].items()}
    except (AttributeError, KeyError, TypeError, shapely.GEOSException) as exc:
        raise PlanError(f"{where}: a flat needs 'geometries', lists of well-known text for each kind of room.") from exc
    scaled = {
        kind: shapely.get_parts(shapely.transform(shapes, lambda xy: xy * metres)) for kind, shapes in found.items()
    }
    return name, {kind: [g for g in parts if isinstance(g, shapely.Polygon)] for kind, parts in scaled.items()}
