"""Cut a plan into few cells that look like rooms and hallways."""

import numpy as np
import shapely

from discretize.partition import Partition
from discretize.rooms.annexes import annex
from discretize.rooms.bends import diagonals
from discretize.rooms.candidates import candidate_cuts
from discretize.rooms.faces import GRID, arrangement
from discretize.rooms.fitting import fit
from discretize.rooms.frame import frame_of
from discretize.rooms.leftovers import absorb
from discretize.rooms.merging import Limits
from discretize.rooms.search import best_partition
from discretize.rooms.structure import structure
from maps import FloorPlan

__all__ = ["room_cells"]

# In a scan of a furnished place, radii of the robot:
AISLE = 6.0  # what is narrower lies between pieces of furniture; hallways are wider
ROOM = 8.0  # width of the narrowest room
OFFICE = 16.0  # side of the smallest room that may be narrower, if it were square
LEAF = 6.0  # width of the widest door


def room_cells(
    plan: FloorPlan, *, tolerance: float = 0.1, radius: float = 0.2, rng: np.random.Generator | None = None
) -> Partition:
    """Cut a plan into few room- and hallway-like cells that are nearly convex.

    Cuts from reflex vertices, doorways first, make an arrangement of faces. Unions of faces that stay nearly convex and
    have no neck are pooled from many randomised merges, and a minimum set partition of the faces is chosen among them
    exactly. Convexity is judged on the structure of the plan: walls straight, obstacles that are small or, in a scan,
    no walls filled.

    Parameters
    ----------
    plan : FloorPlan
        What to cut. Its doors are boundaries of cells.
    tolerance : float
        Largest share of a cell's convex hull that may lie outside the cell, and of pairs of its points that may not
        see each other. Three times as much in scans of furnished places.
    radius : float
        Of the robot, metres: what it cannot enter is no cell of its own.
    rng : numpy.random.Generator or None
        Shuffles merges; the same generator always if None, so that the same plan gives the same cells.
    """
    rng = np.random.default_rng(0) if rng is None else rng
    scan = any(repair.kind == "removed furniture" for repair in plan.repairs)
    allowed = 3 * tolerance if scan else tolerance
    limits = Limits(1 - allowed, 1 - allowed, 0.5, 0.3) if scan else Limits(1 - allowed, 1 - allowed, 0.5, 0.4)
    frame = frame_of(plan.space)
    own, *lines = shapely.set_precision([frame.turned(part) for part in (plan.space, *plan.doors)], GRID)
    space = structure(own, radius if scan else radius / 2, 4 * radius, 25 * radius if scan else 0.0, lines)
    doors = np.array([shapely.get_coordinates(door)[[0, -1]] for door in lines]).reshape(-1, 2, 2)
    cuts, doorways = candidate_cuts(space, doors, allowed, 2 * radius)
    faces = arrangement(space, cuts, doorways, doors)
    bends = diagonals(faces.polygons, 1 - allowed)
    if len(bends):
        faces = arrangement(space, np.concatenate([cuts, bends]), doorways, doors)
    chosen, notes = best_partition(faces, limits, rng)
    owner = np.empty(len(faces), dtype=np.intp)
    for k, region in enumerate(chosen):
        owner[list(region.faces)] = k
    owner = absorb(faces, owner, 4 * radius, AISLE * radius if scan else 4 * radius)
    owner = annex(faces, owner, (OFFICE * radius) ** 2, ROOM * radius, LEAF * radius) if scan else owner
    cells = fit(plan.space, frame, faces, owner, reach=3 * radius)
    return Partition(tuple(cells), allowed, strict=False, notes=notes)
