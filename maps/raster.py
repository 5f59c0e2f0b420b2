"""From a picture of free pixels to a floor plan: the noise of scanners taken out, and all that was taken out listed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import cv2
import numpy as np
import shapely
from numpy.typing import NDArray

from maps.errors import PlanError
from maps.floorplan import FloorPlan, Repair
from maps.making import SMALLEST_PART, make_plan
from maps.tracing import straighten, trace

__all__ = ["NARROW", "PIN_HOLE", "plan_from_mask"]

NARROW = 0.15
"""Free space into which no disc of this radius fits is closed: rays through windows, slits between boxes. Metres."""

PIN_HOLE = 0.02
"""Islands that are not free and smaller than this are filled: single wrong readings. Square metres."""

STRAIGHT = 1.5
"""Walls may move by this many pixels when their staircases are made straight."""

Mask = NDArray[np.bool_]
Place = Callable[[NDArray[np.float64]], NDArray[np.float64]]


def plan_from_mask(
    free: Mask,
    resolution: float,
    *,
    name: str,
    source: str,
    origin: tuple[float, float] = (0.0, 0.0),
    yaw: float = 0.0,
    clean: bool = True,
    repairs: Iterable[Repair] = (),
) -> FloorPlan:
    """Make a floor plan from the free pixels of an image.

    Parameters
    ----------
    free : ndarray of bool, shape (H, W)
        Row 0 is the uppermost.
    resolution : float
        Size of a pixel, metres.
    name, source : str
        As in :func:`maps.make_plan`.
    origin : tuple of float
        Where the lower left corner of the image is, metres.
    yaw : float
        By how much the image is turned about that corner, radians, counterclockwise.
    clean : bool
        Whether the picture may hold a scanner's noise. Otherwise each pixel is taken as it is.
    repairs : iterable of Repair
        What a reader has already changed.

    Raises
    ------
    PlanError
        If no pixel is free, or all are.
    """
    if not free.any():
        raise PlanError(f"{source}: there is no free space in it; none of its {free.size} pixels is free.")
    if free.all():
        raise PlanError(f"{source}: there is no wall in it; all of its {free.size} pixels are free.")

    def place(xy: NDArray[np.float64]) -> NDArray[np.float64]:
        turn = np.array([[math.cos(yaw), math.sin(yaw)], [-math.sin(yaw), math.cos(yaw)]])
        return np.asarray(xy * resolution @ turn + origin)

    done = list(repairs)
    if clean:
        free = _without_pin_holes(free, resolution, place, done)
        free = _without_specks(free, resolution, place, done)
        free = _without_rays(free, resolution, place, done)
        if not free.any():
            raise PlanError(
                f"{source}: there is no free space in it as wide as {2 * NARROW} m. Is its resolution right?"
            )
    outline = straighten(trace(free), STRAIGHT) if clean else trace(free)
    return make_plan(shapely.transform(outline, place), name=name, source=source, repairs=done)


def _without_pin_holes(free: Mask, resolution: float, place: Place, repairs: list[Repair]) -> Mask:
    """Fill small islands within the free space."""
    label, small, area, middle = _small_blobs(~free, PIN_HOLE / resolution**2, 8)
    if not small.any():
        return free
    message = (
        f"{small.sum()} pin-hole(s) of less than {PIN_HOLE} square metres were filled, {_total(area, resolution)}."
    )
    repairs.append(Repair("filled pin-hole", message, shapely.transform(shapely.MultiPoint(middle), place)))
    return free | small[label]


def _without_specks(free: Mask, resolution: float, place: Place, repairs: list[Repair]) -> Mask:
    """Drop patches of free space that are too small for a person."""
    label, small, area, middle = _small_blobs(free, SMALLEST_PART / resolution**2, 4)
    if not small.any():
        return free
    rule = f"smaller than {SMALLEST_PART} square metres"
    message = f"{small.sum()} speck(s) of free space, each {rule}, were dropped, {_total(area, resolution)}."
    repairs.append(Repair("dropped speck", message, shapely.transform(shapely.MultiPoint(middle), place)))
    return free & ~small[label]


def _small_blobs(
    mask: Mask, pixels: float, connectivity: int
) -> tuple[NDArray[np.int32], Mask, int, NDArray[np.float64]]:
    """Label the blobs of a mask; say which are small, how many pixels these have in all and where their middles are."""
    _, label, stats, centroid = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=connectivity)
    size = stats[:, cv2.CC_STAT_AREA]
    small = size < pixels
    small[0] = False
    middle = np.stack([centroid[small, 0] + 0.5, mask.shape[0] - centroid[small, 1] - 0.5], axis=1)
    return np.asarray(label, dtype=np.int32), np.asarray(small), int(size[small].sum()), middle


def _without_rays(free: Mask, resolution: float, place: Place, repairs: list[Repair]) -> Mask:
    """Close what is too narrow for any robot, and leave everything wider exactly as it is.

    The opening of the free space by a disc rounds its corners off. A piece of what it took is given back whole if no
    pixel of it is further from the opened space than the tip of a right-angled corner is from the disc in it.
    """
    radius = NARROW / resolution
    if radius < 1.5:
        return free
    inner = _distance(free) >= radius
    opened = free & (_distance(~inner, outside=True) < radius)
    if not opened.any():
        return opened
    taken = free & ~opened
    _, label = cv2.connectedComponents(taken.astype(np.uint8), connectivity=4)
    depth = np.zeros(label.max() + 1)
    np.maximum.at(depth, label[taken].astype(np.intp), _distance(~opened, outside=True)[taken])
    ray = depth > (math.sqrt(2) - 1) * radius + 1.5
    ray[0] = False
    closed: Mask = ray[label]
    if not closed.any():
        return free
    shapes = shapely.transform(trace(closed), place)
    message = (
        f"Free space narrower than about {2 * NARROW} m (rays through windows, slits) was closed in "
        f"{ray.sum()} place(s), {_total(int(closed.sum()), resolution)}."
    )
    repairs.append(Repair("closed slit", message, shapes))
    return free & ~closed


def _distance(mask: Mask, *, outside: bool = False) -> NDArray[np.float32]:
    """Distance of each set pixel from the nearest one that is not, in pixels; whether the outside is set is given."""
    padded = np.pad(mask, 1, constant_values=outside).astype(np.uint8)
    return np.asarray(cv2.distanceTransform(padded, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1], dtype=np.float32)


def _total(pixels: int, resolution: float) -> str:
    return f"{pixels * resolution**2:.3g} square metres in all"
