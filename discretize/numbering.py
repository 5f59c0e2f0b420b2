"""Which cell gets which number and name."""

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from maps import Label

__all__ = ["ignored_numbers", "number_cells"]

_BESIDE = 0.01
"""A label this near to a cell lies in it, metres."""


def number_cells(
    cells: Sequence[shapely.Polygon], labels: Sequence[Label]
) -> tuple[list[shapely.Polygon], tuple[str, ...]]:
    """Put cells in order and name them.

    Where labels carry the numbers 1 to N and hit every one of the N cells once, cells have these numbers. Otherwise
    they are read like a page: in rows from top to bottom, in a row from left to right. A row ends where a centroid lies
    more than half the median height of a cell below its first one.

    Parameters
    ----------
    cells : sequence of shapely.Polygon
        N cells, metres.
    labels : sequence of Label
        What the source has. Where several names lie in one cell the first counts.

    Returns
    -------
    cells : list of shapely.Polygon
        The same in their order.
    names : tuple of str
        One for each, empty where there is none.
    """
    hits = _hits(cells, labels)
    placed = [(label, cell) for label, cell in zip(labels, hits, strict=True) if cell < len(cells)]
    numbers = [(label.number, cell) for label, cell in placed if label.number is not None]
    if sorted(n for n, _ in numbers) == list(range(1, len(cells) + 1)) and len({c for _, c in numbers}) == len(cells):
        order = [cell for _, cell in sorted(numbers)]
    else:
        order = _reading_order(cells)
    names: dict[int, str] = {}
    for label, cell in placed:
        if label.name:
            names.setdefault(cell, label.name)
    return [cells[k] for k in order], tuple(names.get(k, "") for k in order)


def ignored_numbers(cells: Sequence[shapely.Polygon], labels: Sequence[Label]) -> tuple[str, ...]:
    """Say in one sentence why cells have other numbers than the labels in them; nothing if they have the same.

    Parameters
    ----------
    cells : sequence of shapely.Polygon
        N cells in their order, metres.
    labels : sequence of Label
        What the source has.
    """
    found: dict[int, int] = {}
    twice: list[tuple[int, int]] = []
    same = True
    for label, cell in zip(labels, _hits(cells, labels), strict=True):
        if label.number is not None:
            same &= label.number == cell + 1
            twice += [(found[cell], label.number)] if cell in found else []
            if cell < len(cells):
                found.setdefault(cell, label.number)
    if same:
        return ()
    numbers = sorted(label.number for label in labels if label.number is not None)
    if twice:
        why = f"{twice[0][0]} and {twice[0][1]} lie in one cell"
    else:
        why = f"there are {len(cells)} cells, and the plan numbers {len(numbers)} from {numbers[0]} to {numbers[-1]}"
    return (f"Room numbers that the plan gives are not those of the cells: {why}.",)


def _hits(cells: Sequence[shapely.Polygon], labels: Sequence[Label]) -> list[int]:
    """Cell in which each label lies, on a boundary the first; N for a label that lies in none."""
    if not labels:
        return []
    tree = shapely.STRtree(list(cells))
    points = shapely.points([label.point for label in labels])
    which, cell = tree.query_nearest(points, max_distance=_BESIDE)
    found: NDArray[np.intp] = np.full(len(labels), len(cells), dtype=np.intp)
    np.minimum.at(found, which, cell)
    return [int(k) for k in found]


def _reading_order(cells: Sequence[shapely.Polygon]) -> list[int]:
    shapes = np.array(cells, dtype=object)
    x, y = np.round(shapely.get_coordinates(shapely.centroid(shapes)), 3).T
    bounds = np.round(shapely.bounds(shapes), 3)
    height = float(np.median(bounds[:, 3] - bounds[:, 1]))
    row = np.zeros(len(cells), dtype=np.intp)
    count, top = -1, np.inf
    for k in np.argsort(-y, kind="stable").tolist():
        if y[k] < top - height / 2:
            count, top = count + 1, y[k]
        row[k] = count
    return [int(k) for k in np.lexsort((*bounds.T, -y, x, row))]
