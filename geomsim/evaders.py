"""How an evader moves: small classes, registered by name, that choose the next route at each checkpoint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from geomsim.walking import Route, Routes
from maps import GeomsimError, nearest

__all__ = ["EVADERS", "CentroidBoundary", "EvaderModel", "Still", "make_evader_model"]


class EvaderModel(Protocol):
    """Chooses where an evader goes next."""

    def next_route(self, routes: Routes, cell: int, rng: np.random.Generator) -> Route:
        """Return the route to take from the checkpoint of ``cell`` (counted from 0)."""
        ...


@dataclass(frozen=True, slots=True)
class CentroidBoundary:
    """Moves at random between the centroid and the boundaries of cells (Hollinger et al., Section V).

    At a centroid each portal of the cell is as likely as any other; the evader goes through it to the centroid beyond.
    """

    def next_route(self, routes: Routes, cell: int, rng: np.random.Generator) -> Route:
        """Return the route to a uniformly random neighbour."""
        neighbours = routes.neighbours[cell]
        if not neighbours:
            return routes.stay(cell, 1.0)
        return routes.between(cell, neighbours[int(rng.integers(len(neighbours)))])


@dataclass(frozen=True, slots=True)
class Still:
    """Stays where it is (Hollinger et al., Section V, the immobile target)."""

    def next_route(self, routes: Routes, cell: int, rng: np.random.Generator) -> Route:  # noqa: ARG002
        """Return a stay."""
        return routes.stay(cell, 1.0)


EVADERS: dict[str, type[CentroidBoundary] | type[Still]] = {"centroid-boundary": CentroidBoundary, "still": Still}


def make_evader_model(name: str) -> EvaderModel:
    """Make an evader model by its registered name; GeomsimError names the nearest if there is none."""
    try:
        return EVADERS[name]()
    except KeyError:
        raise GeomsimError(f"There is no evader model {name!r}: {nearest(name, EVADERS)}") from None
