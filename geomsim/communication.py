"""Who plans for whom, and which robots hear each other."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geomsim.world import World
from maps import GeomsimError, nearest

__all__ = ["LINKS", "Communication"]

LINKS = {
    "central": "one planner plans for the whole team",
    "full": "every robot plans for itself and hears all others",
    "range": "every robot plans for itself and hears those within a range",
    "sight": "every robot plans for itself and hears those that no wall hides",
}


@dataclass(frozen=True, slots=True)
class Communication:
    """How a team talks.

    Attributes
    ----------
    links : str
        A name in ``LINKS``. Robots pass on what they heard, so that a chain of links is as good as one.
    range : float
        How far robots hear each other, metres; infinite but for links ``range``, and ``sight`` if wanted.

    Raises
    ------
    GeomsimError
        If there are no such links, or they and the range do not go together.
    """

    links: str = "central"
    range: float = math.inf

    def __post_init__(self) -> None:
        if self.links not in LINKS:
            raise GeomsimError(f"There is no communication {self.links!r}; {nearest(self.links, LINKS)}")
        if not self.range > 0:
            raise GeomsimError(f"The range of communication must be positive, but is {self.range:g} m.")
        if self.links == "range" and math.isinf(self.range):
            raise GeomsimError("Communication over a range needs to know the range, in metres.")
        if self.links in ("central", "full") and math.isfinite(self.range):
            raise GeomsimError(
                f"Communication {self.links!r} has no range, but {self.range:g} m are given: choose 'range' or 'sight'."
            )

    @property
    def central(self) -> bool:
        """Whether one planner plans for all."""
        return self.links == "central"

    def contacts(self, world: World, positions: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which of P robots hear each other, directly or through others, shape (P, P).

        Parameters
        ----------
        world : World
            Its walls are in the way of sight.
        positions : ndarray, shape (P, 2)
            Where the robots are, metres.
        """
        team = len(positions)
        if self.links in ("central", "full"):
            return np.ones((team, team), dtype=np.bool_)
        heard = np.hypot(*np.moveaxis(positions[:, np.newaxis] - positions, -1, 0)) <= self.range
        if self.links == "sight":
            for i in range(team):
                for j in range(i):
                    free = bool(heard[i, j]) and world.sees(positions[i], positions[j])
                    heard[i, j] = heard[j, i] = free
        for via in range(team):
            heard |= heard[:, [via]] & heard[[via]]
        return np.asarray(heard)
