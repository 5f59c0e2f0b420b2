"""Building models in IFC, with the ``formats`` extra: the spaces of one storey, and the doors between them."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from maps.errors import PlanError
from maps.extras import need
from maps.floorplan import FloorPlan, Label, Repair
from maps.levels import choose_level
from maps.making import make_plan
from maps.openings import long_axis, open_door

__all__ = ["read_ifc"]


def read_ifc(path: Path, *, level: str | int | None = None) -> FloorPlan:
    """Read one storey of a building model.

    Parameters
    ----------
    path : Path
        An ``.ifc`` file.
    level : str, int or None
        Name of the storey; by default the one with most floor.

    Raises
    ------
    PlanError
        If the file is no building model, there is no space in it or no such storey.
    """
    where = str(path)
    model = _open(path, where)
    storeys = {_name(storey): storey for storey in model.by_type("IfcBuildingStorey")}
    rooms = {name: _rooms(storey, where) for name, storey in storeys.items()}
    areas = {name: sum(room.area for _, room in found) for name, found in rooms.items() if found}
    if not areas:
        raise PlanError(f"{where}: there is no free space in it, no IfcSpace with a shape on any storey.")
    # A roof may hold the largest space of all; nobody gets there.
    lived_in = {name for name in areas if any(e.is_a("IfcDoor") for e in _contained(storeys[name]))}
    areas = {name: area * (1.0 if name in lived_in or not lived_in else 1e-6) for name, area in areas.items()}
    level, repairs = choose_level(areas, level, where)
    named = rooms[level]
    floors = [room for _, room in named]
    contained = _contained(storeys[level])
    openings, outer = [], []
    for hole in _doors(contained, where):
        middle, along, width = long_axis(hole)
        opening = open_door(middle, along, width, floors)
        if opening is None:
            outer.append(hole)
        else:
            openings.append(opening)
    if outer:
        message = f"{len(outer)} door(s) that do not join two spaces of this storey were left out."
        repairs.append(Repair("left out", message, shapely.MultiPolygon(outer)))
    middles = [(name, shapely.point_on_surface(room)) for name, room in named if name]
    return make_plan(
        [*floors, *(floor for floor, _ in openings)],
        name=path.stem,
        solid=[f for c in contained if c.is_a("IfcColumn") for f in _footprint(c, where)],
        doors=[door for _, door in openings],
        labels=[Label((p.x, p.y), name) for name, p in middles],
        source=where,
        repairs=repairs,
    )


def _open(path: Path, where: str) -> Any:
    ifcopenshell = need("ifcopenshell", where)
    try:
        head = path.read_bytes()[:64]
    except OSError as exc:
        raise PlanError(f"{where}: the file cannot be read ({exc.strerror}).") from exc
    if not head.lstrip(b"\xef\xbb\xbf \r\n").startswith(b"ISO-10303-21"):
        raise PlanError(f"{where}: this is no IFC file; it does not begin with ISO-10303-21.")
    try:
        return ifcopenshell.open(str(path))
    except (RuntimeError, OSError, ifcopenshell.Error) as exc:
        raise PlanError(f"{where}: the building model is damaged or of a schema that is not known.") from exc


def _name(storey: Any) -> str:
    return str(storey.Name or f"storey {storey.id()}")


def _rooms(storey: Any, where: str) -> list[tuple[str, shapely.Polygon]]:
    """Names and footprints of the spaces of a storey."""
    found = []
    for relation in storey.IsDecomposedBy:
        for space in relation.RelatedObjects:
            if space.is_a("IfcSpace"):
                found += [(str(space.LongName or space.Name or ""), part) for part in _footprint(space, where)]
    return found


def _contained(storey: Any) -> list[Any]:
    return [element for relation in storey.ContainsElements for element in relation.RelatedElements]


def _doors(contained: Iterable[Any], where: str) -> list[shapely.Polygon]:
    """Footprint of the hole in the wall for each door, or of the door itself."""
    found = []
    for door in contained:
        if door.is_a("IfcDoor"):
            holes = [relation.RelatingOpeningElement for relation in door.FillsVoids] or [door]
            shape = shapely.union_all(_footprint(holes[0], where) or _footprint(door, where))
            if shape.area > 0:
                found += [box for box in [shapely.oriented_envelope(shape)] if isinstance(box, shapely.Polygon)]
    return found


def _footprint(product: Any, where: str) -> list[shapely.Polygon]:
    """Project the mesh of a product onto the ground; metres, in the coordinates of the project."""
    geom = need("ifcopenshell.geom", where)
    if product.Representation is None:
        return []
    settings = geom.settings()
    settings.set("use-world-coords", True)
    try:
        shape = geom.create_shape(settings, product)
    except RuntimeError:
        # A product without a body: nothing of it is in the way.
        return []
    vertices = np.array(shape.geometry.verts).reshape(-1, 3)
    triangles = vertices[np.array(shape.geometry.faces).reshape(-1, 3)][:, :, :2]
    a, b = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    flat = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) > 1e-9
    shadow = shapely.union_all([shapely.Polygon(t) for t in triangles[flat]], grid_size=1e-4)
    return [part for part in shapely.get_parts(shadow) if isinstance(part, shapely.Polygon) and part.area > 1e-3]
