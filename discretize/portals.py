"""Checkpoints of cells, and the portals through which a round body goes from one cell to the next."""

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.cellmap import Portal
from discretize.routes import Ways
from discretize.sharing import shared_segments

__all__ = ["find_checkpoints", "find_openings", "find_portals"]


def find_checkpoints(cells: Sequence[shapely.Polygon], ways: Ways) -> NDArray[np.float64]:
    """Centroid of each cell, or where a body cannot stand there the nearest place in the cell where it can.

    Parameters
    ----------
    cells : sequence of shapely.Polygon
        N cells, metres.
    ways : Ways
        Where the body can be.

    Returns
    -------
    ndarray, shape (N, 2)
        Metres; NaN for a cell that no body can enter.
    """
    points = shapely.get_coordinates(shapely.centroid(np.array(cells, dtype=object)))
    inside = shapely.contains_xy(np.array(cells, dtype=object), points[:, 0], points[:, 1])
    for k in np.flatnonzero((ways.tight.part_of(points) < 0) | ~inside).tolist():
        places = (reach.within(cells[k]) for reach in (ways.roomy, ways.tight))
        place = next((p for p in places if not p.is_empty), None)
        points[k] = np.nan if place is None else shapely.shortest_line(place, shapely.Point(points[k])).coords[0]
    return points


def find_portals(cells: Sequence[shapely.Polygon], checkpoints: NDArray[np.float64], ways: Ways) -> tuple[Portal, ...]:
    """Find the portal of every two cells between which a body can go, and the routes to it.

    Parameters
    ----------
    cells : sequence of shapely.Polygon
        N cells, metres.
    checkpoints : ndarray, shape (N, 2)
        As :func:`find_checkpoints` gives them.
    ways : Ways
        Where the body can be.
    """
    pairs, segments, points = find_openings(cells, checkpoints, ways)
    routes = ways.legs(cells, checkpoints, pairs, segments, points)
    return tuple(
        Portal((int(a), int(b)), segment, point, legs)
        for (a, b), segment, point, legs in zip(pairs, segments, points, routes, strict=True)
        if legs is not None
    )


def find_openings(
    cells: Sequence[shapely.Polygon], checkpoints: NDArray[np.float64], ways: Ways
) -> tuple[NDArray[np.intp], NDArray[np.float64], NDArray[np.float64]]:
    """Find the cells between which a body can go, and where it goes.

    Two cells are adjacent where they share a straight segment on which the body's centre can be, in the connected
    part of its reach that holds both checkpoints. Where there are several such places the one with the longest opening
    is taken; its middle is the portal point.

    Parameters
    ----------
    cells : sequence of shapely.Polygon
        N cells, metres.
    checkpoints : ndarray, shape (N, 2)
        As :func:`find_checkpoints` gives them.
    ways : Ways
        Where the body can be.

    Returns
    -------
    pairs : ndarray, shape (k, 2)
        Adjacent cells, the smaller first, in rising order.
    segments : ndarray, shape (k, 2, 2)
        The shared segment, the first cell on its left.
    points : ndarray, shape (k, 2)
        Portal points.
    """
    pairs, segments = shared_segments(cells)
    owner, openings = ways.tight.openings(segments)
    home = ways.tight.part_of(checkpoints)
    points = openings.mean(axis=1)
    part = ways.tight.part_of(points)
    joins = (part >= 0) & (home[pairs[owner]] == part[:, None]).all(axis=1)
    owner, points = owner[joins], points[joins]
    length = np.hypot(*(openings[joins, 1] - openings[joins, 0]).T)
    rank = np.lexsort((-np.round(length, 6), pairs[owner, 1], pairs[owner, 0]))
    owner, points = owner[rank], points[rank]
    best = np.unique(pairs[owner], axis=0, return_index=True)[1]
    owner = owner[best]
    return pairs[owner], segments[owner], points[best]
