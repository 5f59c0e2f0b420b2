"""Floor plans as GeoJSON: the product's own schema, and the plainest thing that a person would write.

A FeatureCollection, a Feature or a bare geometry. Coordinates are metres unless a member ``units`` names another unit,
or they can only be longitude and latitude. The property ``kind`` of a feature says what it is:

- ``free`` or ``room``, or nothing at all: polygons of free space
- ``wall`` or ``obstacle``: polygons, or lines with a property ``width``, that are cut out of it
- ``door``: a line from jamb to jamb; on a wall of up to half a metre that runs right through, the opening is cut
- ``label``: a point with a ``name``, a ``number`` or both (a room may carry these itself)

Other members, all optional: ``name`` of the plan, ``start``, the numbers of the cells in which a team starts.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import shapely
from shapely.geometry.base import BaseGeometry

from maps.errors import PlanError, nearest, shown
from maps.floorplan import FloorPlan, Label
from maps.making import make_plan
from maps.texts import load_json, write_whole
from maps.units import ToMetres, frame_of, is_number

__all__ = ["features_of", "geojson_text", "load_geojson", "parse_geometry", "read_geojson", "write_geojson"]

KINDS = ("free", "room", "wall", "obstacle", "door", "label")
GEOMETRIES = ("Point", "MultiPoint", "LineString", "MultiLineString", "Polygon", "MultiPolygon", "GeometryCollection")


def read_geojson(path: Path, *, units: str | None = None, name: str = "", source: str = "") -> FloorPlan:
    """Read a floor plan in our own schema.

    Parameters
    ----------
    path : Path
        A ``.geojson`` or ``.json`` file.
    units : str or None
        Unit of the coordinates if the file names none.
    name : str
        Name of the plan if the file gives none; the stem of the file by default.
    source : str
        What the plan says that it comes from; the path by default.

    Raises
    ------
    PlanError
        If the file is not GeoJSON, has a kind, unit or geometry that does not belong, or no free space.
    """
    where = source or str(path)
    data = load_geojson(path, where)
    free, solid, doors, labels = [], [], [], []
    for i, (geometry, properties) in enumerate(features_of(data, where)):
        at = f"{where}: feature {i + 1}"
        kind = properties.get("kind", "label" if geometry.geom_type == "Point" else "free")
        if kind not in KINDS:
            raise PlanError(f"{at} has the kind {shown(kind)}; {nearest(str(kind), KINDS)}")
        if kind in ("free", "room"):
            free.append(_polygonal(geometry, at, kind))
        elif kind in ("wall", "obstacle"):
            solid.append((geometry, properties.get("width"), at))
        elif kind == "door":
            doors.append(geometry)
        if kind == "label" or (kind in ("free", "room") and properties.keys() & {"name", "number"}):
            labels.append((geometry, properties, at))
    if not free:
        raise PlanError(f"{where}: there is no free space in it, no polygon of kind 'free' or 'room'.")

    to_metres, scale, repairs = frame_of(shapely.get_coordinates(free), data.get("units", units), where)
    return make_plan(
        [shapely.transform(g, to_metres) for g in free],
        name=_text(data, "name", where) or name or path.stem,
        solid=[_solid(g, width, scale, to_metres, at) for g, width, at in solid],
        doors=[shapely.transform(g, to_metres) for g in doors],
        labels=[_label(shapely.transform(g, to_metres), properties, at) for g, properties, at in labels],
        start=_numbers(data, where),
        source=where,
        repairs=repairs,
    )


def load_geojson(path: Path, where: str) -> dict[str, Any]:
    """Load a JSON file whose top is an object; PlanError otherwise."""
    data = load_json(path, where)
    if not isinstance(data, dict):
        raise PlanError(f"{where}: a GeoJSON file is one object, not a {type(data).__name__}.")
    return data


def features_of(data: dict[str, Any], where: str) -> Iterator[tuple[BaseGeometry, dict[str, Any]]]:
    """Yield the geometries of a GeoJSON object with their properties; features without geometry are left out."""
    kind = data.get("type")
    if kind == "FeatureCollection":
        features = data.get("features")
        if not isinstance(features, list):
            raise PlanError(f"{where}: a FeatureCollection needs a list 'features', not {type(features).__name__}.")
    elif kind == "Feature":
        features = [data]
    elif kind in GEOMETRIES:
        features = [{"type": "Feature", "geometry": data}]
    else:
        valid = ("FeatureCollection", "Feature", *GEOMETRIES)
        raise PlanError(
            f"{where}: the member 'type' is {shown(kind)}, so this is not GeoJSON; {nearest(str(kind), valid)}"
        )
    for i, feature in enumerate(features):
        at = f"{where}: feature {i + 1}"
        if not isinstance(feature, dict) or feature.get("type") != "Feature":
            raise PlanError(f"{at} is not an object of type 'Feature'.")
        properties = feature.get("properties") or {}
        if not isinstance(properties, dict):
            raise PlanError(f"{at} has properties that are no object but a {type(properties).__name__}.")
        if feature.get("geometry") is not None:
            yield parse_geometry(feature["geometry"], at), properties


def parse_geometry(data: object, at: str) -> BaseGeometry:
    """Make a shapely geometry of a GeoJSON geometry; PlanError where its type or its coordinates are wrong."""
    kind = data.get("type") if isinstance(data, dict) else data
    if not isinstance(data, dict) or kind not in GEOMETRIES:
        raise PlanError(f"{at} has the geometry type {shown(kind)}; {nearest(str(kind), GEOMETRIES)}")
    try:
        return shapely.force_2d(shapely.from_geojson(json.dumps(_closed(data))))
    except (shapely.GEOSException, KeyError, ValueError, TypeError) as exc:
        raise PlanError(f"{at} is a {kind} whose coordinates are not as GeoJSON says.") from exc


def _closed(data: dict[str, Any]) -> dict[str, Any]:
    """Close the rings of a polygon: a person who writes one by hand forgets to repeat the first vertex."""
    if data.get("type") == "Polygon":
        return {**data, "coordinates": [_close(ring) for ring in data["coordinates"]]}
    if data.get("type") == "MultiPolygon":
        return {**data, "coordinates": [[_close(ring) for ring in polygon] for polygon in data["coordinates"]]}
    return data


def _close(ring: list[Any]) -> list[Any]:
    return ring if not ring or ring[0] == ring[-1] else [*ring, ring[0]]


def _polygonal(geometry: BaseGeometry, at: str, kind: str) -> BaseGeometry:
    if geometry.geom_type not in ("Polygon", "MultiPolygon", "GeometryCollection"):
        raise PlanError(f"{at} is a {geometry.geom_type} of kind {kind!r}; free space is made of polygons.")
    return geometry


def _solid(
    geometry: BaseGeometry,
    width: object,
    scale: float,
    to_metres: ToMetres,
    at: str,
) -> BaseGeometry:
    """Make the polygon of a wall or an obstacle, in metres."""
    wall = shapely.transform(geometry, to_metres)
    if geometry.geom_type in ("Polygon", "MultiPolygon"):
        return wall
    if geometry.geom_type not in ("LineString", "MultiLineString"):
        raise PlanError(f"{at} is a {geometry.geom_type}; walls and obstacles are polygons or lines.")
    if width is None:
        raise PlanError(f"{at} is a wall drawn as a line; its property 'width', how thick it is, is missing.")
    thickness = float(width) * scale if is_number(width) else 0.0  # type: ignore[arg-type]
    if not 0 < thickness < 100:
        raise PlanError(
            f"{at} is a wall drawn as a line; its property 'width' must be a thickness, not {shown(width)}."
        )
    return shapely.buffer(wall, thickness / 2, cap_style="square", join_style="mitre")


def _label(geometry: BaseGeometry, properties: dict[str, Any], at: str) -> Label:
    number = properties.get("number")
    if number is not None and (isinstance(number, bool) or not isinstance(number, int)):
        raise PlanError(f"{at} has the number {shown(number)}; room numbers are whole numbers from 1.")
    name = properties.get("name")
    point = shapely.point_on_surface(geometry)
    if point.is_empty:
        raise PlanError(f"{at} is a label without a place; its geometry is empty.")
    return Label((point.x, point.y), "" if name is None else str(name), number)


def _text(data: dict[str, Any], key: str, where: str) -> str:
    value = data.get(key, "")
    if not isinstance(value, str):
        raise PlanError(f"{where}: the member {key!r} is {shown(value)}; it must be a text.")
    return value


def _numbers(data: dict[str, Any], where: str) -> list[int]:
    start = data.get("start", [])
    if not isinstance(start, list):
        raise PlanError(f"{where}: start is a list of cell numbers from 1, not {shown(start)}.")
    return start


def write_geojson(plan: FloorPlan, path: Path) -> Path:
    """Write a ``plan`` in our own schema to a ``path``; reading it back gives the same plan."""
    write_whole(path, geojson_text(plan).encode())
    return path


def geojson_text(plan: FloorPlan) -> str:
    """Return what :func:`write_geojson` writes: one feature a line, coordinates in metres to a millimetre."""
    features = [_feature(plan.space, {"kind": "free"})]
    features += [_feature(door, {"kind": "door"}) for door in plan.doors]
    for label in plan.labels:
        numbered = {} if label.number is None else {"number": label.number}
        named = {"name": label.name} if label.name else {}
        features.append(_feature(shapely.Point(label.point), {"kind": "label", **numbered, **named}))
    head = {"type": "FeatureCollection", "name": plan.name, "units": "m"}
    if plan.start:
        head["start"] = list(plan.start)  # type: ignore[assignment]
    lines = ",\n".join(json.dumps(feature, ensure_ascii=False) for feature in features)
    return json.dumps(head, ensure_ascii=False)[:-1] + ', "features": [\n' + lines + "\n]}\n"


def _feature(geometry: BaseGeometry, properties: dict[str, Any]) -> dict[str, Any]:
    shape = json.loads(shapely.to_geojson(geometry))
    return {
        "type": "Feature",
        "properties": properties,
        "geometry": {**shape, "coordinates": _rounded(shape["coordinates"])},
    }


def _rounded(coordinates: Any) -> Any:
    if isinstance(coordinates, list):
        return [_rounded(c) for c in coordinates]
    value = round(coordinates, 3) + 0.0
    return int(value) if value == int(value) else value
