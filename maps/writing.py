"""Floor plans to files: GeoJSON in our own schema, or a ROS map."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import shapely
import yaml
from numpy.typing import NDArray

from maps.errors import PlanError, nearest
from maps.floorplan import FloorPlan
from maps.geojson import write_geojson
from maps.pictures import MOST_PIXELS
from maps.texts import reason, write_whole
from maps.units import check_resolution

__all__ = ["rasterise", "write_plan"]

OCCUPIED, UNKNOWN, FREE = 0, 205, 254
MARGIN = 4
"""Pixels of unknown around the plan."""

WRITABLE = (".geojson", ".json", ".yaml", ".yml")


def write_plan(plan: FloorPlan, path: str | Path, *, resolution: float = 0.05) -> tuple[Path, ...]:
    """Write a floor plan; the suffix says as what.

    Parameters
    ----------
    plan : FloorPlan
        What to write.
    path : str or Path
        ``.geojson`` or ``.json``: our own schema, exactly. ``.yaml`` or ``.yml``: a ROS map, with its image, a PNG of
        the same stem, beside it; doors and labels are lost, and walls become at least a pixel thick.
    resolution : float
        Size of a pixel of a ROS map, metres.

    Returns
    -------
    tuple of Path
        The files written.

    Raises
    ------
    PlanError
        If the suffix is none of these, a file cannot be written or an image would be too large.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in WRITABLE:
        what = suffix or "a file without suffix"
        raise PlanError(f"{path}: floor plans are not written as {what}; {nearest(suffix, WRITABLE)}")
    try:
        if suffix in (".geojson", ".json"):
            return (write_geojson(plan, path),)
        return _write_ros(plan, path, check_resolution(resolution, str(path)))
    except OSError as exc:
        raise PlanError(f"{path}: the file cannot be written ({reason(exc)}).") from exc


def _write_ros(plan: FloorPlan, path: Path, resolution: float) -> tuple[Path, Path]:
    x0, y0, x1, y1 = plan.bounds
    columns, rows = (int(np.ceil((high - low) / resolution)) + 2 * MARGIN for low, high in ((x0, x1), (y0, y1)))
    if columns * rows > MOST_PIXELS:
        raise PlanError(
            f"{path}: at {resolution} m a pixel the image would have {columns} x {rows} pixels; "
            f"at most {MOST_PIXELS} are possible. Choose a coarser resolution."
        )
    origin = (round(x0 - MARGIN * resolution, 6), round(y0 - MARGIN * resolution, 6))
    image = path.with_suffix(".png")
    data = {
        "image": image.name,
        "mode": "trinary",
        "resolution": resolution,
        "origin": [*origin, 0.0],
        "negate": 0,
        "occupied_thresh": 0.65,
        "free_thresh": 0.196,
    }
    encoded = cv2.imencode(".png", rasterise(plan, resolution, origin, (rows, columns)))[1]
    write_whole(image, encoded.tobytes())
    write_whole(path, yaml.safe_dump(data, sort_keys=False).encode())
    return path, image


def rasterise(
    plan: FloorPlan, resolution: float, origin: tuple[float, float], shape: tuple[int, int]
) -> NDArray[np.uint8]:
    """Draw a plan as map_server does.

    Parameters
    ----------
    plan : FloorPlan
        What to draw.
    resolution : float
        Size of a pixel, metres.
    origin : tuple of float
        Where the lower left corner of the image is, metres.
    shape : tuple of int
        Rows and columns.

    Returns
    -------
    ndarray of uint8, shape (rows, columns)
        254 where the middle of a pixel is free, 0 next to that and where a wall is thinner than a pixel, 205 elsewhere.
    """
    inside = _inside((plan.walls - origin) / resolution, shape)
    image = np.where(inside, FREE, UNKNOWN).astype(np.uint8)
    beside = cv2.dilate(inside.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(np.bool_) & ~inside
    # The free space is to the left of its rings: where there is also some a pixel to the right, the wall is thin.
    for ring in shapely.segmentize(shapely.get_rings(shapely.get_parts(plan.space)), resolution / 2):
        xy = (shapely.get_coordinates(ring) - origin) / resolution
        step = np.diff(xy, axis=0)
        middle = (xy[1:] + xy[:-1]) / 2
        across = middle + np.stack([step[:, 1], -step[:, 0]], axis=1) / np.hypot(*step.T)[:, None]
        thin = inside[_pixels(across, shape)]
        beside[_pixels(middle[thin], shape)] = True
    image[beside] = OCCUPIED
    _close_diagonals(image)
    return image


def _close_diagonals(image: NDArray[np.uint8]) -> None:
    """Make two pixels of wall that touch at a corner only share edges with a third; in place.

    A reader that makes the wall straight would else pull them apart, and open a crack to see through.
    """
    free = image == FREE
    left_up, right_up, left_down, right_down = free[:-1, :-1], free[:-1, 1:], free[1:, :-1], free[1:, 1:]
    falling = ~left_up & ~right_down & right_up & left_down
    rising = ~right_up & ~left_down & left_up & right_down
    image[:-1, 1:][falling] = OCCUPIED
    image[:-1, :-1][rising] = OCCUPIED


def _pixels(xy: NDArray[np.float64], shape: tuple[int, int]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Row and column of the pixels that contain points, given in pixels from the lower left corner."""
    row, column = np.floor(shape[0] - xy[:, 1]).astype(np.intp), np.floor(xy[:, 0]).astype(np.intp)
    return np.clip(row, 0, shape[0] - 1), np.clip(column, 0, shape[1] - 1)


def _inside(walls: NDArray[np.float64], shape: tuple[int, int]) -> NDArray[np.bool_]:
    """Find the pixels whose middle is free: from the left, an odd number of walls has been crossed."""
    rows, columns = shape
    walls = np.stack([walls[:, :, 0], rows - walls[:, :, 1]], axis=2)
    crossings = np.zeros((rows, columns + 1), dtype=np.int64)
    upper, lower = walls[:, :, 1].min(axis=1), walls[:, :, 1].max(axis=1)
    first, after = np.ceil(upper - 0.5).astype(int), np.ceil(lower - 0.5).astype(int)
    count = after - first
    edge = np.repeat(np.arange(len(walls)), count)
    row = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count) + first[edge]
    start, end = walls[edge, 0], walls[edge, 1]
    x = start[:, 0] + (row + 0.5 - start[:, 1]) / (end[:, 1] - start[:, 1]) * (end[:, 0] - start[:, 0])
    np.add.at(crossings, (row, np.clip(np.ceil(x - 0.5).astype(int), 0, columns)), 1)
    return np.asarray(np.cumsum(crossings, axis=1)[:, :-1] % 2 == 1)
