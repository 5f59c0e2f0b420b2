"""The physical world: walls as pymunk static segments, robots and evaders as discs driven by force.

Bodies are driven by the force that would give them the wanted velocity, not by setting the velocity: pymunk moves
positions before its solver runs, so a velocity that is set anew each step is never corrected by a wall. There is no
continuous collision detection: a body must not move further in a step than its radius.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import pymunk
import shapely
from numpy.typing import NDArray
from pymunk import batch

from maps import GeomsimError

__all__ = ["World", "count_wall_crossings"]

_WALL = pymunk.ShapeFilter(categories=0b10)
_BODY = pymunk.ShapeFilter(categories=0b01, mask=0b10)  # bodies meet walls only, so one never changes another's path
_RAY = pymunk.ShapeFilter(mask=0b10)


class World:
    """K disc bodies among walls.

    Parameters
    ----------
    walls : ndarray, shape (W, 2, 2)
        Wall segments, metres.
    positions : ndarray, shape (K, 2)
        Where the bodies start, metres; at rest.
    radii : ndarray, shape (K,)
        Metres.
    """

    def __init__(self, walls: NDArray[np.float64], positions: NDArray[np.float64], radii: NDArray[np.float64]) -> None:
        self.space = pymunk.Space()
        self.space.collision_slop = 0.001  # the default, a decimetre, lets bodies sink into walls at this scale
        # As fast as the default tree for few bodies and faster for hundreds. Always the same one: hash and tree take
        # contacts in another order, and a body's path must not depend on how many there are.
        self.space.use_spatial_hash(2.0, 3000)
        self._walls = walls
        _add_walls(self.space, walls)
        self.radii = np.array(radii, dtype=np.float64)
        for position, radius in zip(positions.tolist(), self.radii.tolist(), strict=True):
            body = pymunk.Body(mass=1.0, moment=float("inf"))
            body.position = tuple(position)
            disc = pymunk.Circle(body, radius)
            disc.filter = _BODY
            self.space.add(body, disc)
        self._least = float(self.radii.min())
        self._bodies = list(self.space.bodies)
        self._count = len(self.radii)
        self._order: NDArray[np.intp] | None = None  # row of each body in the space's own order, if that is another
        self._get, self._set = batch.Buffer(), batch.Buffer()
        self._forces = np.zeros((self._count + 1, 2))  # the static body can come as a last row
        self._set.set_float_buf(self._forces.reshape(-1))
        self.positions = np.empty((self._count, 2))
        self.velocities = np.empty((self._count, 2))
        self._read()

    def step(self, wanted: NDArray[np.float64], dt: float) -> None:
        """Advance time by ``dt``; ``positions`` and ``velocities`` are then those of its end.

        Positions move with the velocity that the bodies had, then the wanted one takes its place as far as walls
        allow: what is wanted now shows in the positions one step later.

        Parameters
        ----------
        wanted : ndarray, shape (K, 2)
            Velocities, metres a second.
        dt : float
            Seconds.

        Raises
        ------
        GeomsimError
            If a body would move further than its radius, where a wall might be missed.
        """
        if 2.0 * float(np.abs(wanted).max()) * dt > self._least:  # more than that no body can move
            self._check(np.hypot(wanted[:, 0], wanted[:, 1]) * dt, dt)
        self._forces[slice(-1) if self._order is None else self._order] = (wanted - self.velocities) / dt
        batch.set_space_bodies(self.space, batch.BodyFields.FORCE, self._set)
        self.space.step(dt)
        self._read()

    def _check(self, reach: NDArray[np.float64], dt: float) -> None:
        if np.any(reach > self.radii):
            k = int(np.argmax(reach / self.radii))
            raise GeomsimError(
                f"A body of radius {self.radii[k]:g} m would move {reach[k]:g} m in one physics step of {dt:g} s and "
                "might miss a wall: make the step shorter, the body slower or larger."
            )

    def sees(self, eye: NDArray[np.float64], target: NDArray[np.float64]) -> bool:
        """Whether no wall is on the straight way between two points; bodies do not block it."""
        return self._rays.segment_query_first(tuple(eye.tolist()), tuple(target.tolist()), 0.0, _RAY) is None

    @cached_property
    def _rays(self) -> pymunk.Space:
        """The walls alone, in the default tree: a spatial hash misses a wall that ends in a corner of its squares."""
        space = pymunk.Space()
        _add_walls(space, self._walls)
        return space

    def keep(self, which: NDArray[np.intp]) -> None:
        """Go on with some of the bodies only, given by their indices in rising order; the others are removed."""
        kept = set(which.tolist())
        for k, body in enumerate(self._bodies):
            if k not in kept:
                self.space.remove(body, *body.shapes)
        self._bodies = [self._bodies[k] for k in which.tolist()]
        self.radii = self.radii[which]
        self._count = len(which)
        # the space fills the gaps that removed bodies leave in its own way, so ask it for the order
        self._get.clear()
        batch.get_space_bodies(self.space, batch.BodyFields.BODY_ID, self._get)
        row = {number: k for k, number in enumerate(np.frombuffer(self._get.int_buf(), dtype=np.uintp).tolist())}
        self._order = np.array([row[body.id] for body in self._bodies], dtype=np.intp)
        self._forces = np.zeros((self._count + 1, 2))
        self._set.set_float_buf(self._forces.reshape(-1))
        self._read()

    def _read(self) -> None:
        self._get.clear()
        fields = batch.BodyFields.POSITION | batch.BodyFields.VELOCITY
        batch.get_space_bodies(self.space, fields, self._get)
        rows = np.frombuffer(self._get.float_buf(), dtype=np.float64).reshape(-1, 4)
        # column by column: NumPy goes along K bodies many times faster than along the two coordinates of each
        # (and a copy: asfortranarray would give the buffer itself for one body)
        mine = np.array(rows[: self._count] if self._order is None else rows[self._order], order="F")
        self.positions, self.velocities = mine[:, :2], mine[:, 2:]


def _add_walls(space: pymunk.Space, walls: NDArray[np.float64]) -> None:
    for a, b in walls.tolist():
        wall = pymunk.Segment(space.static_body, tuple(a), tuple(b), 0.0)
        wall.filter = _WALL
        space.add(wall)


def count_wall_crossings(track: NDArray[np.float64], walls: NDArray[np.float64]) -> int:
    """Count the moves that crossed a wall, which must be none.

    Parameters
    ----------
    track : ndarray, shape (T, K, 2)
        Positions of K bodies at T times, metres.
    walls : ndarray, shape (W, 2, 2)
        Wall segments, metres.
    """
    tree = shapely.STRtree([shapely.LineString(wall) for wall in walls])
    moves = np.stack([track[:-1], track[1:]], axis=2).reshape(-1, 2, 2)
    moves = moves[np.any(moves[:, 0] != moves[:, 1], axis=1)]
    which, _ = tree.query(shapely.linestrings(moves), predicate="intersects")
    return len(np.unique(which))
