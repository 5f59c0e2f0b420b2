"""What every evader model must keep to: a check that users can run on their own."""

from __future__ import annotations

from itertools import islice

import numpy as np
from numpy.typing import NDArray

from discretize import CellMap
from geomsim.evaders import EvaderModel
from geomsim.walking import Route, Routes
from maps import ConformanceError

__all__ = ["check_evader"]


def check_evader(model: EvaderModel, cells: CellMap, rng: np.random.Generator, routes: int = 100) -> None:
    """Check that an evader model keeps the rules of :class:`geomsim.evaders.EvaderModel` in a building.

    From several cells, with robots in sight and without, it must yield routes without end, each beginning where the
    one before ended and leading to a neighbour or staying for a while; and the same ones from an equal seed.

    Parameters
    ----------
    model : EvaderModel
        What is checked.
    cells : CellMap
        Where.
    rng : Generator
        Chooses the cells, what is seen and the model's seed.
    routes : int
        How many are asked for.

    Raises
    ------
    ConformanceError
        At the first rule that is broken.
    """
    ways = Routes(cells)
    reachable = np.flatnonzero(cells.components == 0)
    for _ in range(4):
        cell, seed = int(rng.choice(reachable)), int(rng.integers(2**32))
        first, again = (_walk(model, ways, cell, seed, routes) for _ in range(2))
        _check(model, ways, cell, first)
        if [route.cells for route in first] != [route.cells for route in again]:
            raise ConformanceError(f"{model!r} walks differently from an equal seed.")


def _walk(model: EvaderModel, ways: Routes, cell: int, seed: int, count: int) -> list[Route]:
    chance, sight = np.random.default_rng(seed), np.random.default_rng(seed + 1)

    def lookout() -> NDArray[np.float64]:
        spots = [ways.checkpoint(c) for c in (cell, *ways.neighbours[cell])]
        return np.array(spots[: int(sight.integers(len(spots) + 1))]).reshape(-1, 2)

    routes = list(islice(model.walk(ways, cell, chance, lookout), count))
    if len(routes) < count:
        raise ConformanceError(f"{model!r} yields {len(routes)} routes from cell {cell + 1} and stops; it must go on.")
    return routes


def _check(model: EvaderModel, ways: Routes, cell: int, routes: list[Route]) -> None:
    for k, route in enumerate(routes, start=1):
        if not isinstance(route, Route):
            raise ConformanceError(f"{model!r} yields a {type(route).__name__}, not a Route.")
        begin, end = route.cells
        if begin != cell:
            raise ConformanceError(f"{model!r}: its route {k} begins in {begin + 1}, but it is in cell {cell + 1}.")
        if end != begin and end not in ways.neighbours[begin]:
            raise ConformanceError(f"{model!r}: its route {k} leads from cell {begin + 1} to {end + 1}, no neighbour.")
        if not 0 < route.length < np.inf:
            raise ConformanceError(f"{model!r}: its route {k} has a length of {route.length:g} m; it must be above 0.")
        cell = end
