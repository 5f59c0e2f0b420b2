"""Rays from the reflex corners of free space, and the pieces into which they cut it."""

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.sharing import segment_tree
from maps import FloorPlan

__all__ = ["NOTHING", "arrangement", "cross", "extension_rays", "reflex_corners", "shoot"]

_OVER = 1e-6
"""Rays go this far into the walls that they hit, so that they cut through to them, metres."""

NOTHING = 1e-9
"""Lengths below this are rounding: a piece thinner than this lies between two copies of one ray, metres."""


def extension_rays(plan: FloorPlan, doors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Find the rays that extend walls past reflex corners.

    Parameters
    ----------
    plan : FloorPlan
        Free space.
    doors : ndarray, shape (k, 2, 2)
        Segments at which rays end as they do at walls, metres.

    Returns
    -------
    ndarray, shape (k, 2, 2)
        From a reflex corner to the wall that the ray hits, metres.
    """
    corner, before, after = reflex_corners(plan)
    walls = np.concatenate([plan.walls, doors])
    return shoot(np.concatenate([corner, corner]), np.concatenate([corner - before, corner - after]), walls)


def reflex_corners(plan: FloorPlan) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Reflex corners with the corners before and after them, each of shape (k, 2)."""
    rows = []
    for ring in shapely.get_rings(shapely.orient_polygons(np.array(plan.parts, dtype=object))):
        xy = shapely.get_coordinates(ring)[:-1]
        rows.append(np.stack([xy, np.roll(xy, 1, axis=0), np.roll(xy, -1, axis=0)]))
    corner, before, after = np.concatenate(rows, axis=1)
    reflex = cross(corner - before, after - corner) < -NOTHING
    return corner[reflex], before[reflex], after[reflex]


def shoot(origin: NDArray[np.float64], way: NDArray[np.float64], walls: NDArray[np.float64]) -> NDArray[np.float64]:
    """Follow rays until they hit a wall, looking ever further ahead.

    Parameters
    ----------
    origin, way : ndarray, shape (k, 2)
        Where each ray begins and in which direction it goes, metres.
    walls : ndarray, shape (W, 2, 2)
        Wall segments, metres.

    Returns
    -------
    ndarray, shape (m, 2, 2)
        From origin to the wall, in order; one for each origin and direction.
    """
    way = way / np.hypot(*way.T)[:, None]
    _, first = np.unique(np.round(np.concatenate([origin, way], axis=1), 9), axis=0, return_index=True)
    origin, way = origin[np.sort(first)], way[np.sort(first)]
    tree = segment_tree(walls)
    span = walls[:, 1] - walls[:, 0]
    end = np.full(len(origin), np.inf)
    reach, todo = 4.0, np.arange(len(origin))
    while len(todo) and reach < 1e6:
        lines = np.stack([origin[todo], origin[todo] + way[todo] * reach], axis=1)
        which, wall = tree.query(shapely.linestrings(lines))
        k = todo[which]
        beside = walls[wall, 0] - origin[k]
        slope = cross(way[k], span[wall])
        with np.errstate(divide="ignore", invalid="ignore"):
            ahead, along = cross(beside, span[wall]) / slope, cross(beside, way[k]) / slope
        hit = (np.abs(slope) > NOTHING) & (ahead > _OVER) & (along > -NOTHING) & (along < 1 + NOTHING)
        np.minimum.at(end, k[hit], ahead[hit])
        todo = todo[end[todo] > reach]
        reach *= 4
    found = np.isfinite(end)
    return np.stack([origin[found], origin[found] + way[found] * (end[found, None] + _OVER)], axis=1)


def arrangement(plan: FloorPlan, rays: NDArray[np.float64]) -> list[shapely.Polygon]:
    """Cut free space along rays and doors.

    Parameters
    ----------
    plan : FloorPlan
        Free space and doors.
    rays : ndarray, shape (k, 2, 2)
        As :func:`shoot` gives them.
    """
    space = shapely.set_precision(plan.space, 0)
    doors = [shapely.set_precision(door, 0) for door in plan.doors]
    lines = [*shapely.get_rings(shapely.get_parts(space)), *(shapely.LineString(ray) for ray in rays), *doors]
    faces = shapely.get_parts(shapely.polygonize(list(shapely.get_parts(shapely.union_all(lines)))))
    shapely.prepare(space)
    inside = shapely.contains_properly(space, shapely.point_on_surface(faces))
    thick = shapely.area(faces) > NOTHING * shapely.length(faces)
    return [face for face in faces[inside & thick] if isinstance(face, shapely.Polygon)]


def cross(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Cross product of vectors of the plane, shape (..., 2)."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
