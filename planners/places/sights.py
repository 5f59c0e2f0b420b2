"""Which places are in sight from where on the roads."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from discretize import CellMap
from planners.places.keeping import sight_among
from planners.places.placing import Places
from planners.roads import Roads
from planners.sight import SightMap

__all__ = ["sight_of_places"]


def sight_of_places(cells: CellMap, roads: Roads, places: Places, spacing: float, reach: float = math.inf) -> SightMap:
    """Find which places are in free sight of each station on some roads.

    Parameters
    ----------
    cells : CellMap
        The map.
    roads : Roads
        Where robots go.
    places : Places
        Where an evader can be.
    spacing : float
        Between two stations on a way, as near as whole steps allow; metres.
    reach : float
        What is further away than this need not be found, metres.
    """

    def in_sight(
        stations: NDArray[np.float64], points: NDArray[np.float64]
    ) -> tuple[NDArray[np.integer[Any]], NDArray[np.integer[Any]]]:
        from scipy.sparse import csr_array

        # the same point may be on many ways: each is looked from, and looked at, once
        (eyes, eye), (targets, target) = (_once(where) for where in (stations, points))
        indptr, indices = sight_among(cells.plan.walls, eyes, targets, reach)
        shape = (len(eyes), len(targets))
        once = csr_array((np.ones(len(indices), dtype=np.bool_), indices, indptr), shape=shape)
        seen = once[eye][:, target]
        seen.sort_indices()
        # in single words: there may be a hundred million pairs
        station = np.repeat(np.arange(seen.shape[0], dtype=np.int32), np.diff(seen.indptr))
        return station, seen.indices.astype(np.int32, copy=False)

    return SightMap.over(roads, places.space, places.points, spacing, in_sight)


def _once(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Return points without repetitions, to a micrometre, and which of them each one is."""
    once, which = np.unique(np.round(points, 6), axis=0, return_inverse=True, equal_nan=False)
    return once, which.reshape(-1).astype(np.intp)
