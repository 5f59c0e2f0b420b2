"""Units of length and places on the globe: how other coordinates become metres."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import shapely
from numpy.typing import NDArray

from maps.errors import PlanError, nearest
from maps.floorplan import Repair

__all__ = ["METRES", "LocalFrame", "ToMetres", "check_resolution", "frame_of", "looks_like_degrees", "metres_per"]

ToMetres = Callable[[NDArray[np.float64]], NDArray[np.float64]]

METRES = {
    "m": 1.0,
    "metre": 1.0,
    "meter": 1.0,
    "mm": 0.001,
    "millimetre": 0.001,
    "millimeter": 0.001,
    "cm": 0.01,
    "centimetre": 0.01,
    "centimeter": 0.01,
    "dm": 0.1,
    "ft": 0.3048,
    "foot": 0.3048,
    "feet": 0.3048,
    "in": 0.0254,
    "inch": 0.0254,
}
"""Length of each unit in metres (foot and inch: the international ones, exact by definition)."""


def metres_per(unit: object, where: str) -> float:
    """Length of a unit in metres; PlanError with the nearest name if there is no such unit."""
    if not isinstance(unit, str):
        raise PlanError(f"{where}: units is {unit!r}; it must be the name of a unit such as 'm' or 'mm'.")
    name = unit.strip().lower()
    name = name if name in METRES else name.removesuffix("s")
    if name not in METRES:
        raise PlanError(f"{where}: the unit {unit!r} is not known; {nearest(unit, METRES)}")
    return METRES[name]


def looks_like_degrees(xy: NDArray[np.float64]) -> bool:
    """Whether coordinates can only be longitude and latitude of one building.

    They are on the globe, and so close together that in metres there would be no room in it for anybody.

    Parameters
    ----------
    xy : ndarray, shape (n, 2)
        Coordinates of unknown unit.
    """
    return bool(len(xy) and (np.abs(xy) <= (180.0, 90.0)).all() and (np.ptp(xy, axis=0) < 0.1).all() and np.ptp(xy) > 0)


class LocalFrame:
    """Metres east and north of a place on the globe.

    Lengths are those of the WGS 84 ellipsoid at the place itself, so that within one kilometre of it the error is
    below a millimetre a metre.

    Parameters
    ----------
    longitude, latitude : float
        The place, degrees.
    """

    def __init__(self, longitude: float, latitude: float) -> None:
        # Radii of curvature of the ellipsoid; EPSG Guidance Note 7-2, section on the reference ellipsoid.
        equatorial, eccentricity2 = 6_378_137.0, 0.00669437999014
        sine = np.sin(np.radians(latitude))
        w2 = 1.0 - eccentricity2 * sine**2
        east = equatorial / np.sqrt(w2) * np.cos(np.radians(latitude))
        north = equatorial * (1.0 - eccentricity2) / w2**1.5
        self.place = (longitude, latitude)
        self._scale = np.radians([east, north])

    def metres(self, xy: NDArray[np.float64]) -> NDArray[np.float64]:
        """Turn longitude and latitude, degrees, shape (n, 2), into metres."""
        return (xy - self.place) * self._scale


def frame_of(xy: NDArray[np.float64], units: object, where: str) -> tuple[ToMetres, float, list[Repair]]:
    """Find out what turns coordinates into metres.

    Parameters
    ----------
    xy : ndarray, shape (n, 2)
        The coordinates of the free space.
    units : str or None
        Name of their unit, "degrees" for longitude and latitude; None: metres, unless they can only be degrees.
    where : str
        What error sentences begin with.

    Returns
    -------
    to_metres : callable
        Takes and returns an array of shape (n, 2).
    unit : float
        Length of one unit, metres (degrees: 1, for lengths beside them are in metres).
    repairs : list of Repair
        What has to be said about it.
    """
    if units is not None and units != "degrees":
        unit = metres_per(units, where)
        return lambda xy: xy * unit, unit, []
    if units is None and not looks_like_degrees(xy):
        return lambda xy: xy, 1.0, []
    longitude, latitude = (xy.min(axis=0) + xy.max(axis=0)) / 2 if len(xy) else (0.0, 0.0)
    frame = LocalFrame(float(longitude), float(latitude))
    place = f"{longitude:.6f}, {latitude:.6f}"
    message = f"Coordinates are longitude and latitude; the plan is in metres east and north of {place}."
    return frame.metres, 1.0, [Repair("projected", message, shapely.Point(0, 0))]


def check_resolution(resolution: object, where: str) -> float:
    """Return a resolution as a number; PlanError unless it is the size of a pixel or of a unit in metres."""
    number = isinstance(resolution, int | float) and not isinstance(resolution, bool) and math.isfinite(resolution)
    if not number or not 0 < float(resolution) < 100:  # type: ignore[arg-type]
        raise PlanError(f"{where}: resolution is {resolution!r}; it must be the size of a pixel, in metres.")
    return float(resolution)  # type: ignore[arg-type]
