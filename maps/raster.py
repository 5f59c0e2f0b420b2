"""From a picture of free pixels to a floor plan: the noise of scanners taken out, and all that was taken out listed."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
import shapely
from numpy.typing import NDArray

from maps.clutter import is_scan, without_bays, without_furniture
from maps.errors import PlanError
from maps.floorplan import FloorPlan, Repair
from maps.making import make_plan
from maps.noise import NARROW, Mask, without_pin_holes, without_rays, without_specks
from maps.tracing import straighten, trace

__all__ = ["MOST_SIDES", "plan_from_mask", "refuse_noise"]

MOST_SIDES = 2_000_000
"""Sides that free pixels may share with others. A scan of 16 million pixels has some hundred thousand; what takes
minutes and gigabytes to trace is no building."""

STRAIGHT = 1.5
"""Walls may move by this many pixels when their staircases are made straight ..."""

STRUCTURE = 0.1
"""... and in structure mode by this, if it is more. Metres."""


def plan_from_mask(
    free: Mask,
    resolution: float,
    *,
    name: str,
    source: str,
    origin: tuple[float, float] = (0.0, 0.0),
    yaw: float = 0.0,
    clean: bool = True,
    structure: bool | None = None,
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
    structure : bool or None
        Whether to take out furniture, see :mod:`maps.clutter`; None: if the picture is plainly a scan of a furnished
        place. Only with ``clean``.
    repairs : iterable of Repair
        What a reader has already changed.

    Raises
    ------
    PlanError
        If no pixel is free, or all are, or the picture is nothing but noise.
    """
    if not free.any():
        raise PlanError(f"{source}: there is no free space in it; none of its {free.size} pixels is free.")
    if free.all():
        raise PlanError(f"{source}: there is no wall in it; all of its {free.size} pixels are free.")
    refuse_noise(free, source)

    def place(xy: NDArray[np.float64]) -> NDArray[np.float64]:
        turn = np.array([[math.cos(yaw), math.sin(yaw)], [-math.sin(yaw), math.cos(yaw)]])
        return np.asarray(xy * resolution @ turn + origin)

    done = list(repairs)
    tolerance = 0.0
    if clean:
        free = without_pin_holes(free, resolution, place, done)
        asked = structure is not None
        structure = is_scan(free, resolution) if structure is None else structure
        if structure:
            why = "as asked for" if asked else "for this is plainly a scan"
            free = without_furniture(free, resolution, place, done, why)
        free = without_specks(free, resolution, place, done)
        free = without_rays(free, resolution, place, done)
        free = without_bays(free, resolution, place, done) if structure else free
        if not free.any():
            wide = f"{2 * NARROW} m"
            raise PlanError(f"{source}: there is no free space in it as wide as {wide}. Is its resolution right?")
        tolerance = max(STRAIGHT, STRUCTURE / resolution) if structure else STRAIGHT
    outline = trace(free)
    outline = straighten(outline, tolerance) if tolerance else outline
    return make_plan(shapely.transform(outline, place), name=name, source=source, repairs=done)


def refuse_noise(free: NDArray[np.bool_], source: str) -> None:
    """Raise PlanError for a picture whose free and other pixels meet too often for a map of a building."""
    sides = int(np.count_nonzero(free[1:] != free[:-1])) + int(np.count_nonzero(free[:, 1:] != free[:, :-1]))
    if sides > MOST_SIDES:
        raise PlanError(
            f"{source}: this is noise and no map of a building; free and other pixels meet in {sides} places, and "
            f"{MOST_SIDES} are the most."
        )
