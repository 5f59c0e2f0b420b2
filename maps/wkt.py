"""Well-known text: polygons of free space, as pedestrian simulators write them."""

from __future__ import annotations

from pathlib import Path

import shapely
from shapely.geometry.base import BaseGeometry

from maps.errors import PlanError
from maps.floorplan import FloorPlan
from maps.making import make_plan
from maps.texts import read_text
from maps.units import frame_of

__all__ = ["read_wkt"]


def read_wkt(path: Path, *, units: str | None = None) -> FloorPlan:
    """Read polygons with holes, multipolygons or collections of them, one or several to a file.

    Parameters
    ----------
    path : Path
        A ``.wkt`` file.
    units : str or None
        Unit of the coordinates; metres by default, unless they can only be longitude and latitude.

    Raises
    ------
    PlanError
        If the file is not well-known text or holds anything but polygons.
    """
    where = str(path)
    text = read_text(path, where).strip()
    if not text:
        raise PlanError(f"{where}: the file is empty.")
    try:
        space = [shapely.from_wkt(text)]
    except shapely.GEOSException:
        space = [_geometry(line, number, where) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
    to_metres, _, repairs = frame_of(shapely.get_coordinates(space), units, where)
    return make_plan(
        [shapely.transform(shapely.force_2d(g), to_metres) for g in space],
        name=path.stem,
        source=where,
        repairs=repairs,
    )


def _geometry(line: str, number: int, where: str) -> BaseGeometry:
    try:
        return shapely.from_wkt(line)
    except shapely.GEOSException as exc:
        raise PlanError(f"{where}: line {number} is not well-known text; it begins with {line[:30]!r}.") from exc
