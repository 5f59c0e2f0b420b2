"""Cells that a body can enter from two sides but not cross are two cells."""

from collections.abc import Iterator, Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.reach import Reach

__all__ = ["split_bottlenecks"]

_SHORT = 2.02
"""Longest chord, in radii, between two walls through which a body does not pass: its diameter and a hair."""


def split_bottlenecks(cells: Sequence[shapely.Polygon], reach: Reach) -> list[shapely.Polygon]:
    """Split cells along chords on which the body's centre cannot be, where it can be on both sides.

    So the graph joins only what the body can join, and its routes stay in their cells. Convex cells stay convex.

    Parameters
    ----------
    cells : sequence of shapely.Polygon
        Simple polygons, metres.
    reach : Reach
        Where the body's centre can be.
    """
    done: list[shapely.Polygon] = []
    todo = list(cells)[::-1]
    while todo:
        halves = _halves(todo.pop(), reach)
        (done if len(halves) == 1 else todo).extend(halves)
    return done


def _halves(cell: shapely.Polygon, reach: Reach) -> list[shapely.Polygon]:
    """Both sides of the shortest chord that parts the body's places in a cell, or the cell itself."""
    xy = shapely.get_coordinates(cell)[:-1]
    chords = sorted(_chords(xy, _SHORT * reach.radius), key=lambda chord: chord[0])
    if not chords:
        return [cell]
    inside = [place.representative_point() for place in shapely.get_parts(reach.within(cell)) if place.area > 0]
    for _, i, j, end in chords if len(inside) > 1 else ():
        turn = np.roll(xy, -i, axis=0)
        k = (j - i) % len(xy)
        halves = [shapely.Polygon([*turn[: k + 1], end]), shapely.Polygon([turn[0], end, *turn[k + 1 :]])]
        whole = all(half.is_valid for half in halves) and abs(sum(half.area for half in halves) - cell.area) < 1e-9
        parted = len({halves[0].contains(point) for point in inside}) == 2
        if whole and parted and not shapely.intersects(reach.area, shapely.LineString([turn[0], end])):
            return halves
    return [cell]


def _chords(xy: NDArray[np.float64], longest: float) -> Iterator[tuple[float, int, int, NDArray[np.float64]]]:
    """Chords from a vertex to another or square to an edge: length, vertex, edge at the other end, that end."""
    n = len(xy)
    span = np.roll(xy, -1, axis=0) - xy
    beside = xy[:, None] - xy[None]
    with np.errstate(invalid="ignore", divide="ignore"):
        along = (beside * span).sum(axis=2) / (span * span).sum(axis=1)
    for foot in (np.zeros((n, n)), np.where((along > 0) & (along < 1), along, np.nan)):
        ends = xy + foot[..., None] * span
        length = np.hypot(*(ends - xy[:, None]).transpose(2, 0, 1))
        for i, j in np.argwhere(length < longest).tolist():
            ahead = (j - i) % n
            if ahead + (foot[i, j] > 0) > 1 and 0 < ahead < n - 1:
                yield float(length[i, j]), i, j, ends[i, j]
