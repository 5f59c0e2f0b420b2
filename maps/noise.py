"""The noise of scanners in a picture of free pixels: what is taken out of it, and how that is told."""

from __future__ import annotations

import math
from collections.abc import Callable

import cv2
import numpy as np
import shapely
from numpy.typing import NDArray

from maps.floorplan import Repair
from maps.making import SMALLEST_PART
from maps.tracing import trace

__all__ = [
    "NARROW",
    "PIN_HOLE",
    "Mask",
    "Place",
    "distance_within",
    "narrow_places",
    "small_blobs",
    "total_area",
    "without_pin_holes",
    "without_rays",
    "without_specks",
]

NARROW = 0.15
"""Free space into which no disc of this radius fits is closed: rays through windows, slits between boxes. Metres."""

PIN_HOLE = 0.02
"""Islands that are not free and smaller than this are filled: single wrong readings. Square metres."""

Mask = NDArray[np.bool_]
Place = Callable[[NDArray[np.float64]], NDArray[np.float64]]


def without_pin_holes(free: Mask, resolution: float, place: Place, repairs: list[Repair]) -> Mask:
    """Fill small islands within the free space."""
    label, small, area, middle = small_blobs(~free, PIN_HOLE / resolution**2, 8)
    if not small.any():
        return free
    message = (
        f"{small.sum()} pin-hole(s) of less than {PIN_HOLE} square metres were filled, {total_area(area, resolution)}."
    )
    repairs.append(Repair("filled pin-hole", message, shapely.transform(shapely.MultiPoint(middle), place)))
    return free | small[label]


def without_specks(free: Mask, resolution: float, place: Place, repairs: list[Repair]) -> Mask:
    """Drop patches of free space that are too small for a person."""
    label, small, area, middle = small_blobs(free, SMALLEST_PART / resolution**2, 4)
    if not small.any():
        return free
    rule = f"smaller than {SMALLEST_PART} square metres"
    message = f"{small.sum()} speck(s) of free space, each {rule}, were dropped, {total_area(area, resolution)}."
    repairs.append(Repair("dropped speck", message, shapely.transform(shapely.MultiPoint(middle), place)))
    return free & ~small[label]


def small_blobs(
    mask: Mask, pixels: float, connectivity: int
) -> tuple[NDArray[np.int32], Mask, int, NDArray[np.float64]]:
    """Label the blobs of a mask; say which are small, how many pixels these have in all and where their middles are."""
    _, label, stats, centroid = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=connectivity)
    size = stats[:, cv2.CC_STAT_AREA]
    small = size < pixels
    small[0] = False
    middle = np.stack([centroid[small, 0] + 0.5, mask.shape[0] - centroid[small, 1] - 0.5], axis=1)
    return np.asarray(label, dtype=np.int32), np.asarray(small), int(size[small].sum()), middle


def without_rays(free: Mask, resolution: float, place: Place, repairs: list[Repair]) -> Mask:
    """Close what is too narrow for any robot, and leave everything wider exactly as it is."""
    _, label, narrow = narrow_places(free, NARROW / resolution)
    closed: Mask = narrow[label]
    if not closed.any():
        return free
    message = (
        f"Free space narrower than about {2 * NARROW} m (rays through windows, slits) was closed in "
        f"{narrow.sum()} place(s), {total_area(int(closed.sum()), resolution)}."
    )
    repairs.append(Repair("closed slit", message, shapely.transform(trace(closed), place)))
    return free & ~closed


def narrow_places(free: Mask, radius: float) -> tuple[Mask, NDArray[np.int32], Mask]:
    """Find the places into which no disc of a radius fits.

    The opening of the free space by a disc rounds its corners off. A piece of what it takes is not narrow but a corner
    if no pixel of it is further from the opened space than the tip of a right-angled corner is from the disc in it.

    Parameters
    ----------
    free : ndarray of bool, shape (H, W)
        The free pixels.
    radius : float
        In pixels.

    Returns
    -------
    opened : ndarray of bool, shape (H, W)
        What such discs cover.
    label : ndarray of int32, shape (H, W)
        Number of the piece that each other free pixel belongs to, 0 elsewhere.
    narrow : ndarray of bool, shape (pieces + 1,)
        Which pieces are narrow.
    """
    if radius < 1.5:
        return free, np.zeros(free.shape, dtype=np.int32), np.zeros(1, dtype=np.bool_)
    inner = distance_within(free) >= radius
    opened = free & (distance_within(~inner, outside=True) < radius)
    taken = free & ~opened
    label = np.asarray(cv2.connectedComponents(taken.astype(np.uint8), connectivity=4)[1], dtype=np.int32)
    depth = np.full(int(label.max()) + 1, -1.0)
    away = distance_within(~opened, outside=True) if opened.any() else np.full(free.shape, np.inf)
    np.maximum.at(depth, label[taken], away[taken])
    return opened, label, depth > (math.sqrt(2) - 1) * radius + 1.5


def distance_within(mask: Mask, *, outside: bool = False) -> NDArray[np.float32]:
    """Distance of each set pixel from the nearest one that is not, in pixels; whether the outside is set is given."""
    padded = np.pad(mask, 1, constant_values=outside).astype(np.uint8)
    return np.asarray(cv2.distanceTransform(padded, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1], dtype=np.float32)


def total_area(pixels: int, resolution: float) -> str:
    """Say how large so many pixels are."""
    return f"{pixels * resolution**2:.3g} square metres in all"
