"""Positions along polylines."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["along"]


def along(line: NDArray[np.float64], way: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where one is after some ways along a polyline, and where one looks who goes there.

    Parameters
    ----------
    line : ndarray, shape (k, 2) with k >= 2
        Metres.
    way : ndarray, shape (n,)
        Metres from its first point.

    Returns
    -------
    points : ndarray, shape (n, 2)
        Metres.
    headings : ndarray, shape (n,)
        Radians, counterclockwise from the x axis; on a bend, of the piece that begins there.
    """
    pieces = np.diff(line, axis=0)
    marks = np.concatenate([[0.0], np.cumsum(np.hypot(*pieces.T))])
    points = np.stack([np.interp(way, marks, line[:, k]) for k in (0, 1)], axis=1)
    piece = np.clip(np.searchsorted(marks, way, side="right") - 1, 0, len(pieces) - 1)
    return points, np.arctan2(pieces[piece, 1], pieces[piece, 0])
