"""From a mask of pixels to polygons along pixel edges, and to straight walls."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

__all__ = ["straighten", "trace"]


def trace(mask: NDArray[np.bool_]) -> shapely.MultiPolygon:
    """Outline the set pixels of a mask exactly.

    Pixels that share an edge belong together; those that share only a corner do not.

    Parameters
    ----------
    mask : ndarray of bool, shape (H, W)
        Row 0 is the uppermost.

    Returns
    -------
    shapely.MultiPolygon
        In pixels: x from the left edge, y upwards from the lower edge of the mask.
    """
    padded = np.pad(mask, 1).astype(np.int8)
    y, x0, x1 = _runs(np.diff(padded, axis=0)[:, 1:-1])
    x, y0, y1 = _runs(np.diff(padded, axis=1)[1:-1].T)
    height = mask.shape[0]
    level = np.stack([np.stack([x0, height - y], 1), np.stack([x1, height - y], 1)], 1)
    upright = np.stack([np.stack([x, height - y0], 1), np.stack([x, height - y1], 1)], 1)
    edges = shapely.MultiLineString(list(np.concatenate([level, upright]).astype(np.float64)))
    faces = shapely.get_parts(shapely.polygonize([edges]))
    inside = shapely.get_coordinates(shapely.point_on_surface(faces))
    rows, columns = (height - 1 - np.floor(inside[:, 1])).astype(int), np.floor(inside[:, 0]).astype(int)
    return shapely.MultiPolygon(list(faces[mask[rows, columns]]))


def _runs(step: NDArray[np.int8]) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """Find the runs of one sign in each row: their row, first column and the column after their last."""
    padded = np.pad(step, ((0, 0), (1, 1)))
    change = padded[:, 1:] != padded[:, :-1]
    row, first = np.nonzero(change & (padded[:, 1:] != 0))
    _, after = np.nonzero(change & (padded[:, :-1] != 0))
    return row, first, after


def straighten(outline: shapely.MultiPolygon, tolerance: float) -> shapely.MultiPolygon:
    """Turn the staircases of pixel outlines into straight walls.

    No point of a wall moves by more than the tolerance (twice that next to the first vertex of a ring, which may be
    left out after the others), and no room, wall or passage appears, vanishes, joins or parts: where the simple
    outline would do so the exact one is returned.

    Parameters
    ----------
    outline : shapely.MultiPolygon
        From :func:`trace`.
    tolerance : float
        In the unit of the outline.
    """
    simple = shapely.MultiPolygon(list(shapely.get_parts(shapely.simplify(outline, tolerance, preserve_topology=True))))
    same = simple.is_valid and len(simple.geoms) == len(outline.geoms) and len(_rings(simple)) == len(_rings(outline))
    return simple if same else outline


def _rings(outline: shapely.MultiPolygon) -> NDArray[np.object_]:
    return shapely.get_rings(shapely.get_parts(outline))
