"""Cut a plan into few cells that look like rooms and hallways."""

from dataclasses import dataclass

import numpy as np
import shapely
from discretize.rooms.cuts import ASKEW, askew, corners, doorways, extensions, necks, ring_segments, same_cut
from discretize.rooms.faces import GRID, Faces, arrangement
from discretize.rooms.fitting import fit
from discretize.rooms.merging import Limits, Region, Regions
from discretize.rooms.rays import Walls
from discretize.rooms.selection import partition
from discretize.rooms.structure import structure
from maps import FloorPlan
from numpy.typing import NDArray

__all__ = ["RoomCut", "room_cells"]

Array = NDArray[np.float64]

SOLID = 0.9
GATE = 0.7
W = [1.0, 2.0, 0.15]
THROUGH = 0.4
KEEP = 1
ROUNDS = 3
SHARES = [0.0, 0.2, 0.2, 0.4, 0.4]


@dataclass(frozen=True, slots=True)
class RoomCut:
    """A plan cut into rooms and hallways.

    Attributes
    ----------
    cells : tuple of shapely.Polygon
        They cover the free space and do not overlap.
    notes : tuple of str
        What the report should say about how they were made.
    """

    cells: tuple[shapely.Polygon, ...]
    notes: tuple[str, ...]


def room_cells(plan: FloorPlan, *, tolerance: float = 0.1, seed: int = 0, radius: float = 0.2, runs: int = 12) -> RoomCut:
    space = structure(plan.space, detail=radius / 2, clutter=4 * radius)
    doors = np.array([shapely.get_coordinates(d)[[0, -1]] for d in plan.doors]).reshape(-1, 2, 2)
    cuts, doorway = candidate_cuts(space, doors, tolerance, 2 * radius)
    faces = arrangement(space, cuts, doorway, doors)
    regions = Regions(faces, Limits(1.0 - tolerance, 1.0 - tolerance, GATE, THROUGH))
    rng = np.random.default_rng(seed)
    for k in range(runs):
        regions.merge(regions.single, rng, 0.0 if k == 0 else 0.05 * (1 + k % 4))
    chosen = partition(list(regions.pool.values()), len(faces), lambda r: cost(r, faces), 5.0)
    for _ in range(ROUNDS):
        before = len(regions.pool)
        for share in SHARES:
            broken = rng.random(len(chosen)) < share
            start = [part for r, b in zip(chosen, broken, strict=True) for part in ([regions.single[f] for f in sorted(r.faces)] if b else [r])]
            regions.merge(start, rng, 0.1)
        if len(regions.pool) == before:
            break
        chosen = partition(list(regions.pool.values()), len(faces), lambda r: cost(r, faces), 5.0)
    owner = np.empty(len(faces), dtype=np.intp)
    for k, region in enumerate(chosen):
        owner[list(region.faces)] = k
    cells = fit(plan.space, faces, owner, reach=3 * radius)
    return RoomCut(tuple(cells), ())


def cost(region: Region, faces: Faces) -> float:
    return 1.0 + W[0] * (1.0 - region.convexity) + W[1] * (1.0 - region.sight) + W[2] * region.open / np.sqrt(region.area)


def candidate_cuts(space: shapely.Geometry, doors: Array, tolerance: float, notch: float) -> tuple[Array, Array]:
    """Doorways, and in each part of the plan that these leave and that is not nearly convex every other sensible cut."""
    at = corners(space)
    segments, ends = necks(space, at, 6.0)
    if not len(segments):
        segments, ends = np.empty((0, 2, 2)), np.empty((0, 2), dtype=np.intp)
    chosen, clear = doorways(space, at, segments, ends)
    certain = segments[chosen[clear]]
    zones = arrangement(space, np.empty((0, 2, 2)), certain, doors)
    cuts: list[Array] = []
    rest = np.delete(np.arange(len(segments)), chosen[clear])
    maybe = segments[rest]
    factor = askew(space, maybe)
    length = np.hypot(*(maybe[:, 1] - maybe[:, 0]).T)
    useful = (factor < ASKEW) | _shortest(ends[rest], length, len(at)) if KEEP else factor < 9
    maybe, rank = maybe[useful], (factor * length)[useful]
    tree = shapely.STRtree(shapely.linestrings(maybe)) if len(maybe) else None
    for zone in zones.polygons[~zones.sill]:
        if zone.area >= (1.0 - 0.5 * tolerance) * zone.convex_hull.area and not zone.interiors:
            continue
        local = corners(zone)
        deep = {tuple(p) for p in corners(shapely.simplify(zone, notch)).points.tolist()}
        local = local[np.array([tuple(p) in deep for p in local.points.tolist()], dtype=bool)]
        if len(local) == 0:
            continue
        walls = Walls(ring_segments(zone))
        found = extensions(walls, local, 1e3)
        width = np.hypot(*(found[:, 1] - found[:, 0]).T)
        if tree is not None:
            inner = shapely.buffer(zone, 2 * GRID)
            k = np.sort(tree.query(inner, predicate="covers"))
            found, width = np.concatenate([found, maybe[k]]), np.concatenate([width, rank[k]])
        cuts += _distinct(list(found[np.argsort(width.round(3), kind="stable")]))
    return np.array(cuts).reshape(-1, 2, 2), certain


def _distinct(cuts: list[Array]) -> list[Array]:
    kept: list[Array] = []
    for s in cuts:
        if np.hypot(*(s[1] - s[0])) > 0.05 and not any(same_cut(s, o) for o in kept):
            kept.append(s)
    return kept


def _shortest(ends: NDArray[np.intp], length: Array, n: int) -> NDArray[np.bool_]:
    """Whether each neck is the shortest one at one of its corners."""
    least = np.full(n + 1, np.inf)
    for side in (0, 1):
        np.minimum.at(least, ends[:, side], length)
    least[-1] = 0.0
    return np.asarray((length[:, None] <= least[ends] + 1e-9).any(1))
