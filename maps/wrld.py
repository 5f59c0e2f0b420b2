"""Indoor maps of WRLD as GeoJSON: an outline of the storey, and the walls, windows and doors in it as polygons."""

from __future__ import annotations

from pathlib import Path

import shapely

from maps.errors import PlanError
from maps.floorplan import FloorPlan, Label
from maps.geojson import features_of, load_geojson
from maps.making import make_plan
from maps.openings import long_axis
from maps.units import frame_of

__all__ = ["read_wrld"]

SOLID = ("wall", "window", "inaccessible_space")
ROOMS = ("room", "bathroom", "stairs", "elevator", "escalator")


def read_wrld(path: Path) -> FloorPlan:
    """Read a storey: the building's outline without walls, windows and what nobody can enter; doors are open.

    Raises
    ------
    PlanError
        If the file is not GeoJSON or has no building outline.
    """
    where = str(path)
    features = [(g, p) for g, p in features_of(load_geojson(path, where), where)]
    outline = [g for g, p in features if p.get("type") == "building_outline"]
    if not outline:
        raise PlanError(f"{where}: there is no free space in it, no feature of type 'building_outline'.")
    to_metres, _, repairs = frame_of(shapely.get_coordinates(outline), None, where)
    features = [(shapely.transform(g, to_metres), p) for g, p in features]
    rooms = [(shapely.point_on_surface(g), p) for g, p in features if p.get("type") in ROOMS]
    doors = [long_axis(g) for g, p in features if p.get("type") == "door" and g.area > 0]
    return make_plan(
        [g for g, p in features if p.get("type") == "building_outline"],
        name=path.stem,
        solid=[g for g, p in features if p.get("type") in SOLID],
        doors=[shapely.LineString([m - u * width / 2, m + u * width / 2]) for m, u, width in doors],
        labels=[Label((point.x, point.y), str(p.get("name") or p["type"])) for point, p in rooms],
        source=where,
        repairs=repairs,
    )
