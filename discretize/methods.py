"""The ways to cut a plan into cells, by name."""

from collections.abc import Callable
from dataclasses import dataclass

import shapely

from discretize.covering import cover_problems
from discretize.exact import exact_cells
from discretize.implicants import CONVEXITY
from discretize.partition import Partition
from discretize.quine_mccluskey import quine_mccluskey_cells
from discretize.rooms import room_cells
from discretize.visibility import visibility_cells
from maps import FloorPlan

__all__ = ["DEFAULT_METHOD", "METHODS", "Method"]

DEFAULT_METHOD = "rooms"
"""What cuts a plan unless something else is asked for."""


@dataclass(frozen=True, slots=True)
class Method:
    """One way to cut a plan into cells.

    Attributes
    ----------
    name : str
        As people write it.
    cut : callable
        From a plan to its partition.
    summary : str
        One line about it.
    source : str
        Where it comes from.
    """

    name: str
    cut: Callable[[FloorPlan], Partition]
    summary: str
    source: str


def rooms_or_exact(plan: FloorPlan) -> Partition:
    """Cut a plan into rooms and hallways, or where these do not cover it once, exactly.

    Parameters
    ----------
    plan : FloorPlan
        What to cut.
    """
    try:
        cut = room_cells(plan)
    except shapely.errors.GEOSException as exc:
        wrong = [f"{exc}."]
    else:
        wrong = cover_problems(plan, cut.cells)
        if not wrong:
            return cut
    note = f"Cells are those of the exact method, because cells like rooms failed on this plan: {wrong[0]}"
    return Partition(exact_cells(plan), 0.0, notes=(note,))


METHODS: dict[str, Method] = {
    method.name: method
    for method in (
        Method(
            "rooms",
            rooms_or_exact,
            "few cells, like rooms and stretches of hallway as a person would draw them, nearly convex",
            "our own: doorway cuts, an arrangement of faces, pooled random merges, an exact minimum partition",
        ),
        Method(
            "exact",
            lambda plan: Partition(exact_cells(plan), 0.0),
            "strictly convex cells: triangles merged while they stay convex; never fails",
            "Hertel and Mehlhorn 1983, on a constrained Delaunay triangulation",
        ),
        Method(
            "quine-mccluskey",
            lambda plan: Partition(quine_mccluskey_cells(plan), 1 - CONVEXITY),
            "nearly convex cells: a minimum cover by maximal unions of pieces of floor, overlaps collapsed",
            "the paper's suggestion for future work; Quine 1952, McCluskey 1956",
        ),
        Method(
            "visibility",
            lambda plan: Partition(visibility_cells(plan), 1e-6),
            "conservative visibility cells: very many, within each of which the same can be seen; to compare with",
            "LaValle, Lin, Guibas, Latombe and Motwani 1997",
        ),
    )
}
"""Every method by its name."""
