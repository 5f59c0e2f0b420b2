"""Cut a plan into few cells that look like rooms and hallways."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.rooms.cuts import ASKEW, askew, corners, distinct, doorways, extensions, necks, ring_segments
from discretize.rooms.faces import GRID, Faces, arrangement
from discretize.rooms.fitting import fit
from discretize.rooms.merging import Limits, Region, Regions, spread
from discretize.rooms.rays import Walls
from discretize.rooms.selection import partition
from discretize.rooms.structure import structure
from maps import FloorPlan

__all__ = ["RoomCut", "room_cells"]

Array = NDArray[np.float64]

GATE = 0.7
THROUGH = 0.4
SHARES = (0.0, 0.2, 0.2, 0.4, 0.4)
W = [1.0, 2.0, 0.15]
EFFORT = 6000
MANY = 10_000
SCANLIKE = True
CL = 4.0
DET = 1.0
ROUNDS = 2


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


def room_cells(plan: FloorPlan, *, tolerance: float = 0.1, seed: int = 0, radius: float = 0.2) -> RoomCut:
    scan = any(repair.kind == "removed furniture" for repair in plan.repairs)
    limits = Limits(1 - 2 * tolerance, 1 - 2 * tolerance, 0.6, 0.3) if scan else Limits(1 - tolerance, 1 - tolerance, 0.7, 0.4)
    tolerance = 1 - limits.convexity
    space = structure(plan.space, radius if scan else radius / 2, 4 * radius, 25 * radius if scan else 0.0)
    doors = np.array([shapely.get_coordinates(d)[[0, -1]] for d in plan.doors]).reshape(-1, 2, 2)
    cuts, doorway = candidate_cuts(space, doors, tolerance, 2 * radius)
    faces = arrangement(space, cuts, doorway, doors)
    regions = Regions(faces, limits)
    chosen, notes = search(regions, faces, tolerance, np.random.default_rng(seed))
    owner = np.empty(len(faces), dtype=np.intp)
    for k, region in enumerate(chosen):
        owner[list(region.faces)] = k
    owner = absorb(faces, owner, radius)
    return RoomCut(tuple(fit(plan.space, faces, owner, reach=3 * radius)), notes)


def search(
    regions: Regions, faces: Faces, tolerance: float, rng: np.random.Generator
) -> tuple[list[Region], tuple[str, ...]]:
    """Pool unions from many random merges and choose the best partition; then break parts of it and join again."""
    runs = int(np.clip(EFFORT // max(len(faces), 1), 2, 12))
    rounds = 0 if len(faces) > MANY else ROUNDS if runs > 2 else 1
    for k in range(runs):
        regions.merge(regions.single, rng, 0.0 if k == 0 else 0.05 * (1 + k % 4))
    sound = sees_itself(faces, 1.0 - tolerance)
    chosen = partition(list(regions.pool.values()), len(faces), cost, sound)
    for _ in range(rounds):
        before = len(regions.pool)
        for share in SHARES:
            start = []
            for region, broken in zip(chosen, rng.random(len(chosen)) < share, strict=True):
                start += [regions.single[face] for face in sorted(region.faces)] if broken else [region]
            regions.merge(start, rng, 0.1)
        if len(regions.pool) == before:
            break
        chosen = partition(list(regions.pool.values()), len(faces), cost, sound)
    notes = () if runs == 12 else (f"{runs} randomised merges instead of 12, because the plan has {len(faces)} faces.",)
    return chosen, notes


def cost(region: Region) -> float:
    """Return what a cell costs: one, and more the less convex it is and the more of its outline had to be cut."""
    return (
        1.0 + W[0] * (1.0 - region.convexity) + W[1] * (1.0 - region.sight) + W[2] * region.open / np.sqrt(region.area)
    )


def sees_itself(faces: Faces, least: float) -> Callable[[Region], bool]:
    """Return a test whether enough pairs of points of a region see each other."""
    known: dict[frozenset[int], bool] = {}

    def sound(region: Region) -> bool:
        if region.convexity > 1.0 - 0.2 * (1.0 - least):
            return True
        if region.faces not in known:
            polygon = shapely.coverage_union_all(faces.polygons[list(region.faces)])
            known[region.faces] = mutual_sight(polygon) >= least + 0.1 * (1.0 - least)
        return known[region.faces]

    return sound


def mutual_sight(polygon: shapely.Polygon, n: int = 48) -> float:
    """Return the share of pairs of points of a polygon that see each other."""
    points = spread(polygon, n)
    i, j = np.triu_indices(len(points), 1)
    shapely.prepare(polygon)
    return float(shapely.covers(polygon, shapely.linestrings(np.stack([points[i], points[j]], axis=1))).mean())


def absorb(faces: Faces, owner: NDArray[np.intp], radius: float) -> NDArray[np.intp]:
    """Give every cell that is too small for a robot to its best neighbour, the smallest first."""
    owner = owner.copy()
    near: dict[int, dict[int, float]] = {}
    for (i, j), border in faces.borders.items():
        a, b = int(owner[i]), int(owner[j])
        if a != b and (i, j) not in faces.barred:
            length = border.length - 0.75 * border.door
            near.setdefault(a, {})[b] = near.get(a, {}).get(b, 0.0) + length
            near.setdefault(b, {})[a] = near[a][b]
    shapes = [shapely.coverage_union_all(faces.polygons[owner == k]) for k in range(owner.max() + 1)]
    small = [k for k, s in enumerate(shapes) if s.area < (4 * radius) ** 2 or shapely.buffer(s, -1.5 * radius).is_empty]
    for k in sorted(small, key=lambda k: shapes[k].area):
        if not near.get(k):
            continue
        target = max(near[k], key=lambda other: (near[k][other], shapes[other].area))
        owner[owner == k] = target
        for other, length in near.pop(k).items():
            near[other].pop(k, None)
            if other != target:
                near[target][other] = near[other][target] = near[target].get(other, 0.0) + length
    _, owner = np.unique(owner, return_inverse=True)
    return owner


def candidate_cuts(space: shapely.Geometry, doors: Array, tolerance: float, notch: float) -> tuple[Array, Array]:
    """Doorways, and in each part of the plan that these leave and that is not nearly convex every other sensible cut."""
    at = corners(space)
    segments, ends = necks(space, at, 6.0)
    chosen, clear = doorways(space, at, segments, ends)
    certain = segments[chosen[clear]]
    zones = arrangement(space, np.empty((0, 2, 2)), certain, doors)
    cuts: list[Array] = []
    rest = np.delete(np.arange(len(segments)), chosen[clear])
    maybe = segments[rest]
    factor = askew(space, maybe)
    length = np.hypot(*(maybe[:, 1] - maybe[:, 0]).T)
    useful = (factor < ASKEW) | _shortest(ends[rest], length, len(at))
    maybe, rank = maybe[useful], (factor * length)[useful]
    tree = shapely.STRtree(shapely.linestrings(maybe))
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
        inner = shapely.buffer(zone, 2 * GRID)
        k = np.sort(tree.query(inner, predicate="covers"))
        found, width = np.concatenate([found, maybe[k]]), np.concatenate([width, rank[k]])
        cuts += list(distinct(found[np.argsort(width.round(3), kind="stable")]))
    return np.array(cuts).reshape(-1, 2, 2), certain


def _shortest(ends: NDArray[np.intp], length: Array, n: int) -> NDArray[np.bool_]:
    """Whether each neck is the shortest one at one of its corners."""
    least = np.full(n + 1, np.inf)
    for side in (0, 1):
        np.minimum.at(least, ends[:, side], length)
    least[-1] = 0.0
    return np.asarray((length[:, None] <= least[ends] + 1e-9).any(1))
