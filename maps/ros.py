"""Maps of the Robot Operating System: what map_server saves, a YAML file beside an image.

The meaning of each key is that of https://wiki.ros.org/map_server: a pixel's occupancy is (255 - value) / 255, or
value / 255 with ``negate``; below ``free_thresh`` it is free. Modes ``trinary`` and ``scale`` differ only above that;
in mode ``raw`` the value itself is the occupancy in percent, and above 100 it is unknown.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from maps.errors import PlanError, nearest
from maps.floorplan import FloorPlan, Repair
from maps.pictures import read_picture
from maps.raster import plan_from_mask
from maps.texts import load_yaml
from maps.units import check_resolution

__all__ = ["read_ros"]

MODES = ("trinary", "scale", "raw")
KEYS = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode")


def read_ros(path: Path, *, structure: bool | None = None) -> FloorPlan:
    """Read a ROS map; scanner noise is repaired as :mod:`maps.raster` says.

    Parameters
    ----------
    path : Path
        The ``.yaml`` file; the image is where it says, from its own folder.
    structure : bool or None
        Whether to take out furniture; None: if the map is plainly a scan.

    Raises
    ------
    PlanError
        If a key is missing or wrong, or the image cannot be read.
    """
    where = str(path)
    data = load_yaml(path, where)
    if "image" not in data:
        keys = ", ".join(repr(key) for key in list(data)[:6])
        raise PlanError(f"{where}: this is not a ROS map; it has no key 'image' but {keys}.")
    image = data["image"]
    if not isinstance(image, str) or not image:
        raise PlanError(f"{where}: image is {image!r}; it must be the name of a file.")
    resolution = check_resolution(_number(data, "resolution", where), where)
    origin = data.get("origin")
    if not isinstance(origin, list) or len(origin) != 3 or not all(_is_number(v) for v in origin):
        raise PlanError(f"{where}: origin is {origin!r}; it must be a list [x, y, yaw] of three finite numbers.")
    mode = data.get("mode", "trinary")
    if mode not in MODES:
        raise PlanError(f"{where}: mode is {mode!r}; {nearest(str(mode), MODES)}")
    negate, free_below = _negate(data, where), _threshold(data, "free_thresh", where)
    if free_below > _threshold(data, "occupied_thresh", where):
        raise PlanError(f"{where}: free_thresh {free_below} is larger than occupied_thresh {data['occupied_thresh']}.")

    brightness, opaque = read_picture(path.parent / image, where)
    if mode == "raw":
        percent = np.round(brightness * 255.0)
        free = percent <= round(100 * free_below)
    else:
        free = (brightness if negate else 1.0 - brightness) < free_below
    free &= opaque
    unknown, repairs = _saved_as_unknown(brightness, free)
    x, y, yaw = (float(v) for v in origin)
    return plan_from_mask(
        free & ~unknown,
        resolution,
        name=path.stem,
        source=where,
        origin=(x, y),
        yaw=yaw,
        structure=structure,
        repairs=repairs,
    )


def _saved_as_unknown(
    brightness: NDArray[np.float64], free: NDArray[np.bool_]
) -> tuple[NDArray[np.bool_], list[Repair]]:
    """Find pixels that map_saver wrote for unknown but that the thresholds would call free.

    map_saver writes 0, 205 and 254 for occupied, unknown and free, and with a free_thresh of 0.25, its default in
    ROS 2, a 205 would come back as free.
    """
    value = np.round(brightness * 255.0)
    unknown = free & (value == 205.0)
    if not unknown.any() or not np.isin(value, (0.0, 205.0, 254.0)).all():
        return np.zeros_like(free), []
    message = f"{unknown.sum()} pixels of value 205, which map_saver writes for unknown, were not taken as free."
    return unknown, [Repair("unknown pixels", message, shapely.GeometryCollection())]


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _number(data: dict[str, Any], key: str, where: str) -> float:
    if key not in data:
        unknown = [str(k) for k in data if k not in KEYS]
        hint = f"; is it {unknown[0]!r}?" if unknown else "."
        raise PlanError(f"{where}: the key {key!r} is missing{hint}")
    value = data[key]
    if not _is_number(value):
        raise PlanError(f"{where}: {key} is {value!r}; it must be a finite number.")
    return float(value)


def _threshold(data: dict[str, Any], key: str, where: str) -> float:
    value = _number(data, key, where)
    if not 0.0 <= value <= 1.0:
        raise PlanError(f"{where}: {key} is {value}; it must be between 0 and 1.")
    return value


def _negate(data: dict[str, Any], where: str) -> bool:
    if "negate" not in data or data["negate"] not in (0, 1):
        raise PlanError(f"{where}: negate is {data.get('negate')!r}; it must be 0 or 1.")
    return bool(data["negate"])
