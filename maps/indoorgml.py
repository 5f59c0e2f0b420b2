"""IndoorGML 1.0 (OGC 14-005r5), with the ``formats`` extra: cells of one storey, opened where transitions join them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from maps.errors import PlanError
from maps.floorplan import FloorPlan, Label, Repair
from maps.levels import choose_level
from maps.making import make_plan
from maps.openings import DOOR, Opening, open_door, thick_walls, wall_at
from maps.xmlfiles import kind_of, read_xml

__all__ = ["read_indoorgml"]

STOREY = 1.0
"""Floors whose heights differ by less than this belong to one storey, metres."""

Floor = tuple[str, float, shapely.Polygon]


def read_indoorgml(path: Path, *, level: str | int | None = None) -> FloorPlan:
    """Read one storey; a transition is a door at the middle vertex of its line. Coordinates are metres.

    Parameters
    ----------
    path : Path
        A ``.gml`` file.
    level : str, int or None
        Height of the storey's floor in metres with one decimal, such as "2.9"; by default the largest.

    Raises
    ------
    PlanError
        If the file is not IndoorGML, has no cell with a floor, or no such storey.
    """
    where = str(path)
    root = read_xml(path, "IndoorFeatures", "IndoorGML")
    floors = [floor for cell in _all(root, "CellSpace") for floor in _floors(cell, where)]
    storeys = _storeys(floors)
    areas = {name: sum(room.area for _, _, room in found) for name, found in storeys.items()}
    level, repairs = choose_level(areas, level, where)
    names = [(name, shapely.point_on_surface(room)) for name, _, room in storeys[level] if name]
    rooms = [room for _, _, room in storeys[level]]
    outlines = rooms
    if _edge_to_edge(rooms):
        rooms, said = thick_walls(rooms)
        repairs.append(said)
    openings: list[Opening] = []
    assumed: list[shapely.Point] = []
    height = min(z for _, z, _ in storeys[level])
    for point in _transitions(root, height, where):
        outline = min(outlines, key=lambda room: room.distance(shapely.Point(point)))
        middle, along, length = wall_at(point, outline)
        opening = open_door(middle, along, min(DOOR, length), rooms)
        if opening is not None and not any(door.equals(opening[1]) for _, door in openings):
            openings.append(opening)
            assumed += [shapely.Point(middle)] if length > DOOR else []
    if assumed:
        message = f"{len(assumed)} door(s) without a width were taken to be {DOOR} m wide."
        repairs.append(Repair("assumed width", message, shapely.MultiPoint(assumed)))
    return make_plan(
        [*rooms, *(floor for floor, _ in openings)],
        name=path.stem,
        doors=[door for _, door in openings],
        labels=[Label((p.x, p.y), name) for name, p in names],
        source=where,
        repairs=repairs,
    )


def _all(element: Any, kind: str) -> Iterator[Any]:
    return (child for child in element.iter() if kind_of(child) == kind)


def _positions(element: Any, where: str) -> NDArray[np.float64]:
    """Positions below an element, shape (n, 3)."""
    text = " ".join(child.text or "" for child in element.iter() if kind_of(child) in ("pos", "posList"))
    try:
        return np.array([float(value) for value in text.split()]).reshape(-1, 3)
    except ValueError as exc:
        raise PlanError(f"{where}: a position is not three numbers; it begins with {text[:30]!r}.") from exc


def _floors(cell: Any, where: str) -> list[Floor]:
    """Name, height and outline of the lowest flat face of a cell."""
    rings = [_positions(ring, where) for ring in _all(cell, "LinearRing")]
    flat = [ring for ring in rings if len(ring) > 3 and np.ptp(ring[:, 2]) < 0.05]
    if not flat:
        return []
    low = min(float(ring[:, 2].min()) for ring in flat)
    outlines = [shapely.Polygon(ring[:, :2]) for ring in flat if ring[:, 2].min() < low + STOREY / 4]
    shadow = shapely.union_all(shapely.make_valid(outlines, method="structure", keep_collapsed=False), grid_size=1e-3)
    name = next((child.text or "" for child in cell if kind_of(child) == "name"), "")
    return [(name, low, part) for part in shapely.get_parts(shadow) if isinstance(part, shapely.Polygon)]


def _storeys(floors: list[Floor]) -> dict[str, list[Floor]]:
    """Group floors of about one height, the lowest first; the name is the height of the lowest of them."""
    found: dict[str, list[Floor]] = {}
    for floor in sorted(floors, key=lambda f: f[1]):
        last = found[next(reversed(found))] if found else []
        if last and floor[1] < last[0][1] + STOREY:
            last.append(floor)
        else:
            found[f"{floor[1]:.1f}"] = [floor]
    return found


def _edge_to_edge(rooms: list[shapely.Polygon]) -> bool:
    pairs = shapely.STRtree(rooms).query(rooms, predicate="intersects").T
    return any(i < j and rooms[i].intersection(rooms[j]).length > DOOR for i, j in pairs)


def _transitions(root: Any, height: float, where: str) -> Iterator[NDArray[np.float64]]:
    """Yield the middle vertex of each transition on a storey."""
    for transition in _all(root, "Transition"):
        xyz = _positions(transition, where)
        above = xyz[:, 2] - height
        if len(xyz) >= 3 and (above > -STOREY / 4).all() and (above < 2.5).all() and np.ptp(above) < STOREY:
            yield xyz[len(xyz) // 2, :2]
