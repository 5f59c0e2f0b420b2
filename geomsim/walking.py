"""Routes between checkpoints, and bodies that walk them at a given speed."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from discretize import CellMap

__all__ = ["Route", "Routes", "Walker"]


@dataclass(frozen=True, slots=True)
class Route:
    """The way from the checkpoint of one cell to that of a neighbour, or a stay.

    Attributes
    ----------
    cells : tuple of int
        Where it begins and ends, counted from 0; twice the same cell for a stay.
    points : ndarray, shape (k, 2)
        A polyline, metres.
    marks : ndarray, shape (k,)
        Way from the beginning to each point, metres.
    crossing : float
        Way from the beginning to the portal, metres; infinite for a stay.
    length : float
        Metres; for a stay the way that a body would have gone meanwhile.
    """

    cells: tuple[int, int]
    points: NDArray[np.float64]
    marks: NDArray[np.float64]
    crossing: float
    length: float

    def at(self, way: float) -> NDArray[np.float64]:
        """Return the point that lies ``way`` metres along the route, shape (2,)."""
        return np.array([np.interp(way, self.marks, self.points[:, 0]), np.interp(way, self.marks, self.points[:, 1])])

    def cell(self, way: float) -> int:
        """Return the cell in which that point lies."""
        return self.cells[0] if way < self.crossing else self.cells[1]


class Routes:
    """All routes of a cell map, made when first asked for."""

    def __init__(self, cells: CellMap) -> None:
        self._cells = cells
        self._portals = {portal.cells: portal for portal in cells.portals}
        self._made: dict[tuple[int, int], Route] = {}
        joined: list[list[int]] = [[] for _ in cells.cells]
        for i, j in cells.edges:
            joined[i].append(j)
            joined[j].append(i)
        self.neighbours: tuple[tuple[int, ...], ...] = tuple(tuple(sorted(row)) for row in joined)

    def checkpoint(self, cell: int) -> NDArray[np.float64]:
        """Return the checkpoint of a cell, shape (2,), metres."""
        return np.asarray(self._cells.checkpoints[cell], dtype=np.float64)

    def between(self, start: int, end: int) -> Route:
        """Return the route from the checkpoint of a cell to that of a neighbour."""
        key = (start, end)
        if key not in self._made:
            portal = self._portals[(min(key), max(key))]
            near, far = portal.legs if start < end else portal.legs[::-1]
            points = np.concatenate([near, far[-2::-1]])
            marks = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
            self._made[key] = Route(key, points, marks, float(marks[len(near) - 1]), float(marks[-1]))
        return self._made[key]

    def stay(self, cell: int, length: float) -> Route:
        """Return a stay at a checkpoint for as long as going ``length`` metres would take."""
        here = self.checkpoint(cell)
        return Route((cell, cell), np.stack([here, here]), np.array([0.0, length]), np.inf, length)


@dataclass(slots=True)
class Walker:
    """Steers one body along routes.

    What is wanted of a body shows in its position two steps later (:meth:`geomsim.world.World.step`), so the walker
    aims at where the body should be then. The body thus goes its way at exactly its speed, and the end of a route is
    reached, and the next one asked for, two steps before the body is there.

    Attributes
    ----------
    speed : float
        Metres a second.
    route : Route
        The route that the aim is on.
    aim : float
        Way of the aim along the route, metres.
    ahead : list of (point, cell)
        Where the body should be now and one step from now.
    idle : float
        Seconds since the aim last moved; it waits while a body is held up.
    """

    speed: float
    route: Route
    aim: float = 0.0
    ahead: list[tuple[NDArray[np.float64], int]] = field(default_factory=list)
    idle: float = 0.0

    #: a body further than this from where it should be is waited for, metres
    PATIENCE = 0.1

    def __post_init__(self) -> None:
        start = (self.route.points[0], self.route.cells[0])
        self.ahead = [start, start]

    @property
    def cell(self) -> int:
        """The cell in which the body is, counted from 0."""
        return self.ahead[0][1]

    @property
    def done(self) -> bool:
        """Whether the aim has come to the end of the route, so that the next one is needed."""
        return self.aim >= self.route.length

    @property
    def time_left(self) -> float:
        """Seconds until the aim comes to the end of the route."""
        return max(0.0, self.route.length - self.aim) / self.speed

    def take(self, route: Route) -> None:
        """Go on along another route; what the aim had left over of the step is gone along it."""
        self.aim = max(0.0, self.aim - self.route.length)
        self.route = route

    def advance(self, position: NDArray[np.float64], velocity: NDArray[np.float64], dt: float) -> None:
        """Move the aim on by one step, unless the body is held up."""
        behind = np.hypot(*(position + velocity * dt - self.ahead[1][0]))
        if behind <= self.PATIENCE:
            self.aim += self.speed * dt
            self.idle = 0.0
        else:
            self.idle += dt

    def wanted(self, position: NDArray[np.float64], velocity: NDArray[np.float64], dt: float) -> NDArray[np.float64]:
        """Return the velocity that brings the body to the aim, at most its speed; shape (2,), metres a second.

        To be asked once a step, after :meth:`advance` and before the world's step.
        """
        self.ahead = [self.ahead[1], (self.route.at(self.aim), self.route.cell(self.aim))]
        velocity = (self.ahead[1][0] - (position + velocity * dt)) / dt
        fast = float(np.hypot(*velocity))
        return velocity if fast <= self.speed else velocity * (self.speed / fast)
