"""Evaders as bodies in the world: any number of them, each as it would go alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from geomsim.team import Evader
from geomsim.walking import Routes, Walkers
from geomsim.world import World

__all__ = ["Quarry"]


class Quarry:
    """K evaders of one kind that walk among walls.

    Parameters
    ----------
    walls : ndarray, shape (W, 2, 2)
        Wall segments, metres.
    routes : Routes
        The ways between checkpoints.
    evader : Evader
        Their kind.
    starts : sequence of int
        The cell in which each of them starts, counted from 0.
    chance : sequence of Generator
        One for each.

    Attributes
    ----------
    world : World
        Their bodies and the walls.
    robots : ndarray, shape (R, 2)
        Where the robots are now, metres; to be kept up to date where the evader's model reacts.
    """

    def __init__(
        self,
        walls: NDArray[np.float64],
        routes: Routes,
        evader: Evader,
        starts: Sequence[int],
        chance: Sequence[np.random.Generator],
    ) -> None:
        begin = [routes.stay(cell, 0.0) for cell in starts]
        k = len(begin)
        self._walkers = Walkers(np.full(k, evader.speed), begin)
        self.world = World(walls, np.array([route.points[0] for route in begin]), np.full(k, evader.radius))
        self.robots = np.empty((0, 2))
        self._tours = [
            evader.model.walk(routes, cell, rng, lambda i=i: self._lookout(i))  # type: ignore[misc]
            for i, (cell, rng) in enumerate(zip(starts, chance, strict=True))
        ]

    def __len__(self) -> int:
        return len(self._tours)

    @property
    def positions(self) -> NDArray[np.float64]:
        """Where the evaders are, shape (K, 2), metres."""
        return self.world.positions

    @property
    def cells(self) -> NDArray[np.int32]:
        """The cells in which they are, counted from 0, shape (K,)."""
        return self._walkers.cells

    @property
    def idle(self) -> NDArray[np.float64]:
        """Seconds for which each has been held up, shape (K,)."""
        return self._walkers.idle

    def step(self, dt: float) -> None:
        """Go on by ``dt`` seconds."""
        walkers, at, velocity = self._walkers, self.world.positions, self.world.velocities
        walkers.advance(at, velocity, dt)
        while (done := walkers.done).any():
            for k in np.flatnonzero(done).tolist():
                walkers.take(k, next(self._tours[k]))
        self.world.step(walkers.wanted(dt), dt)

    def keep(self, which: NDArray[np.intp]) -> None:
        """Go on with some of the evaders only, given by their indices in rising order."""
        self._walkers.keep(which)
        self.world.keep(which)
        self._tours = [self._tours[k] for k in which.tolist()]

    def _lookout(self, k: int) -> NDArray[np.float64]:
        seen = [self.world.sees(self.positions[k], robot) for robot in self.robots]
        return np.compress(seen, self.robots, axis=0)
