"""In a furnished place, pieces of a room that furniture cuts off belong to that room."""

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.rooms.faces import Border, Faces

__all__ = ["annex"]

Index = NDArray[np.intp]

OPEN = 0.4  # least length of the boundary to the room, as a share of the piece's extent along it
DOOR = 0.3  # largest share of that boundary that is a doorway, unless it is too wide for a door


@dataclass(slots=True)
class _Cell:
    """A cell while cells grow: its area, the corners of its hull, and what it shares with others."""

    area: float
    hull: NDArray[np.float64]
    near: dict[int, Border]
    apart: set[int]


def annex(faces: Faces, owner: Index, area: float, width: float, leaf: float) -> Index:
    """Join every cell smaller and narrower than a room to the neighbour it opens widely to, the smallest first.

    Parameters
    ----------
    faces : Faces
        Faces of the plan.
    owner : ndarray of int, shape (F,)
        Cell of each face, counted from 0 without gaps.
    area : float
        Of the smallest room, square metres.
    width : float
        Of the narrowest room, metres.
    leaf : float
        Of the widest door, metres; what looks like a doorway but is wider stands between pieces of furniture.

    Returns
    -------
    ndarray of int, shape (F,)
        Cell of each face, counted from 0 without gaps. No cells that a doorway or a door of the source parts are one.
    """
    owner = owner.copy()
    cells = _cells(faces, owner)
    todo = {k for k, cell in cells.items() if cell.area < area}
    while todo:
        k = min(todo, key=lambda k: (cells[k].area, k))
        todo.discard(k)
        shape = shapely.coverage_union_all(faces.polygons[owner == k])
        target = _widest(cells, k, leaf) if shapely.is_empty(shapely.buffer(shape, -width / 2)) else None
        if target is None:
            continue
        _join(cells, k, target)
        owner[owner == k] = target
        if cells[target].area < area:
            todo.add(target)
        else:
            todo.discard(target)
    return np.unique(owner, return_inverse=True)[1].astype(np.intp)


def _cells(faces: Faces, owner: Index) -> dict[int, _Cell]:
    cells: dict[int, _Cell] = {}
    for k in range(int(owner.max()) + 1):
        union = shapely.coverage_union_all(faces.polygons[owner == k])
        cells[k] = _Cell(union.area, shapely.get_coordinates(union.convex_hull), {}, set())
    for (i, j), border in faces.borders.items():
        a, b = int(owner[i]), int(owner[j])
        if a != b:
            joint = cells[a].near[b] + border if b in cells[a].near else border
            cells[a].near[b] = cells[b].near[a] = joint
            if (i, j) in faces.barred:
                cells[a].apart.add(b)
                cells[b].apart.add(a)
    return cells


def _widest(cells: dict[int, _Cell], k: int, leaf: float) -> int | None:
    """Return the neighbour with the longest boundary that is long for the cell's extent there and no doorway."""
    cell = cells[k]
    best, longest = None, 0.0
    for other, border in sorted(cell.near.items()):
        along = cell.hull @ border.direction
        wide = border.length >= OPEN * (along.max() - along.min())
        doorway = border.door > DOOR * border.length and border.length <= leaf
        if wide and not doorway and other not in cell.apart and border.length > longest:
            best, longest = other, border.length
    return best


def _join(cells: dict[int, _Cell], k: int, target: int) -> None:
    """Let one cell become part of another."""
    gone, cell = cells.pop(k), cells[target]
    cell.area += gone.area
    cell.hull = np.concatenate([cell.hull, gone.hull])
    for other, border in gone.near.items():
        del cells[other].near[k]
        if other != target:
            joint = cell.near[other] + border if other in cell.near else border
            cell.near[other] = cells[other].near[target] = joint
    for other in gone.apart:
        cells[other].apart.discard(k)
        cells[other].apart.add(target)
        cell.apart.add(other)
