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
    detection : float
        Probability of noticing, within a second, an evader that stays in view; 1 notices at once.
    """

    range: float = math.inf
    field_of_view: float = math.tau
    detection: float = 1.0

    def __post_init__(self) -> None:
        if not self.range > 0:
            raise GeomsimError(f"The range of a sensor must be positive, but is {self.range:g} m.")
        if not 0 < self.field_of_view <= math.tau + 1e-9:
            raise GeomsimError(
                f"A field of view must be above 0 and at most 360 degrees, but is {math.degrees(self.field_of_view):g}."
            )

        if not 0 < self.detection <= 1:
            raise GeomsimError(f"A detection probability must be above 0 and at most 1, but is {self.detection:g}.")

    @property
    def attention(self) -> float:
        """Rate at which an evader in view is noticed, a second; infinite where it is noticed at once.

        An evader is noticed as soon as the rate times the time for which this robot has had it in view reaches an
        exponentially distributed number of mean 1, drawn once for robot and evader: the same as drawing anew at
        every step, but the same number serves every team.
        """
        return math.inf if self.detection == 1 else -math.log1p(-self.detection)

    def sees(self, world: World, eye: NDArray[np.float64], heading: float, target: NDArray[np.float64]) -> bool:
        """Whether a robot at ``eye`` that looks along ``heading`` (radians) sees the point ``target``."""
        dx, dy = (target - eye).tolist()
        if math.hypot(dx, dy) > self.range:
            return False
        off = math.remainder(math.atan2(dy, dx) - heading, math.tau)
        if abs(off) > self.field_of_view / 2 and (dx, dy) != (0.0, 0.0):
            return False
        return world.sees(eye, target)
