"""One way in for every floor plan: a bundled name or a file, told by suffix and content."""

from __future__ import annotations

from collections.abc import Callable
from importlib import resources
from pathlib import Path

from maps.errors import PlanError, nearest
from maps.floorplan import FloorPlan
from maps.geojson import read_geojson
from maps.ros import read_ros

__all__ = ["bundled_names", "read_plan"]

Reader = Callable[[Path], FloorPlan]

READERS: dict[str, Reader] = {
    ".geojson": read_geojson,
    ".json": read_geojson,
    ".yaml": read_ros,
    ".yml": read_ros,
}
"""The reader for each suffix; a new format joins by a line here."""


def bundled_names() -> tuple[str, ...]:
    """Names of the plans that come with the package, in alphabetical order."""
    folder = resources.files("maps") / "bundled"
    return tuple(sorted(f.name.removesuffix(".geojson") for f in folder.iterdir() if f.name.endswith(".geojson")))


def read_plan(name_or_path: str | Path) -> FloorPlan:
    """Read a floor plan.

    Parameters
    ----------
    name_or_path : str or Path
        A bundled name (see :func:`bundled_names`) or a file.

    Raises
    ------
    PlanError
        If there is no such plan or file, or it cannot be read as what its suffix says that it is.
    """
    given = str(name_or_path)
    if given in bundled_names():
        with resources.as_file(resources.files("maps") / "bundled" / f"{given}.geojson") as file:
            return read_geojson(file, source="bundled")
    path = Path(name_or_path)
    suffix = path.suffix.lower()
    if not given.strip():
        raise PlanError("The name of the floor plan is empty.")
    if path.is_dir():
        raise PlanError(f"{given} is a folder; a floor plan is a file.")
    if not path.exists():
        hint = f" and no bundled plan of this name; {nearest(given, bundled_names())}" if not suffix else "."
        raise PlanError(f"There is no file {given}{hint}")
    if suffix not in READERS:
        known = ", ".join(READERS)
        raise PlanError(f"{given}: files of the kind {suffix or '(no suffix)'} cannot be read; readable are {known}.")
    return READERS[suffix](path)
