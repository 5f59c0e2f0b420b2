"""Conservative visibility cells: within one of them what can be seen never changes in kind.

S. M. LaValle, D. Lin, L. J. Guibas, J.-C. Latombe and R. Motwani, Finding an unpredictable target in a workspace with
obstacles, 1997: free space is cut along rays that extend walls past reflex corners, and rays that extend the lines
tangent to two reflex corners that see each other beyond both. There are far more of these cells than rooms.
"""

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.errors import DiscretizeError
from discretize.sharing import segment_tree
from discretize.sight import Sight
from maps import FloorPlan

__all__ = ["visibility_cells", "visibility_count", "visibility_rays"]

_LARGEST = 20_000
"""Most cells that are made."""

_PAIRS = 1_000_000
"""So many pairs of rays tell how often rays cross, where there are too many to cut along all."""

_OVER = 1e-6
"""Rays go this far into the walls that they hit, so that they cut through to them, metres."""

_SLIVER = 1e-9
"""A piece thinner than this lies between two copies of one ray, metres."""


def visibility_cells(plan: FloorPlan) -> list[shapely.Polygon]:
    """Cut free space into conservative visibility cells; doors are cut along, too.

    Parameters
    ----------
    plan : FloorPlan
        Free space and doors.

    Raises
    ------
    DiscretizeError
        If there are too many; the message says how many.
    """
    rays = visibility_rays(plan)
    if (count := _estimate(plan, rays)) > _LARGEST:
        raise DiscretizeError(
            f"Plan {plan.name!r} has about {count} visibility cells; they are made up to {_LARGEST}. "
            f"Method 'exact' makes far fewer."
        )
    return _faces(plan, rays)


def visibility_count(plan: FloorPlan) -> int:
    """Count conservative visibility cells: exactly up to 20,000, beyond that from how often a sample of rays cross.

    Parameters
    ----------
    plan : FloorPlan
        Free space and doors.
    """
    rays = visibility_rays(plan)
    count = _estimate(plan, rays)
    return count if count > _LARGEST else len(_faces(plan, rays))


def visibility_rays(plan: FloorPlan) -> NDArray[np.float64]:
    """Find the rays along which visibility cells meet.

    Parameters
    ----------
    plan : FloorPlan
        Free space.

    Returns
    -------
    ndarray, shape (k, 2, 2)
        From a reflex corner to the wall that the ray hits, metres.
    """
    corner, before, after = _reflex_corners(plan)
    if not len(corner):
        return np.empty((0, 2, 2))
    origins, ways = [corner, corner], [corner - before, corner - after]
    sight = Sight(plan)
    for k in range(len(corner) - 1):
        rest = slice(k + 1, None)
        tangent = _tangent(corner[k], corner[rest], before[rest], after[rest])
        tangent &= _tangent(corner[rest], corner[k], before[k], after[k])
        tangent &= (corner[rest] != corner[k]).any(axis=1)  # corners of two rings that touch
        other = corner[rest][tangent]
        other = other[sight.between(np.broadcast_to(corner[k], other.shape), other)]
        origins += [other, np.broadcast_to(corner[k], other.shape)]
        ways += [other - corner[k], corner[k] - other]
    origin, way = np.concatenate(origins), np.concatenate(ways)
    way /= np.hypot(*way.T)[:, None]
    _, once = np.unique(np.round(np.concatenate([origin, way], axis=1), 9), axis=0, return_index=True)
    return _shoot(origin[np.sort(once)], way[np.sort(once)], plan.walls)


def _reflex_corners(plan: FloorPlan) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Reflex corners with the corners before and after them, each of shape (k, 2)."""
    rows = []
    for ring in shapely.get_rings(shapely.orient_polygons(np.array(plan.parts, dtype=object))):
        xy = shapely.get_coordinates(ring)[:-1]
        rows.append(np.stack([xy, np.roll(xy, 1, axis=0), np.roll(xy, -1, axis=0)]))
    corner, before, after = np.concatenate(rows, axis=1)
    reflex = _cross(corner - before, after - corner) < -_SLIVER
    return corner[reflex], before[reflex], after[reflex]


def _tangent(
    start: NDArray[np.float64], corner: NDArray[np.float64], before: NDArray[np.float64], after: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Tell whether the line from start over a corner has both walls of the corner on one side."""
    way = corner - start
    return np.asarray(_cross(way, before - corner) * _cross(way, after - corner) >= -_SLIVER)


def _shoot(origin: NDArray[np.float64], way: NDArray[np.float64], walls: NDArray[np.float64]) -> NDArray[np.float64]:
    """Follow rays until they hit a wall, looking ever further ahead."""
    tree = segment_tree(walls)
    span = walls[:, 1] - walls[:, 0]
    end = np.full(len(origin), np.inf)
    reach, todo = 4.0, np.arange(len(origin))
    while len(todo) and reach < 1e6:
        lines = np.stack([origin[todo], origin[todo] + way[todo] * reach], axis=1)
        which, wall = tree.query(shapely.linestrings(lines))
        k = todo[which]
        beside = walls[wall, 0] - origin[k]
        slope = _cross(way[k], span[wall])
        with np.errstate(divide="ignore", invalid="ignore"):
            ahead, along = _cross(beside, span[wall]) / slope, _cross(beside, way[k]) / slope
        hit = (np.abs(slope) > _SLIVER) & (ahead > _OVER) & (along > -_SLIVER) & (along < 1 + _SLIVER)
        np.minimum.at(end, k[hit], ahead[hit])
        todo = todo[end[todo] > reach]
        reach *= 4
    found = np.isfinite(end)
    return np.stack([origin[found], origin[found] + way[found] * (end[found, None] + _OVER)], axis=1)


def _estimate(plan: FloorPlan, rays: NDArray[np.float64]) -> int:
    """Count cells by Euler's formula from how many pairs of a sample of rays cross."""
    n = len(rays)
    if n < 2:
        return len(plan.parts) + n
    i, j = np.random.default_rng(0).integers(0, n, (2, _PAIRS))
    a, b = rays[i[i != j]], rays[j[i != j]]
    crossed = _apart(a, b) & _apart(b, a)
    holes = sum(len(part.interiors) for part in plan.parts)
    return max(len(plan.parts) - holes + n + round(float(crossed.mean()) * n * (n - 1) / 2), len(plan.parts))


def _apart(lines: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Tell whether each line keeps the ends of the other segment apart."""
    way = lines[:, 1] - lines[:, 0]
    first, second = (_cross(way, others[:, k] - lines[:, 0]) for k in (0, 1))
    return np.asarray(first * second < 0)


def _faces(plan: FloorPlan, rays: NDArray[np.float64]) -> list[shapely.Polygon]:
    """Pieces of free space between rays, doors and walls."""
    space = shapely.set_precision(plan.space, 0)
    doors = [shapely.set_precision(door, 0) for door in plan.doors]
    lines = [*shapely.get_rings(shapely.get_parts(space)), *(shapely.LineString(ray) for ray in rays), *doors]
    faces = shapely.get_parts(shapely.polygonize(list(shapely.get_parts(shapely.union_all(lines)))))
    shapely.prepare(space)
    inside = shapely.contains_properly(space, shapely.point_on_surface(faces))
    thick = shapely.area(faces) > _SLIVER * shapely.length(faces)
    return [face for face in faces[inside & thick] if isinstance(face, shapely.Polygon)]


def _cross(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
