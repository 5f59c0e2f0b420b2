"""What a robot sees: the exact visibility polygon, within a range and a field of view."""

import numpy as np
import shapely
from numpy.typing import NDArray

from maps import FloorPlan

__all__ = ["Walls"]

# Rays at least this close, so that a circle of sight looks round.
_ARC_STEP = np.radians(2.0)

_ALL_AROUND = 2 * np.pi - 1e-9


class Walls:
    """The walls of a plan, ready to be seen from many places.

    Parameters
    ----------
    plan : FloorPlan
        Its free space is to the left of every wall segment.
    """

    def __init__(self, plan: FloorPlan) -> None:
        segments = _free_on_the_left(plan)
        self._start, self._end = segments[:, 0], segments[:, 1]
        along = self._end - self._start
        length = np.hypot(*along.T)
        self._normal = np.stack([-along[:, 1], along[:, 0]], axis=1) / length[:, None]
        self._offset = np.einsum("ij,ij->i", self._normal, self._start)
        x0, y0, x1, y1 = plan.bounds
        self._reach = 2.0 * float(np.hypot(x1 - x0, y1 - y0)) + 1.0

    def seen_from(
        self, eye: NDArray[np.float64], reach: float = np.inf, heading: float = 0.0, field: float = 2 * np.pi
    ) -> NDArray[np.float64]:
        """Return the polygon that is seen.

        Between two neighbouring wall corners, in angle around the eye, one and the same wall is nearest. So it is
        enough to find for each such interval the nearest of the walls that span it, which takes as many steps as
        rays cross walls; nothing is sampled.

        Parameters
        ----------
        eye : ndarray, shape (2,)
            Within the free space, in no corner of it, metres.
        reach : float
            How far it sees, metres.
        heading : float
            Middle of the field of view, radians.
        field : float
            Width of the field of view, radians.

        Returns
        -------
        ndarray, shape (k, 2)
            Corners counterclockwise; a circle of sight has one every two degrees at least.
        """
        limit = min(reach, self._reach)
        distance = self._normal @ eye - self._offset
        facing = distance > -1e-9
        start, end = self._start[facing] - eye, self._end[facing] - eye
        normal, distance = -self._normal[facing], np.maximum(distance[facing], 1e-9)
        first, last = np.arctan2(start[:, 1], start[:, 0]), np.arctan2(end[:, 1], end[:, 0])
        span = (last - first) % (2 * np.pi)
        # A wall seen edge-on spans nothing; rounding may make that a whole turn less a little.
        kept = (span > 0) & (span < np.pi + 1e-6) & (distance < limit)
        normal, distance, first, last, span = (a[kept] for a in (normal, distance, first, last, span))

        extra = _extra_angles(normal, distance, reach if reach < self._reach else None, heading, field)
        angles = np.unique(np.concatenate([first, last, extra]))
        width = np.diff(angles, append=angles[:1] + 2 * np.pi)
        middle = angles + width / 2
        count = len(angles)

        low, high = np.searchsorted(angles, first), np.searchsorted(angles, last)
        crossed = (high - low) % count
        wall = np.repeat(np.arange(len(first)), crossed)
        step = np.arange(len(wall)) - np.repeat(np.cumsum(crossed) - crossed, crossed)
        interval = (low[wall] + step) % count

        # Nearness, one over the distance along a ray, is linear in the ray's direction, finite even along a wall.
        slope = normal / distance[:, None]
        nearness = slope[wall, 0] * np.cos(middle)[interval] + slope[wall, 1] * np.sin(middle)[interval]
        nearest = np.full(count, 1.0 / limit)
        np.maximum.at(nearest, interval, nearness)
        winner = np.full(count, -1)
        won = nearness == nearest[interval]
        winner[interval[won]] = wall[won]
        seen: NDArray[np.float64] = eye + _outline(angles, middle, winner, slope, limit, heading, field)
        return seen


def _extra_angles(
    normal: NDArray[np.float64], distance: NDArray[np.float64], reach: float | None, heading: float, field: float
) -> NDArray[np.float64]:
    """Where something begins that is no wall corner: an arc, a wall's end of range, the field of view."""
    extra = []
    if reach is not None:
        foot = np.arctan2(normal[:, 1], normal[:, 0])
        half = np.arccos(np.clip(distance / reach, 0, 1))
        extra += [np.arange(-np.pi, np.pi, _ARC_STEP), foot - half, foot + half]
    if field < _ALL_AROUND:
        extra.append(heading + np.array([-field / 2, field / 2]))
    angles = np.concatenate(extra) if extra else np.empty(0)
    turned: NDArray[np.float64] = np.arctan2(np.sin(angles), np.cos(angles))
    return turned


def _outline(
    angles: NDArray[np.float64],
    middle: NDArray[np.float64],
    winner: NDArray[np.intp],
    slope: NDArray[np.float64],
    limit: float,
    heading: float,
    field: float,
) -> NDArray[np.float64]:
    """Join what is nearest in each interval, once for neighbours in which it is the same wall."""
    following = np.append(angles[1:], angles[0])
    if field < _ALL_AROUND:
        turned = (middle - (heading - field / 2)) % (2 * np.pi)
        order = np.argsort(turned, kind="stable")
        inside = order[turned[order] < field]
        angles, following, winner = angles[inside], following[inside], winner[inside]
    begins = np.flatnonzero(np.append(True, winner[1:] != winner[:-1]) | (winner < 0))
    ends = np.append(begins[1:], len(winner)) - 1
    lines = np.vstack([slope, [[0.0, 0.0]]])[winner[begins]]  # the last line, of no wall, is for winner -1
    corners = []
    for angle in (angles[begins], following[ends]):
        x, y = np.cos(angle), np.sin(angle)
        far = 1.0 / np.maximum(lines[:, 0] * x + lines[:, 1] * y, 1.0 / limit)
        corners.append(np.stack([x * far, y * far], axis=1))
    points: NDArray[np.float64] = np.stack(corners, axis=1).reshape(-1, 2)
    return points if field >= _ALL_AROUND else np.vstack([[[0.0, 0.0]], points])


def _free_on_the_left(plan: FloorPlan) -> NDArray[np.float64]:
    """Return the wall segments, shape (W, 2, 2), each with the free space to its left."""
    rings = shapely.get_rings(shapely.get_parts(shapely.orient_polygons(plan.space)))
    coords, ring = shapely.get_coordinates(rings, return_index=True)
    follows = ring[1:] == ring[:-1]
    return np.stack([coords[:-1][follows], coords[1:][follows]], axis=1)
