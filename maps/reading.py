"""One way in for every floor plan: a bundled name or a file, told by suffix and content."""

from __future__ import annotations

import re
from codecs import BOM_UTF8
from collections.abc import Callable
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from maps.dxf import read_dxf
from maps.errors import PlanError, nearest, shortened, shown
from maps.floorplan import FloorPlan
from maps.geojson import read_geojson
from maps.houseexpo import read_houseexpo
from maps.ifc import read_ifc
from maps.images import read_image
from maps.indoorgml import read_indoorgml
from maps.movingai import read_movingai
from maps.osm import read_osm
from maps.pyrobosim import read_pyrobosim
from maps.resplan import read_resplan
from maps.ros import read_ros
from maps.svg import read_svg
from maps.texts import check_file, read_bytes, reason
from maps.wkt import read_wkt
from maps.wrld import read_wrld

__all__ = ["FORMATS", "Format", "bundled_names", "read_plan", "register_format"]


@dataclass(frozen=True, slots=True)
class Format:
    """A kind of file.

    Attributes
    ----------
    name : str
        What people call it.
    suffixes : tuple of str
        In small letters, with the dot.
    read : callable
        Takes the path and, by name, those of the options that it knows.
    options : tuple of str
        Which of ``resolution``, ``level``, ``units`` and ``structure`` it knows.
    sign : bytes
        A regular expression that content of this kind matches; of two kinds with one suffix the first that matches
        is taken.
    """

    name: str
    suffixes: tuple[str, ...]
    read: Callable[..., FloorPlan]
    options: tuple[str, ...] = ()
    sign: bytes = b""


JSON = (".geojson", ".json")
YAML = (".yaml", ".yml")
PICTURES = (".png", ".pgm", ".bmp", ".jpg", ".jpeg", ".tif", ".tiff")

FORMATS: list[Format] = [
    Format("OpenStreetMap indoor", JSON, read_osm, ("level",), rb'"indoor"\s*:'),
    Format("WRLD indoor", JSON, read_wrld, (), rb'"building_outline"'),
    Format("HouseExpo", JSON, read_houseexpo, (), rb'"verts"\s*:'),
    Format("ResPlan", JSON, read_resplan, ("resolution", "level"), rb'"geometries"\s*:\s*{'),
    Format("GeoJSON", JSON, read_geojson, ("units",)),
    Format("PyRoboSim world", YAML, read_pyrobosim, (), rb"(?m)^rooms\s*:"),
    Format("ROS map", YAML, read_ros, ("structure",)),
    Format(
        "picture", (".png", ".pgm", ".bmp", ".jpg", ".jpeg", ".tif", ".tiff"), read_image, ("resolution", "structure")
    ),
    Format("well-known text", (".wkt",), read_wkt, ("units",)),
    Format("Moving AI map", (".map",), read_movingai, ("resolution",)),
    Format("DXF drawing", (".dxf",), read_dxf, ("units",)),
    Format("SVG drawing", (".svg",), read_svg, ("resolution", "units")),
    Format("IFC building model", (".ifc",), read_ifc, ("level",)),
    Format("IndoorGML", (".gml", ".indoorgml"), read_indoorgml, ("level",)),
]
"""Every kind of file that can be read; a new one joins by a line here, or by :func:`register_format`."""


def register_format(kind: Format) -> Format:
    """Let :func:`read_plan`, and so every command, read another kind of file.

    It is tried before those that are there; if one of its suffixes is known already, its ``sign`` must tell it apart.

    Raises
    ------
    PlanError
        If its name is taken, a suffix has no dot or big letters, or a known suffix comes without a sign.
    """
    if kind.name.lower() in (known.name.lower() for known in FORMATS):
        raise PlanError(f"There is a format {kind.name!r} already; choose another name.")
    for suffix in kind.suffixes:
        if not suffix.startswith(".") or suffix != suffix.lower():
            raise PlanError(f"The suffix {suffix!r} of the format {kind.name!r} must be in small letters, with a dot.")
        if not kind.sign and any(suffix in known.suffixes for known in FORMATS):
            raise PlanError(f"Files that end in {suffix} are known; the format {kind.name!r} needs a sign to tell it.")
    if not kind.suffixes:
        raise PlanError(f"The format {kind.name!r} needs a suffix.")
    FORMATS.insert(0, kind)
    return kind


def bundled_names() -> tuple[str, ...]:
    """Names of the plans that come with the package, in alphabetical order."""
    folder = resources.files("maps") / "bundled"
    return tuple(sorted(f.name.removesuffix(".geojson") for f in folder.iterdir() if f.name.endswith(".geojson")))


def read_plan(
    name_or_path: str | Path,
    *,
    resolution: float | None = None,
    level: str | int | None = None,
    units: str | None = None,
    structure: bool | None = None,
) -> FloorPlan:
    """Read a floor plan.

    Parameters
    ----------
    name_or_path : str or Path
        A bundled name (see :func:`bundled_names`) or a file.
    resolution : float or None
        Size of a pixel, a grid cell or a coordinate unit in metres, where the file does not say it.
    level : str, int or None
        Which storey, where a file holds several; the largest by default.
    units : str or None
        Unit of the coordinates ("m", "mm", "ft", ...), where the file does not say it.
    structure : bool or None
        Whether furniture is taken out of a scanned map and only its walls kept; by default that is done where the map
        is plainly a scan, and the repairs say so.

    Raises
    ------
    PlanError
        If there is no such plan or file, it cannot be read as what its suffix says that it is, or an option is given
        that this kind of file has no use for.
    """
    given = str(name_or_path)
    options = {"resolution": resolution, "level": level, "units": units, "structure": structure}
    options = {key: value for key, value in options.items() if value is not None}
    if given in bundled_names():
        _check_options("bundled plan", (), options, given)
        with resources.as_file(resources.files("maps") / "bundled" / f"{given}.geojson") as file:
            return read_geojson(file, source="bundled")
    if not given.strip():
        raise PlanError("The name of the floor plan is empty.")
    path = Path(name_or_path)
    kind = _format(path, shortened(given))
    _check_options(kind.name, kind.options, options, given)
    return kind.read(path, **options)


def _format(path: Path, given: str) -> Format:
    """Find out what kind of file it is."""
    suffix = path.suffix.lower()
    try:
        if path.is_dir():
            raise PlanError(f"{given} is a folder; a floor plan is a file.")
        path.stat()
    except (FileNotFoundError, NotADirectoryError) as exc:
        hint = f" and no bundled plan of this name; {nearest(given, bundled_names())}" if not suffix else "."
        raise PlanError(f"There is no file {given}{hint}") from exc
    except (OSError, ValueError) as exc:
        raise PlanError(f"The file {given} cannot be read ({reason(exc)}).") from exc
    check_file(path, given)
    possible = [kind for kind in FORMATS if suffix in kind.suffixes]
    if not possible:
        known = ", ".join(sorted({known for kind in FORMATS for known in kind.suffixes}))
        raise PlanError(f"{given}: files of the kind {suffix or '(no suffix)'} cannot be read; readable are {known}.")
    content = read_bytes(path, given).removeprefix(BOM_UTF8) if len(possible) > 1 else b""
    return next(kind for kind in possible if re.search(kind.sign, content))


def _check_options(kind: str, known: tuple[str, ...], options: dict[str, Any], given: str) -> None:
    for key, value in options.items():
        if key not in known:
            raise PlanError(f"{given}: {key} is {shown(value)}, but a {kind} has no use for it; leave it out.")
