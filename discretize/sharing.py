"""The straight segments along which cells touch."""

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

__all__ = ["points_of", "segment_tree", "shared_segments"]

_CLOSE = 1e-6
"""Edges this near to each other are the same, and segments shorter than this are none, metres."""


def shared_segments(cells: Sequence[shapely.Polygon]) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Find every straight segment that lies on the boundary of two cells.

    Cells may have vertices where their neighbours have none.

    Parameters
    ----------
    cells : sequence of shapely.Polygon
        N simple polygons that do not overlap, metres.

    Returns
    -------
    pairs : ndarray, shape (k, 2)
        The two cells, the smaller first, in rising order; a pair is there as often as it shares a segment.
    segments : ndarray, shape (k, 2, 2)
        The first cell lies left of its segment.
    """
    rings, owner = _rings(cells)
    xy, ring = shapely.get_coordinates(rings, return_index=True)
    follows = ring[1:] == ring[:-1]
    edges = np.stack([xy[:-1][follows], xy[1:][follows]], axis=1)
    owner = owner[ring[:-1][follows]]
    tree = segment_tree(edges)
    i, j = tree.query(tree.geometries, predicate="dwithin", distance=_CLOSE)
    ahead = owner[i] < owner[j]
    i, j = i[ahead], j[ahead]
    span = edges[i, 1] - edges[i, 0]
    length = np.hypot(*span.T)
    unit = span / length[:, None]
    beside = edges[j] - edges[i, None, 0]
    along = np.einsum("kpc,kc->kp", beside, unit)
    away = np.abs(beside[..., 0] * unit[:, None, 1] - beside[..., 1] * unit[:, None, 0]).max(axis=1)
    low, high = np.maximum(along[:, 1], 0.0), np.minimum(along[:, 0], length)
    touch = (away < _CLOSE) & (high - low > _CLOSE)
    i, j, low, high = i[touch], j[touch], low[touch], high[touch]
    segments = edges[i, :1] + unit[touch][:, None] * np.stack([low, high], axis=1)[..., None]
    return _joined(np.stack([owner[i], owner[j]], axis=1), segments)


def points_of(xy: NDArray[np.float64]) -> NDArray[np.object_]:
    """Make a point of each row, shape (k,)."""
    return np.asarray(shapely.points(xy), dtype=object)


def segment_tree(segments: NDArray[np.float64]) -> shapely.STRtree:
    """Make an index of segments, shape (k, 2, 2)."""
    return shapely.STRtree([shapely.LineString(segment) for segment in segments])


def _rings(cells: Sequence[shapely.Polygon]) -> tuple[NDArray[np.object_], NDArray[np.intp]]:
    """Rings of all cells with the cell on their left, and the cell of each."""
    rings, owner = shapely.get_rings(shapely.orient_polygons(np.array(cells, dtype=object)), return_index=True)
    return rings, owner.astype(np.intp)


def _joined(pairs: NDArray[np.intp], segments: NDArray[np.float64]) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Join segments of one pair that continue each other in a straight line; sort by pair and place."""
    order = np.lexsort((segments[:, 0, 1], segments[:, 0, 0], pairs[:, 1], pairs[:, 0]))
    pairs, segments = pairs[order], segments[order]
    groups: dict[tuple[int, int], list[NDArray[np.float64]]] = {}
    for (a, b), segment in zip(pairs.tolist(), segments, strict=True):
        run = groups.setdefault((a, b), [])
        while (k := next((k for k, other in enumerate(run) if _continues(other, segment)), -1)) >= 0:
            other = run.pop(k)
            segment = _outer(other, segment)
        run.append(segment)
    rows = [(pair, segment) for pair, run in groups.items() for segment in run]
    return (
        np.array([pair for pair, _ in rows], dtype=np.intp).reshape(-1, 2),
        np.array([segment for _, segment in rows]).reshape(-1, 2, 2),
    )


def _continues(a: NDArray[np.float64], b: NDArray[np.float64]) -> bool:
    """Tell whether one segment begins where the other ends and goes on straight."""
    meets = min(float(np.abs(a[1] - b[0]).max()), float(np.abs(b[1] - a[0]).max())) < 2 * _CLOSE
    d, e = a[1] - a[0], b[1] - b[0]
    bend = abs(d[0] * e[1] - d[1] * e[0]) / max(float(np.hypot(*d)), float(np.hypot(*e)))
    return meets and bend < 2 * _CLOSE and float(d @ e) > 0


def _outer(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    first, second = (a, b) if np.abs(a[1] - b[0]).max() < np.abs(b[1] - a[0]).max() else (b, a)
    return np.stack([first[0], second[1]])
