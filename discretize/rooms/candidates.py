"""Every sensible cut of a plan: doorways, and where these leave a part that is not nearly convex all others."""

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.rooms.cuts import ASKEW, askew, corners, distinct, doorways, extensions, necks, ring_segments
from discretize.rooms.faces import GRID, arrangement
from discretize.rooms.rays import Walls, lines_of

__all__ = ["candidate_cuts"]

Array = NDArray[np.float64]

REACH = 6.0  # metres; a wider neck is no place for a cut of its own: extensions of walls go on for ever
FAR = 1e4  # metres


def candidate_cuts(space: shapely.Geometry, doors: Array, tolerance: float, notch: float) -> tuple[Array, Array]:
    """Find the cuts among which the boundaries of cells will be chosen.

    Parameters
    ----------
    space : shapely.Geometry
        Structure of a plan, on the grid.
    doors : ndarray, shape (k, 2, 2)
        Doors of the source, metres.
    tolerance : float
        A part whose area is at least ``1 - tolerance / 2`` of its hull's needs no cut.
    notch : float
        Recesses and pillars no deeper than this are not cut off, metres.

    Returns
    -------
    cuts, doorways : ndarray, shape (k, 2, 2)
        Metres.
    """
    at = corners(space)
    segments, ends = necks(space, at, REACH)
    chosen, clear = doorways(space, at, segments, ends)
    certain = segments[chosen[clear]]
    zones = arrangement(space, np.empty((0, 2, 2)), certain, doors)
    rest = np.delete(np.arange(len(segments)), chosen[clear])
    maybe, rank = _useful(space, segments[rest], ends[rest], len(at))
    tree = shapely.STRtree(lines_of(maybe))
    cuts = [np.empty((0, 2, 2))]
    for zone in zones.polygons[~zones.sill]:
        if zone.area >= (1.0 - 0.5 * tolerance) * zone.convex_hull.area and not zone.interiors:
            continue
        local = corners(zone)
        deep = {tuple(p) for p in corners(shapely.simplify(zone, notch)).points.tolist()}
        local = local[np.array([tuple(p) in deep for p in local.points.tolist()], dtype=bool)]
        if len(local) == 0:
            continue
        lines = extensions(Walls(ring_segments(zone)), local, FAR)
        inside = np.sort(tree.query(shapely.buffer(zone, 2 * GRID), predicate="covers"))
        found = np.concatenate([lines, maybe[inside]])
        width = np.concatenate([np.hypot(*(lines[:, 1] - lines[:, 0]).T), rank[inside]])
        cuts.append(distinct(found[np.argsort(width.round(3), kind="stable")]))
    return np.concatenate(cuts), certain


def _useful(space: shapely.Geometry, necks: Array, ends: NDArray[np.intp], n: int) -> tuple[Array, Array]:
    """Keep necks that carry on a wall or are the shortest one at a corner; also return the width each counts as."""
    factor = askew(space, necks)
    length = np.hypot(*(necks[:, 1] - necks[:, 0]).T)
    least = np.full(n + 1, np.inf)
    for side in (0, 1):
        np.minimum.at(least, ends[:, side], length)
    least[-1] = 0.0
    keep = (factor < ASKEW) | (length[:, None] <= least[ends] + 1e-9).any(1)
    return necks[keep], (factor * length)[keep]
