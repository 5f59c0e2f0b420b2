"""Grid maps of the Moving AI Lab's benchmarks (N. Sturtevant, "Benchmarks for grid-based pathfinding", 2012)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import shapely

from maps.errors import PlanError
from maps.floorplan import FloorPlan, Repair
from maps.raster import plan_from_mask
from maps.texts import read_text
from maps.units import check_resolution

__all__ = ["read_movingai"]

FREE = ".GS"
"""Passable terrain: ground (two signs) and swamp. Trees, water and what is out of bounds are not."""

SOLID = "@OTW"


def read_movingai(path: Path, *, resolution: float | None = None) -> FloorPlan:
    """Read a grid map; every cell is taken as it is, and its lower left corner is the origin.

    Parameters
    ----------
    path : Path
        A ``.map`` file.
    resolution : float or None
        Size of a cell, metres. One metre by default, which is then listed, since the format knows no unit.

    Raises
    ------
    PlanError
        If the header is wrong, or the grid is not as large as it says.
    """
    where = str(path)
    lines = read_text(path, where).splitlines()
    size = {}
    try:
        start = lines.index("map") + 1
        size = {key: int(value) for key, value in (line.split() for line in lines[: start - 1]) if key != "type"}
        height, width = size["height"], size["width"]
    except (ValueError, KeyError) as exc:
        raise PlanError(f"{where}: this is no Moving AI map; it must begin with type, height, width and map.") from exc
    rows = lines[start : start + height]
    if len(rows) < height or any(len(row) != width for row in rows):
        at = next((k for k, row in enumerate(rows) if len(row) != width), len(rows))
        raise PlanError(f"{where}: the grid must have {height} rows of {width} signs; row {at + 1} is not so.")
    unknown = set("".join(rows)) - set(FREE + SOLID)
    if unknown:
        raise PlanError(f"{where}: the sign {min(unknown)!r} in the grid has no meaning; known are {FREE + SOLID}.")
    free = np.array([[sign in FREE for sign in row] for row in rows], dtype=np.bool_).reshape(height, width)
    message = "A cell of the grid is taken to be 1 m wide; the format does not say."
    repairs = [Repair("assumed size", message, shapely.GeometryCollection())] if resolution is None else []
    metres = 1.0 if resolution is None else check_resolution(resolution, where)
    return plan_from_mask(free, metres, name=path.stem, source=where, clean=False, repairs=repairs)
