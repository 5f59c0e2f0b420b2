"""Houses of the HouseExpo data set (T. Li et al., "HouseExpo", 2019): one outline in metres, and boxes of rooms."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import shapely

from maps.errors import PlanError
from maps.floorplan import FloorPlan, Label
from maps.making import make_plan
from maps.texts import load_json

__all__ = ["read_houseexpo"]


def read_houseexpo(path: Path) -> FloorPlan:
    """Read a house; the middles of the boxes of its rooms become labels.

    Raises
    ------
    PlanError
        If the vertices are not a list of pairs of numbers.
    """
    where = str(path)
    data = load_json(path, where)
    outline = shapely.Polygon(_pairs(data.get("verts"), where))
    return make_plan(outline, name=path.stem, labels=_labels(data, outline, where), source=where)


def _pairs(vertices: Any, where: str) -> list[tuple[float, float]]:
    try:
        pairs = [(float(x), float(y)) for x, y in vertices]
    except (TypeError, ValueError) as exc:
        raise PlanError(f"{where}: verts must be a list of pairs of numbers.") from exc
    if len(pairs) < 3:
        raise PlanError(f"{where}: verts has {len(pairs)} vertices; a house needs at least 3.")
    return pairs


def _labels(data: dict[str, Any], outline: shapely.Polygon, where: str) -> list[Label]:
    rooms = data.get("room_category", {})
    try:
        boxes = [(kind, _box(box)) for kind, found in rooms.items() for box in found]
    except (AttributeError, TypeError, ValueError) as exc:
        raise PlanError(f"{where}: room_category must give for each kind of room a list of boxes.") from exc
    names = [(kind.replace("_", " ").lower(), box.centroid) for kind, box in boxes]
    return [Label((point.x, point.y), name) for name, point in names if outline.is_valid and outline.contains(point)]


def _box(corners: Any) -> shapely.Polygon:
    x0, y0, x1, y1 = (float(v) for v in corners)
    return shapely.box(x0, y0, x1, y1)
