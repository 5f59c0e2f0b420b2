"""How an evader moves: small classes, registered by name, that give its routes one after another."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Protocol, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from geomsim.walking import Route, Routes
from maps import GeomsimError, nearest
from maps.errors import enter
from planners import MotionModel, StationaryMotion

__all__ = [
    "EVADERS",
    "CentroidBoundary",
    "EvaderModel",
    "Fleeing",
    "Hiding",
    "Lookout",
    "ShortestPaths",
    "Still",
    "make_evader_model",
    "register_evader",
]

Lookout: TypeAlias = Callable[[], NDArray[np.float64]]
"""Gives the positions of the robots that the evader sees at this moment, shape (k, 2), metres."""


class EvaderModel(Protocol):
    """Gives the routes of an evader.

    A model whose class has a true attribute ``reacts`` is told of the robots that it sees. Each of its trials needs a
    world of its own, while one run of any other evader serves every team. A model may have a method ``in_cells(speed)``
    that returns the :class:`planners.MotionModel` which predictions of trials go by, if that is not to be
    :class:`planners.DwellTime`.
    """

    def walk(self, routes: Routes, cell: int, rng: np.random.Generator, lookout: Lookout) -> Iterator[Route]:
        """Yield routes without end, the next one whenever the evader comes to a checkpoint.

        Parameters
        ----------
        routes : Routes
            The ways between checkpoints.
        cell : int
            Where the evader starts, counted from 0; each route begins where the one before it ended.
        rng : Generator
            All chance comes from it.
        lookout : callable
            For models that react; to be asked between two routes.
        """
        ...


_Model = TypeVar("_Model", bound=EvaderModel)


@dataclass(frozen=True, slots=True)
class CentroidBoundary:
    """Moves at random between the centroid and the boundaries of cells (Hollinger et al., Section V).

    At a centroid each portal of the cell is as likely as any other; the evader goes through it to the centroid beyond.
    """

    def walk(self, routes: Routes, cell: int, rng: np.random.Generator, lookout: Lookout) -> Iterator[Route]:  # noqa: ARG002
        """Yield routes to uniformly random neighbours."""
        while True:
            for share in rng.random(32).tolist():  # many at a time: a single number costs as much as thirty
                route = _stroll(routes, cell, share)
                cell = route.cells[1]
                yield route


@dataclass(frozen=True, slots=True)
class Still:
    """Stays where it is (Hollinger et al., Section V, the immobile target)."""

    def walk(self, routes: Routes, cell: int, rng: np.random.Generator, lookout: Lookout) -> Iterator[Route]:  # noqa: ARG002
        """Yield stays."""
        while True:
            yield routes.stay(cell, 60.0)

    def in_cells(self, speed: float) -> MotionModel:  # noqa: ARG002
        """Return the identity."""
        return StationaryMotion()


@dataclass(frozen=True, slots=True)
class ShortestPaths:
    """Walks by the shortest way to a random far cell, and from there to another.

    Far are the cells at least half as far away as the farthest one.
    """

    def walk(self, routes: Routes, cell: int, rng: np.random.Generator, lookout: Lookout) -> Iterator[Route]:  # noqa: ARG002
        """Yield the routes of one way after another."""
        while True:
            way = np.where(np.isfinite(routes.distances(cell)), routes.distances(cell), -1.0)
            if way.max() <= 0:
                yield routes.stay(cell, 1.0)
                continue
            goal = int(rng.choice(np.flatnonzero(way >= way.max() / 2)))
            for following in routes.path(cell, goal):
                yield routes.between(cell, following)
                cell = following


@dataclass(frozen=True, slots=True)
class Hiding:
    """Hides in dead ends: goes to a random one by the shortest way, stays for a while, goes to another.

    A dead end is a cell with one neighbour; in a building without any, the cells with the fewest. How long the evader
    stays is exponentially distributed.

    Attributes
    ----------
    stay : float
        Mean way that it could have gone while it stays in one, metres.
    """

    stay: float = 60.0

    def walk(self, routes: Routes, cell: int, rng: np.random.Generator, lookout: Lookout) -> Iterator[Route]:  # noqa: ARG002
        """Yield the routes to a dead end, a stay, and so on."""
        reachable = np.flatnonzero(np.isfinite(routes.distances(cell)))
        doors = np.array([len(routes.neighbours[c]) for c in reachable])
        ends = reachable[doors == doors.min()]
        while True:
            others = ends[ends != cell]
            goal = int(rng.choice(others)) if len(others) else cell
            for following in routes.path(cell, goal):
                yield routes.between(cell, following)
                cell = following
            yield routes.stay(cell, round(float(rng.exponential(self.stay)), 1) + 0.1)


@dataclass(frozen=True, slots=True)
class Fleeing:
    """Wanders like :class:`CentroidBoundary`, but from robots that it sees at a checkpoint it runs away.

    It then takes the neighbour, or stays, whichever leaves it farthest from the nearest robot in sight.
    """

    reacts = True

    def walk(self, routes: Routes, cell: int, rng: np.random.Generator, lookout: Lookout) -> Iterator[Route]:
        """Yield a random route, or one away from robots."""
        while True:
            robots = lookout()
            if len(robots):
                ways = [cell, *routes.neighbours[cell]]
                gaps = [float(np.hypot(*(robots - routes.checkpoint(c)).T).min()) for c in ways]
                to = ways[int(np.argmax(gaps))]
                route = routes.stay(cell, 1.0) if to == cell else routes.between(cell, to)
            else:
                route = _stroll(routes, cell, float(rng.random()))
            cell = route.cells[1]
            yield route


def _stroll(routes: Routes, cell: int, share: float) -> Route:
    """Return the route to the neighbour that lies at a share of all, in [0, 1)."""
    neighbours = routes.neighbours[cell]
    if not neighbours:
        return routes.stay(cell, 1.0)
    return routes.between(cell, neighbours[int(share * len(neighbours))])


_EVADERS: dict[str, type[EvaderModel]] = {
    "centroid-boundary": CentroidBoundary,
    "still": Still,
    "shortest-paths": ShortestPaths,
    "hiding": Hiding,
    "fleeing": Fleeing,
}
EVADERS: Mapping[str, type[EvaderModel]] = MappingProxyType(_EVADERS)
"""Every evader model by its name."""


def register_evader(name: str) -> Callable[[type[_Model]], type[_Model]]:
    """Give an evader model of one's own a name, under which scenarios and the command line find it; a decorator.

    The class is made without arguments, so its parameters need defaults.

    Raises
    ------
    GeomsimError
        If the name is none, or there is another one of it.
    """

    def register(model: type[_Model]) -> type[_Model]:
        enter(_EVADERS, "evader model", name, model)
        return model

    return register


def make_evader_model(name: str) -> EvaderModel:
    """Make an evader model by its registered name; GeomsimError names the nearest if there is none."""
    try:
        return EVADERS[name]()
    except KeyError:
        raise GeomsimError(f"There is no evader model {name!r}: {nearest(name, EVADERS)}") from None
