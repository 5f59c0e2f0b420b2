"""Which cell gets which number and name."""

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from maps import Label

__all__ = ["number_cells"]


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
    numbers = [(label.number, cell) for label, cell in zip(labels, hits, strict=True) if label.number is not None]
    if sorted(n for n, _ in numbers) == list(range(1, len(cells) + 1)) and len({c for _, c in numbers}) == len(cells):
        order = [cell for _, cell in sorted(numbers)]
    else:
        order = _reading_order(cells)
    names: dict[int, str] = {}
    for label, cell in zip(labels, hits, strict=True):
        if label.name:
            names.setdefault(cell, label.name)
    return [cells[k] for k in order], tuple(names.get(k, "") for k in order)


def _hits(cells: Sequence[shapely.Polygon], labels: Sequence[Label]) -> list[int]:
    """Cell in which each label lies; on a boundary the first, outside of all the nearest."""
    if not labels:
        return []
    tree = shapely.STRtree(list(cells))
    which, cell = tree.query_nearest(shapely.points([label.point for label in labels]), all_matches=True)
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
