"""The search for the best partition: many random merges pooled, an exact choice, and repair by breaking and joining."""

from collections.abc import Callable
from statistics import NormalDist

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from discretize.rooms.faces import Faces
from discretize.rooms.merging import Limits, Region, Regions, spread
from discretize.rooms.selection import partition
from discretize.rooms.shaking import Field

__all__ = ["best_partition", "mutual_sight"]

RUNS = 24  # randomised merges of a small plan
EFFORT = 10_000  # faces times merges; larger plans get fewer merges
MANY = 10_000  # faces; a plan with more is merged once and not improved any further
SHARES = (0.0, 0.2, 0.2, 0.4, 0.4)  # of the cells that are broken before the merges that improve a partition
ROUNDS = 3
MARGIN = 0.3  # share of what sight may lack that estimates of it keep clear of
CONVEX, SIGHT, OPEN = 1.0, 2.0, 0.15  # weights in the cost of a cell, beside 1 for being one


def best_partition(faces: Faces, limits: Limits, rng: np.random.Generator) -> tuple[list[Region], tuple[str, ...]]:
    """Join faces to as few and as good regions as possible.

    Parameters
    ----------
    faces : Faces
        What to join.
    limits : Limits
        What a region may look like.
    rng : numpy.random.Generator
        For the order of merges.

    Returns
    -------
    regions : list of Region
        They cover every face once.
    notes : tuple of str
        What was done less thoroughly than usual.
    """
    regions = Regions(faces, limits)
    runs = int(np.clip(EFFORT // max(len(faces), 1), 2 if len(faces) <= MANY else 1, RUNS))
    for k in range(runs):
        regions.merge(regions.single, rng, 0.0 if k == 0 else 0.05 * (1 + k % 4))
    sound = _sees_itself(faces, limits.sight)
    chosen = partition(list(regions.pool.values()), len(faces), _cost, sound)
    rounds = 0 if len(faces) > MANY else 1 if runs == 2 else ROUNDS
    for _ in range(rounds):
        before = len(regions.pool)
        for share in SHARES:
            start = []
            luck = Field(rng)(np.array([region.points.mean(axis=0) for region in chosen]))
            for region, broken in zip(chosen, [NormalDist().cdf(x) < share for x in luck.tolist()], strict=True):
                start += [regions.single[face] for face in sorted(region.faces)] if broken else [region]
            regions.merge(start, rng, 0.1)
        if len(regions.pool) == before:
            break
        chosen = partition(list(regions.pool.values()), len(faces), _cost, sound)
    if runs == RUNS:
        return chosen, ()
    told = f"{runs} randomised merge{'s' * (runs > 1)} instead of {RUNS}"
    return chosen, (f"{told}, because the plan falls into {len(faces)} faces.",)


def _cost(region: Region) -> float:
    """Return what a cell costs: one, and more the less convex it is and the more of its outline had to be cut."""
    cut = region.open / np.sqrt(region.area)
    return float(1.0 + CONVEX * (1.0 - region.convexity) + SIGHT * (1.0 - region.sight) + OPEN * cut)


def _sees_itself(faces: Faces, least: float) -> Callable[[Region], bool]:
    """Return a test whether enough pairs of points of a region see each other; each region is looked at once."""
    known: dict[frozenset[int], bool] = {}

    def sound(region: Region) -> bool:
        if region.convexity > 1.0 - 0.2 * (1.0 - least):
            return True
        if region.faces not in known:
            polygon = shapely.coverage_union_all(faces.polygons[sorted(region.faces)])
            known[region.faces] = mutual_sight(polygon) >= least + MARGIN * (1.0 - least)
        return known[region.faces]

    return sound


def mutual_sight(polygon: BaseGeometry, n: int = 48) -> float:
    """Return the share of pairs of points of a polygon, ``n`` spread evenly, that see each other inside it."""
    points = spread(polygon, n)
    i, j = np.triu_indices(len(points), 1)
    if len(i) == 0:
        return 1.0
    shapely.prepare(polygon)
    return float(shapely.covers(polygon, shapely.linestrings(np.stack([points[i], points[j]], axis=1))).mean())
