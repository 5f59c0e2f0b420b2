"""What a robot sees: a range, a field of view, and nothing through walls."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geomsim.world import World
from maps import GeomsimError

__all__ = ["Sensor"]


@dataclass(frozen=True, slots=True)
class Sensor:
    """A robot's eye.

    Attributes
    ----------
    range : float
        How far it sees, metres; may be infinite.
    field_of_view : float
        Angle that it sees, half of it to each side of the heading, radians, at most 2 pi.
    """

    range: float = math.inf
    field_of_view: float = math.tau

    def __post_init__(self) -> None:
        if not self.range > 0:
            raise GeomsimError(f"The range of a sensor must be positive, but is {self.range:g} m.")
        if not 0 < self.field_of_view <= math.tau + 1e-9:
            raise GeomsimError(
                f"A field of view must be above 0 and at most 360 degrees, but is {math.degrees(self.field_of_view):g}."
            )

    def sees(self, world: World, eye: NDArray[np.float64], heading: float, target: NDArray[np.float64]) -> bool:
        """Whether a robot at ``eye`` that looks along ``heading`` (radians) sees the point ``target``."""
        dx, dy = (target - eye).tolist()
        if math.hypot(dx, dy) > self.range:
            return False
        off = math.remainder(math.atan2(dy, dx) - heading, math.tau)
        if abs(off) > self.field_of_view / 2 and (dx, dy) != (0.0, 0.0):
            return False
        return world.sees(eye, target)
