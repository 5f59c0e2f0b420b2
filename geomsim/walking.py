"""Routes between checkpoints, and bodies that walk them at a given speed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from discretize import CellMap
from planners import Roads

if TYPE_CHECKING:
    from scipy.sparse import csr_array

__all__ = ["Route", "Routes", "Walkers"]


@dataclass(frozen=True)
class Route:
    """The way from a checkpoint to a neighbouring one, or a stay.

    Attributes
    ----------
    stops : tuple of int
        Checkpoints at which it begins and ends, counted from 0; twice the same one for a stay.
    cells : tuple of int
        Cells in which these count, see :class:`planners.Roads`.
    points : ndarray, shape (k, 2)
        A polyline, metres.
    marks : ndarray, shape (k,)
        Way from the beginning to each point, metres.
    crossing : float
        Way from the beginning to where the second cell begins, metres; infinite for a stay.
    length : float
        Metres; for a stay the way that a body would have gone meanwhile.
    """

    stops: tuple[int, int]
    cells: tuple[int, int]
    points: NDArray[np.float64]
    marks: NDArray[np.float64]
    crossing: float
    length: float

    @cached_property
    def slopes(self) -> NDArray[np.float64]:
        """Metres of x and of y for each metre of way after each point, shape (k, 2); zero where the route stands."""
        gone, apart = np.diff(self.marks), np.hypot(*np.diff(self.points, axis=0).T)
        rate = np.diff(self.points, axis=0) / np.where((gone > 0) & (apart > 0), gone, np.inf)[:, np.newaxis]
        return np.concatenate([rate, np.zeros((1, 2))])

    def at(self, way: float) -> NDArray[np.float64]:
        """Return the point that lies ``way`` metres along the route, shape (2,)."""
        return np.array([np.interp(way, self.marks, self.points[:, 0]), np.interp(way, self.marks, self.points[:, 1])])

    def cell(self, way: float) -> int:
        """Return the cell in which that point lies."""
        return self.cells[0] if way < self.crossing else self.cells[1]


class Routes:
    """All routes of a cell map, made when first asked for.

    Parameters
    ----------
    place : CellMap or Roads
        The map, for ways from centroid to centroid, or its roads.
    """

    def __init__(self, place: CellMap | Roads) -> None:
        self.roads = place if isinstance(place, Roads) else Roads.of(place)
        graph = self.roads.graph
        self._made: dict[tuple[int, int], Route] = {}
        self._stays: dict[tuple[int, float], Route] = {}
        self._trees: dict[int, tuple[NDArray[np.float64], NDArray[np.int32]]] = {}
        self.neighbours: tuple[tuple[int, ...], ...] = tuple(
            tuple(graph.neighbours(stop).tolist()) for stop in range(len(graph))
        )

    def checkpoint(self, stop: int) -> NDArray[np.float64]:
        """Return where a checkpoint is, shape (2,), metres."""
        return np.asarray(self.roads.points[stop], dtype=np.float64)

    def between(self, start: int, end: int) -> Route:
        """Return the route from a checkpoint to a neighbouring one."""
        key = (start, end)
        if key not in self._made:
            edge = self.roads.graph.edge(start, end)
            points, cells = self.roads.lines[edge], (int(self.roads.cell[start]), int(self.roads.cell[end]))
            marks = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
            crossing = float(self.roads.graph.leave[edge])
            self._made[key] = Route(key, cells, points, marks, crossing, float(marks[-1]))
        return self._made[key]

    def stay(self, stop: int, length: float) -> Route:
        """Return a stay at a checkpoint for as long as going ``length`` metres would take."""
        key = (stop, length)
        if key not in self._stays:
            here, cell = self.checkpoint(stop), int(self.roads.cell[stop])
            points, marks = np.stack([here, here]), np.array([0.0, length])
            self._stays[key] = Route((stop, stop), (cell, cell), points, marks, np.inf, length)
        return self._stays[key]

    def distances(self, start: int) -> NDArray[np.float64]:
        """Return the way from a checkpoint to every other, shape (V,), metres; infinite where none is."""
        return self._tree(start)[0]

    def path(self, start: int, end: int) -> tuple[int, ...]:
        """Return the checkpoints on the shortest way from one to another, without the first; none if there is none."""
        before = self._tree(start)[1]
        path: list[int] = []
        while end != start and end >= 0:
            path.append(end)
            end = int(before[end])
        return tuple(reversed(path)) if end == start else ()

    def _tree(self, start: int) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        if start not in self._trees:
            from scipy.sparse.csgraph import dijkstra

            way, before = dijkstra(self._ways, directed=True, indices=[start], return_predecessors=True)
            self._trees[start] = way[0], before[0]
        return self._trees[start]

    @cached_property
    def _ways(self) -> csr_array[Any, tuple[int, int]]:
        from scipy.sparse import csr_array

        graph = self.roads.graph
        return csr_array((graph.length, (self.roads.tails, graph.indices)), shape=(len(graph), len(graph)))


class Walkers:
    """Steers K bodies along routes, all of them in each NumPy call.

    What is wanted of a body shows in its position two steps later (:meth:`geomsim.world.World.step`), so a walker
    aims at where the body should be then. The body thus goes its way at exactly its speed, and the end of a route is
    reached, and the next one asked for, two steps before the body is there. How many bodies there are changes
    nothing in how one of them goes.

    Parameters
    ----------
    speeds : ndarray, shape (K,)
        Metres a second.
    starts : sequence of Route
        K routes on which the aims begin; a stay of no length if the first route is to be chosen at once.

    Attributes
    ----------
    aim : ndarray, shape (K,)
        Way of the aim along the route, metres.
    begins : ndarray of int32, shape (K,)
        The checkpoint at which the route begins.
    cells : ndarray of int32, shape (K,)
        The cell in which each body is, counted from 0.
    ends : ndarray of int32, shape (K,)
        The checkpoint at which the route ends.
    idle : ndarray, shape (K,)
        Seconds since the aim last moved; it waits while a body is held up.
    """

    #: a body further than this from where it should be is waited for, metres
    PATIENCE = 0.1

    def __init__(self, speeds: NDArray[np.float64], starts: Sequence[Route]) -> None:
        k = len(starts)
        self.speeds = np.array(speeds, dtype=np.float64)
        self._squares = self.speeds**2
        self.aim, self.idle, self._length, self._crossing = np.zeros(k), np.zeros(k), np.zeros(k), np.zeros(k)
        self._leaves, self._enters = np.zeros(k, dtype=np.int32), np.zeros(k, dtype=np.int32)
        self.begins, self.ends = np.zeros(k, dtype=np.int32), np.zeros(k, dtype=np.int32)
        # polylines, padded to the longest one met so far: points, ways to them, metres of x and y a metre of way
        self._points, self._slopes = np.zeros((k, 2, 2)), np.zeros((k, 2, 2))
        self._marks = np.full((k, 3), np.inf)
        # the piece of the polyline that the aim is on: its number, first point, way to that, slopes, way to its end
        self._piece = np.zeros(k, dtype=np.intp)
        self._corner, self._slope = np.zeros((2, k)).T, np.zeros((2, k)).T
        self._from, self._until = np.zeros(k), np.zeros(k)
        for i, route in enumerate(starts):
            self._follow(i, route)
        self._turn(np.arange(k))
        # where the bodies should be now and one step from now
        self._now = self._next = self._corner.copy()
        self._coasting = self._now
        self.cells = self._next_cells = self._leaves.copy()

    @property
    def done(self) -> NDArray[np.bool_]:
        """Whether the aim has come to the end of the route, so that the next one is needed; shape (K,)."""
        return self.aim >= self._length

    @property
    def time_left(self) -> NDArray[np.float64]:
        """Seconds until the aim comes to the end of the route, shape (K,)."""
        return np.maximum(0.0, self._length - self.aim) / self.speeds

    @property
    def aimed_cells(self) -> NDArray[np.int32]:
        """The cell in which each aim is, counted from 0, shape (K,)."""
        return np.where(self.aim < self._crossing, self._leaves, self._enters)

    @property
    def aimed_stops(self) -> NDArray[np.int32]:
        """The checkpoint, of the two of its route, in whose cell each aim is; shape (K,)."""
        return np.where(self.aim < self._crossing, self.begins, self.ends)

    def take(self, k: int, route: Route) -> None:
        """Let walker ``k`` go on along another route; what its aim had left over of the step is gone along it."""
        self.aim[k] = max(0.0, self.aim[k] - self._length[k])
        self._follow(k, route)

    def advance(self, positions: NDArray[np.float64], velocities: NDArray[np.float64], dt: float) -> None:
        """Move the aims on by one step, but for bodies that are held up; both arrays of shape (K, 2)."""
        self._coasting = positions + velocities * dt
        going = _squares(self._coasting - self._next) <= self.PATIENCE**2
        if going.all():
            self.aim += self.speeds * dt
            self.idle[:] = 0.0
        else:
            self.aim += np.where(going, self.speeds * dt, 0.0)
            self.idle = np.where(going, 0.0, self.idle + dt)

    def wanted(self, dt: float) -> NDArray[np.float64]:
        """Return the velocities that bring the bodies to the aims, at most their speeds; (K, 2), metres a second.

        To be asked once a step, after :meth:`advance` and before the world's step.
        """
        over = self.aim >= self._until
        if over.any():
            self._turn(np.flatnonzero(over))
        aims = (self._corner.T + (self.aim - self._from) * self._slope.T).T
        self._now, self._next = self._next, aims
        self.cells, self._next_cells = self._next_cells, self.aimed_cells
        wanted: NDArray[np.float64] = (aims - self._coasting) / dt
        wanted.T[...] *= np.sqrt(self._squares / np.maximum(_squares(wanted), self._squares))
        return wanted

    def keep(self, which: NDArray[np.intp]) -> None:
        """Go on with some of the walkers only, given by their indices in rising order."""
        for name in (
            "speeds",
            "_squares",
            "aim",
            "idle",
            "_length",
            "_crossing",
            "_leaves",
            "_enters",
            "begins",
            "ends",
            "cells",
            "_next_cells",
        ):
            setattr(self, name, getattr(self, name)[which])
        for name in ("_piece", "_corner", "_slope", "_from", "_until", "_now", "_next", "_coasting"):
            setattr(self, name, np.asfortranarray(getattr(self, name)[which]))
        for name in ("_points", "_slopes", "_marks"):
            setattr(self, name, getattr(self, name)[which])

    def _follow(self, k: int, route: Route) -> None:
        n = len(route.marks)
        if n >= self._marks.shape[1]:
            more = ((0, 0), (0, n + 1 - self._marks.shape[1]))
            self._points, self._slopes = (np.pad(a, (*more, (0, 0))) for a in (self._points, self._slopes))
            self._marks = np.pad(self._marks, more, constant_values=np.inf)
        self._points[k, :n], self._slopes[k, :n] = route.points, route.slopes
        self._marks[k, :n], self._marks[k, n:] = route.marks, np.inf
        self._length[k], self._crossing[k] = route.length, route.crossing
        self._leaves[k], self._enters[k] = route.cells
        self.begins[k], self.ends[k] = route.stops
        self._piece[k], self._until[k] = -1, -np.inf

    def _turn(self, which: NDArray[np.intp]) -> None:
        """Go on to the pieces that the aims of some walkers are on."""
        piece, left = self._piece, which
        while len(left):
            piece[left] += 1
            left = left[self.aim[left] >= self._marks[left, piece[left] + 1]]
        at = piece[which]
        self._corner[which], self._slope[which] = self._points[which, at], self._slopes[which, at]
        self._from[which], self._until[which] = self._marks[which, at], self._marks[which, at + 1]


def _squares(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the squared lengths of K vectors; element by element, so that K changes no bit of any."""
    each = vectors * vectors
    return each[:, 0] + each[:, 1]
