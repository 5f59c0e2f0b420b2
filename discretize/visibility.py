"""Conservative visibility cells: within one of them what can be seen never changes in kind.

S. M. LaValle, D. Lin, L. J. Guibas, J.-C. Latombe and R. Motwani, Finding an unpredictable target in a workspace with
obstacles, 1997: free space is cut along rays that extend walls past reflex corners, and rays that extend the lines
tangent to two reflex corners that see each other beyond both. There are far more of these cells than rooms.
"""

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.errors import DiscretizeError
from discretize.rays import NOTHING, arrangement, cross, reflex_corners, shoot
from discretize.sight import Sight
from maps import FloorPlan

__all__ = ["visibility_cells", "visibility_count", "visibility_rays"]

_LARGEST = 50_000
"""Most cells that are made."""

_PAIRS = 1_000_000
"""So many pairs of rays tell how often rays cross, where there are too many to cut along all."""


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
    return arrangement(plan, rays)


def visibility_count(plan: FloorPlan) -> int:
    """Count conservative visibility cells: exactly up to 50,000, beyond that from how often a sample of rays cross.

    Parameters
    ----------
    plan : FloorPlan
        Free space and doors.
    """
    rays = visibility_rays(plan)
    count = _estimate(plan, rays)
    return count if count > _LARGEST else len(arrangement(plan, rays))


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
    corner, before, after = reflex_corners(plan)
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
    return shoot(np.concatenate(origins), np.concatenate(ways), plan.walls)


def _tangent(
    start: NDArray[np.float64], corner: NDArray[np.float64], before: NDArray[np.float64], after: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Tell whether the line from start over a corner has both walls of the corner on one side."""
    way = corner - start
    return np.asarray(cross(way, before - corner) * cross(way, after - corner) >= -NOTHING)


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
    first, second = (cross(way, others[:, k] - lines[:, 0]) for k in (0, 1))
    return np.asarray(first * second < 0)
