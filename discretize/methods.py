"""The ways to cut a plan into cells, by name."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import shapely

from discretize.exact import exact_cells
from discretize.implicants import CONVEXITY
from discretize.quine_mccluskey import quine_mccluskey_cells
from discretize.rooms import room_cells
from discretize.visibility import visibility_cells
from maps import FloorPlan

__all__ = ["METHODS", "Method"]


@dataclass(frozen=True, slots=True)
class Method:
    """One way to cut a plan into cells.

    Attributes
    ----------
    name : str
        As people write it.
    cut : callable
        From a plan to simple polygons that cover its free space and do not overlap.
    convexity : float
        Least area of a cell as a share of its convex hull's that the method promises; 0 for a method that judges
        convexity with small obstacles left out, whose cells may have holes where those stand.
    summary : str
        One line about it.
    source : str
        Where it comes from.
    """

    name: str
    cut: Callable[[FloorPlan], Sequence[shapely.Polygon]]
    convexity: float
    summary: str
    source: str


METHODS: dict[str, Method] = {
    method.name: method
    for method in (
        Method(
            "exact",
            exact_cells,
            1.0,
            "strictly convex cells: triangles merged while they stay convex; never fails",
            "Hertel and Mehlhorn 1983, on a constrained Delaunay triangulation",
        ),
        Method(
            "rooms",
            lambda plan: room_cells(plan).cells,
            0.0,
            "few cells, like rooms and stretches of hallway as a person would draw them, nearly convex",
            "our own: doorway cuts, an arrangement of faces, pooled random merges, an exact minimum partition",
        ),
        Method(
            "quine-mccluskey",
            quine_mccluskey_cells,
            CONVEXITY,
            "nearly convex cells: a minimum cover by maximal unions of pieces of floor, overlaps collapsed",
            "the paper's suggestion for future work; Quine 1952, McCluskey 1956",
        ),
        Method(
            "visibility",
            visibility_cells,
            1 - 1e-6,
            "conservative visibility cells: very many, within each of which the same can be seen; to compare with",
            "LaValle, Lin, Guibas, Latombe and Motwani 1997",
        ),
    )
}
"""Every method by its name."""
