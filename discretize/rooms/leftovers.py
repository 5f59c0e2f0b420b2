"""Cells that nobody can stand in go to a neighbour."""

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.rooms.faces import Faces

__all__ = ["absorb"]

Index = NDArray[np.intp]


def absorb(faces: Faces, owner: Index, side: float, width: float) -> Index:
    """Give every cell that is too small or narrow to the neighbour it has most open boundary with, smallest first.

    Parameters
    ----------
    faces : Faces
        Faces of the plan.
    owner : ndarray of int, shape (F,)
        Cell of each face.
    side : float
        Of the smallest square cell, metres.
    width : float
        Of the narrowest cell, metres.

    Returns
    -------
    ndarray of int, shape (F,)
        Cell of each face, counted from 0 without gaps. No two cells that a door of the source parts become one.
    """
    owner = owner.copy()
    cells = [shapely.coverage_union_all(faces.polygons[owner == k]) for k in range(owner.max() + 1)]
    area = shapely.area(cells)
    small = (area < side**2) | shapely.is_empty(shapely.buffer(cells, -width / 2))
    near: list[dict[int, float]] = [{} for _ in cells]
    apart: list[set[int]] = [set() for _ in cells]
    for (i, j), border in faces.borders.items():
        a, b = int(owner[i]), int(owner[j])
        if a != b:
            near[a][b] = near[b][a] = near[a].get(b, 0.0) + border.length - 0.75 * border.door
        if (i, j) in faces.barred:
            apart[a].add(b)
            apart[b].add(a)
    for k in sorted(np.flatnonzero(small).tolist(), key=lambda k: (area[k], k)):
        around = {other: length for other, length in near[k].items() if other not in apart[k]}
        if not around:
            continue
        target = max(around, key=lambda other: (around[other], area[other]))
        owner[owner == k] = target
        for other, length in near[k].items():
            del near[other][k]
            if other != target:
                near[target][other] = near[other][target] = near[target].get(other, 0.0) + length
        for other in apart[k]:
            apart[other].add(target)
            apart[target].add(other)
    return np.unique(owner, return_inverse=True)[1].astype(np.intp)
