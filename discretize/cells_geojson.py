"""Cells as GeoJSON, to be looked at, edited and read back."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import shapely
from shapely.geometry import mapping, shape
from shapely.geometry.base import BaseGeometry

from discretize.cellmap import CellMap
from discretize.covering import cover_problems
from discretize.cutting import connect_cells
from discretize.errors import DiscretizeError
from discretize.numbering import number_cells
from discretize.partition import Partition
from discretize.routes import ways_of
from maps import FloorPlan, Label
from maps.texts import load_json

__all__ = ["cells_text", "read_cells", "write_cells"]


def write_cells(cellmap: CellMap, path: Path) -> None:
    """Write cells as polygons and portals as lines, in metres, in the plan's own frame.

    A cell's properties are ``number`` (from 1), ``name``, ``area`` (square metres) and ``neighbours`` (numbers); a
    portal's are ``cells`` (two numbers), ``width`` (metres), ``point`` and ``route`` (metres from checkpoint to
    checkpoint).

    Parameters
    ----------
    cellmap : CellMap
        What to write.
    path : Path
        Where to; an existing file is replaced.

    Raises
    ------
    DiscretizeError
        If the file cannot be written.
    """
    try:
        path.write_text(cells_text(cellmap), encoding="utf-8")
    except OSError as exc:
        raise DiscretizeError(f"Cannot write cells to {path}: {exc.strerror}.") from exc


def cells_text(cellmap: CellMap) -> str:
    """Return what :func:`write_cells` writes."""
    neighbours: list[list[int]] = [[] for _ in cellmap.cells]
    for a, b in cellmap.edges:
        neighbours[a].append(b + 1)
        neighbours[b].append(a + 1)
    features: list[dict[str, Any]] = [
        _feature(
            cell,
            kind="cell",
            number=k + 1,
            name=cellmap.names[k],
            area=round(float(cellmap.areas[k]), 6),
            neighbours=sorted(neighbours[k]),
        )
        for k, cell in enumerate(cellmap.cells)
    ]
    features += [
        _feature(
            shapely.LineString(portal.segment),
            kind="portal",
            cells=[k + 1 for k in portal.cells],
            width=round(portal.width, 6),
            point=portal.point.tolist(),
            route=round(sum(float(shapely.LineString(leg).length) for leg in portal.legs), 6),
        )
        for portal in cellmap.portals
    ]
    document = {
        "type": "FeatureCollection",
        "plan": cellmap.plan.name,
        "method": cellmap.method,
        "radius": cellmap.radius,
        "units": "m",
        "features": features,
    }
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


def read_cells(path: Path, plan: FloorPlan, *, radius: float = 0.2) -> CellMap:
    """Read cells that :func:`write_cells` wrote or a person drew, and find their portals and routes afresh.

    Numbers count where they are 1 to N; otherwise, say after two cells were joined, cells are numbered like a page.
    Lines and points are passed over.

    Parameters
    ----------
    path : Path
        A GeoJSON FeatureCollection, metres, in the plan's own frame.
    plan : FloorPlan
        What the cells cover.
    radius : float
        Radius of the largest body that will use the map, metres.

    Raises
    ------
    DiscretizeError
        If the file cannot be read, a feature is no cell, or cells do not cover the free space once; the message
        names the feature or the place.
    """
    polygons: list[shapely.Polygon] = []
    labels: list[Label] = []
    for where, feature in _features(path):
        polygon = _polygon(where, feature.get("geometry"))
        if polygon is None:
            continue
        point = polygon.representative_point()
        name, number = _name_and_number(where, feature.get("properties") or {})
        polygons.append(polygon)
        labels.append(Label((point.x, point.y), name, number))
    if not polygons:
        raise DiscretizeError(f"{path} has no polygon, so no cell.")
    cells, names = number_cells(polygons, labels)
    wrong = cover_problems(plan, cells)
    if wrong:
        raise DiscretizeError(f"{path}: {wrong[0]}")
    return connect_cells(plan, Partition(cells, 1.0, strict=False), names, ways_of(plan.space, radius), "file")


def _feature(geometry: BaseGeometry, **properties: object) -> dict[str, Any]:
    return {"type": "Feature", "properties": properties, "geometry": mapping(geometry)}


def _features(path: Path) -> Sequence[tuple[str, dict[str, Any]]]:
    """Every feature of a file with the words that name it in a message."""
    document = load_json(path, str(path), DiscretizeError)
    found = document.get("features") if isinstance(document, dict) else None
    if not isinstance(found, list) or document.get("type") != "FeatureCollection":
        raise DiscretizeError(f"{path} is not a GeoJSON FeatureCollection.")
    for k, feature in enumerate(found, 1):
        properties = feature.get("properties") if isinstance(feature, dict) else None
        if not isinstance(feature, dict) or not isinstance(properties, dict | None):
            raise DiscretizeError(f"{path}, feature {k}: not a GeoJSON feature.")
    return [(f"{path}, feature {k}", feature) for k, feature in enumerate(found, 1)]


def _polygon(where: str, geometry: Any) -> shapely.Polygon | None:
    """Shape of a cell; None for a line or a point."""
    try:
        polygon = shape(geometry)
    except Exception as exc:  # what shapely raises depends on how the geometry is broken
        raise DiscretizeError(f"{where}: its geometry cannot be read ({exc}).") from exc
    if isinstance(polygon, shapely.LineString | shapely.Point):
        return None
    if isinstance(polygon, shapely.MultiPolygon) and len(polygon.geoms) == 1:
        polygon = polygon.geoms[0]
    if not isinstance(polygon, shapely.Polygon) or polygon.is_empty:
        raise DiscretizeError(
            f"{where}: a cell is one polygon, not {'an empty ' * polygon.is_empty}{polygon.geom_type}."
        )
    if not shapely.is_valid(polygon):
        raise DiscretizeError(f"{where}: not a simple polygon ({shapely.is_valid_reason(polygon)}).")
    return polygon


def _name_and_number(where: str, properties: dict[str, Any]) -> tuple[str, int | None]:
    name, number = properties.get("name"), properties.get("number")
    if not isinstance(name, str | None):
        raise DiscretizeError(f"{where}: its name must be text, not {name!r}.")
    if isinstance(number, bool) or not isinstance(number, int | None):
        raise DiscretizeError(f"{where}: its number must be a whole number, not {number!r}.")
    return name or "", number
