"""How good a cut is: bounds that no cut into strictly convex cells can beat, and sight within the cells."""

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.cellmap import CellMap
from discretize.exact import exact_cells
from discretize.sight import Sight
from discretize.triangulation import Triangulation, door_edges, triangulate, turns_left
from maps import FloorPlan

__all__ = ["Certificate", "certify", "hidden_set", "mutual_sight", "reflex_bound"]

_CORNER = 0.02
"""How far from a corner somebody hides in it, metres."""

_PLACES = 700
"""Most hiding places to choose from: their pairs must be looked at one by one."""

_SAMPLES = 48
"""Points of a cell among which mutual sight is measured."""


@dataclass(frozen=True, slots=True)
class Certificate:
    """What is known about the number of cells, and how well one sees within them.

    All bounds are for strictly convex cells that do not reach across a door.

    Attributes
    ----------
    reflex_bound : int
        Every cut has at least so many cells, because each reflex corner needs an edge (:func:`reflex_bound`).
    hidden_bound : int
        Every cut has at least so many cells, because so many places hide from each other (:func:`hidden_set`).
    hidden : ndarray, shape (hidden_bound, 2)
        These places, metres.
    exact : int
        Cells of :func:`exact_cells`: a cut with so many exists.
    mutual_sight : float
        Least share of pairs of points of a cell that see each other.
    darkest : int
        Number of the cell with that share, from 1.
    """

    reflex_bound: int
    hidden_bound: int
    hidden: NDArray[np.float64]
    exact: int
    mutual_sight: float
    darkest: int


def certify(cellmap: CellMap) -> Certificate:
    """Bound the number of strictly convex cells of a map's plan, and measure sight within the map's cells.

    Parameters
    ----------
    cellmap : CellMap
        By any method.
    """
    exact = exact_cells(cellmap.plan)
    hidden = hidden_set(cellmap.plan, exact)
    sight = mutual_sight(cellmap)
    return Certificate(
        reflex_bound=reflex_bound(cellmap.plan),
        hidden_bound=len(hidden),
        hidden=hidden,
        exact=len(exact),
        mutual_sight=float(sight.min()),
        darkest=int(sight.argmin()) + 1,
    )


def reflex_bound(plan: FloorPlan) -> int:
    """Least number of strictly convex cells, by Euler's formula.

    Edges between cells with E segments and V crossing points off the walls make E - V + 1 - h cells at least, h the
    number of holes. Every crossing point ends three edges or more, and every reflex corner one (B. Chazelle and
    D. Dobkin, Optimal convex decompositions, 1985); doors are edges of their own. So the number of cells is at least
    half the number of ends that corners and doors need, plus 1, less h.

    Parameters
    ----------
    plan : FloorPlan
        Free space and doors.
    """
    return sum(
        max(-(-_needed_ends(triangulate(part, plan.doors)) // 2) + 1 - len(part.interiors), 1) for part in plan.parts
    )


def _needed_ends(mesh: Triangulation) -> int:
    """Ends of edges between cells that corners and doors need."""
    apex = {edge: w for a, b, c in mesh.triangles for edge, w in (((a, b), c), ((b, c), a), ((c, a), b))}
    doors = mesh.doors | {(b, a) for a, b in mesh.doors}
    needed = len(doors)
    for v, first in apex:
        if (first, v) in apex and (v, first) not in doors:
            continue
        last = first  # turn left around v from one wall or door to the next
        while (v, last) in apex and (last == first or (v, last) not in doors):
            last = apex[v, last]
        needed += not turns_left(mesh.grid[last], mesh.grid[v], mesh.grid[first])
    return needed


def hidden_set(plan: FloorPlan, cells: list[shapely.Polygon]) -> NDArray[np.float64]:
    """Places of which no two see each other, as many as are easily found; each needs a convex cell of its own.

    Doors count as shut: a cell does not reach across one. Places are sought in the corners and in the middles of the
    given cells, first greedily by how few others they see, then by exchanging one for two.

    Parameters
    ----------
    plan : FloorPlan
        Free space and doors.
    cells : list of shapely.Polygon
        A cut of it into convex cells.

    Returns
    -------
    ndarray, shape (k, 2)
        Metres.
    """
    places = _hiding_places(cells)
    sees = Sight(plan, door_edges(plan)).among(places)
    np.fill_diagonal(sees, False)
    chosen = _exchange(sees, _greedy(sees))
    return places[chosen]


def _hiding_places(cells: list[shapely.Polygon]) -> NDArray[np.float64]:
    """Middles of cells and places in their corners, evenly thinned out where there are too many."""
    middles = shapely.get_coordinates(shapely.centroid(np.array(cells, dtype=object)))
    xy, cell = shapely.get_coordinates(np.array(cells, dtype=object), return_index=True)
    inwards = middles[cell] - xy
    far = np.hypot(*inwards.T)
    corners = (xy + inwards * np.minimum(_CORNER / np.maximum(far, _CORNER), 0.5)[:, None])[far > _CORNER]
    places = np.unique(np.round(np.concatenate([middles, corners]), 9), axis=0)
    return places[np.linspace(0, len(places) - 1, min(len(places), _PLACES)).astype(np.intp)]


def _greedy(sees: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Take again and again the place that sees the fewest of those left, and leave out what it sees."""
    left = np.ones(len(sees), dtype=np.bool_)
    chosen = np.zeros(len(sees), dtype=np.bool_)
    count = sees.sum(axis=1)
    while left.any():
        k = int(np.argmin(np.where(left, count, len(sees))))
        chosen[k] = True
        gone = left & sees[k]
        gone[k] = True
        left &= ~gone
        count -= sees[:, gone].sum(axis=1)
    return chosen


def _exchange(sees: NDArray[np.bool_], chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Exchange one place for two that it alone keeps out, for as long as that is possible."""
    chosen = chosen.copy()
    while True:
        seen_by = sees[:, chosen].sum(axis=1)
        for k in np.flatnonzero(chosen).tolist():
            kept_out = np.flatnonzero(sees[k] & (seen_by == 1) & ~chosen)
            pairs = np.argwhere(~sees[np.ix_(kept_out, kept_out)] & ~np.eye(len(kept_out), dtype=np.bool_))
            if len(pairs):
                chosen[k] = False
                chosen[kept_out[pairs[0]]] = True
                break
        else:
            return chosen


def mutual_sight(cellmap: CellMap) -> NDArray[np.float64]:
    """Share of pairs of points of each cell that see each other, shape (N,); 1 for a convex cell.

    Pairs of points spread evenly over a cell (a lattice of golden ratios, so that the same cell gives the same share).

    Parameters
    ----------
    cellmap : CellMap
        By any method.
    """
    shapes = np.array(cellmap.cells, dtype=object)
    share = np.ones(len(shapes))
    full = shapely.area(shapely.convex_hull(shapes)) - cellmap.areas
    bent = np.flatnonzero(full > 1e-9 * cellmap.areas)
    if len(bent):
        sight = Sight(cellmap.plan)
        for k in bent.tolist():
            sees = sight.among(_spread(cellmap.cells[k]))
            share[k] = sees[np.triu_indices(len(sees), 1)].mean() if len(sees) > 1 else 1.0
    return share


def _spread(cell: shapely.Polygon) -> NDArray[np.float64]:
    """Points spread evenly over a cell (M. Roberts's R2 sequence on its bounding box)."""
    x0, y0, x1, y1 = cell.bounds
    n = int(np.ceil(_SAMPLES * (x1 - x0) * (y1 - y0) / cell.area))
    plastic = 1.32471795724474602596
    step = np.arange(1, n + 1)[:, None] * np.array([1 / plastic, 1 / plastic**2])
    points = np.array([x0, y0]) + (step + 0.5) % 1.0 * np.array([x1 - x0, y1 - y0])
    inside: NDArray[np.bool_] = shapely.contains_xy(cell, points[:, 0], points[:, 1])
    return np.asarray(points[inside])
