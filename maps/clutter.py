"""Structure mode: of the scan of a furnished place the walls are kept, the chairs are not."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import shapely
from numpy.typing import NDArray

from maps.floorplan import Repair
from maps.noise import Mask, Place, narrow_places, total_area
from maps.tracing import trace

__all__ = ["BAY", "FEW", "PIECE", "SCAN", "SLENDER", "STUB", "is_scan", "without_bays", "without_furniture"]

PIECE = 1.2
"""What stands alone and is no longer than this, in either direction, is furniture. Metres."""

STUB = 0.6
"""Even if it stands alone, what is longer than this and slender is a piece of wall between two doors. Metres."""

SLENDER = 3.5
"""How many times longer than wide a piece of wall is."""

BAY = 0.3
"""Dead ends of the free space into which no disc of this radius fits lie between furniture. Metres."""

SCAN = 1 / 30
"""A map with more pieces of furniture than this to a square metre is plainly a scan of a furnished place ..."""

FEW = 10
"""... unless it has fewer pieces than this in all."""


def is_scan(free: Mask, resolution: float) -> bool:
    """Whether a map has so many pieces of furniture that nobody can have drawn it as a floor plan."""
    _, piece = _pieces(free, resolution)
    return bool(piece.sum() >= FEW and piece.sum() > SCAN * free.sum() * resolution**2)


def without_furniture(free: Mask, resolution: float, place: Place, repairs: list[Repair], why: str) -> Mask:
    """Take out what stands alone and is small."""
    label, piece = _pieces(free, resolution)
    taken: Mask = piece[label]
    message = (
        f"Structure mode, {why}: {piece.sum()} piece(s) of furniture, at most {PIECE} m long and free on all sides, "
        f"were taken out, {total_area(int(taken.sum()), resolution)}."
    )
    shapes = shapely.transform(trace(taken), place) if taken.any() else shapely.GeometryCollection()
    repairs.append(Repair("removed furniture", message, shapes))
    return free | taken


def without_bays(free: Mask, resolution: float, place: Place, repairs: list[Repair]) -> Mask:
    """Close dead ends that are narrow; what leads on, if only to a nook as wide as a door, stays."""
    opened, label, narrow = narrow_places(free, BAY / resolution)
    ends = narrow & _touches_once(opened, label)
    closed: Mask = ends[label]
    if not closed.any():
        return free
    message = (
        f"Structure mode: {ends.sum()} dead end(s) narrower than about {2 * BAY} m were closed, "
        f"{total_area(int(closed.sum()), resolution)}."
    )
    repairs.append(Repair("closed bay", message, shapely.transform(trace(closed), place)))
    return free & ~closed


def _pieces(free: Mask, resolution: float) -> tuple[NDArray[np.int32], Mask]:
    """Label what is not free, and say which labels are pieces of furniture: small, and with free space all around."""
    solid = np.pad(~free, 1, constant_values=True).astype(np.uint8)
    count, label, stats, _ = cv2.connectedComponentsWithStats(solid, connectivity=8)
    longest = np.maximum(stats[:, cv2.CC_STAT_WIDTH], stats[:, cv2.CC_STAT_HEIGHT])
    piece = (longest * resolution <= PIECE) & (np.arange(count) > 0)
    for number in np.flatnonzero(piece & (longest * resolution > STUB)):
        x, y, w, h = stats[number, :4]
        pixels = np.argwhere(label[y : y + h, x : x + w] == number).astype(np.float32)
        sides = np.sort(np.array(cv2.minAreaRect(pixels)[1]) + 1.0)
        piece[number] = sides[1] < SLENDER * sides[0]
    return np.asarray(label[1:-1, 1:-1], dtype=np.int32), np.asarray(piece)


def _touches_once(opened: Mask, label: NDArray[np.int32]) -> Mask:
    """Which pieces of a label image border on the opened space along one stretch only."""
    from scipy.ndimage import find_objects

    once = np.zeros(int(label.max()) + 1, dtype=np.bool_)
    padded, space = np.pad(label, 1), np.pad(opened, 1)
    objects: list[Any] = find_objects(padded)  # every number from 1 is there, so none of them is None
    for number, (rows, columns) in enumerate(objects, 1):
        window = np.s_[rows.start - 1 : rows.stop + 1, columns.start - 1 : columns.stop + 1]
        around = cv2.dilate((padded[window] == number).astype(np.uint8), np.ones((3, 3), np.uint8))
        contact = (around > 0) & space[window]
        once[number] = cv2.connectedComponents(contact.astype(np.uint8), connectivity=8)[0] == 2
    return once
