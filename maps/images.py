"""A plain picture of a floor plan: white is free, everything darker is not."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import shapely

from maps.errors import PlanError
from maps.floorplan import FloorPlan, Repair
from maps.noise import Mask
from maps.pictures import read_picture
from maps.raster import plan_from_mask, refuse_noise
from maps.tracing import straighten, trace
from maps.units import check_resolution

__all__ = ["WHITE", "read_image"]

WHITE = 0.9
"""A pixel is free if it is at least this bright: furniture is grey in some pictures, and white not pure in others."""


def read_image(path: Path, *, resolution: float | None = None, structure: bool | None = None) -> FloorPlan:
    """Read a picture; noise is repaired as :mod:`maps.raster` says. Its lower left corner is the origin.

    Parameters
    ----------
    path : Path
        A PNG, PGM, JPEG, BMP or TIFF file.
    resolution : float
        Size of a pixel, metres. There is no default.
    structure : bool or None
        Whether to take out furniture; None: if the picture is plainly a scan.

    Raises
    ------
    PlanError
        If there is no resolution or the picture cannot be read.
    """
    where = str(path)
    if resolution is None:
        raise PlanError(f"{where}: a picture does not say how large it is; give its resolution in metres a pixel.")
    metres = check_resolution(resolution, where)
    brightness, opaque = read_picture(path, where)
    white = (brightness >= WHITE) & opaque
    refuse_noise(white, where)
    free, repairs = _without_outside(white, metres)
    return plan_from_mask(free, metres, name=path.stem, source=where, structure=structure, repairs=repairs)


def _without_outside(free: Mask, resolution: float) -> tuple[Mask, list[Repair]]:
    """Take out the white paper around a building: what a corner of the picture belongs to, if much else is left."""
    _, label = cv2.connectedComponents(free.astype(np.uint8), connectivity=4)
    corners = {int(label[row, column]) for row in (0, -1) for column in (0, -1)} - {0}
    outside: Mask = np.isin(label, list(corners))
    if not outside.any() or (free & ~outside).sum() < outside.sum() / 4:
        return free, []
    area = outside.sum() * resolution**2
    message = (
        f"What lies around the building, {area:.3g} square metres that reach a corner of the picture, was dropped."
    )
    outline = shapely.transform(straighten(trace(outside), 1.5), lambda xy: xy * resolution)
    return free & ~outside, [Repair("dropped outside", message, outline)]
