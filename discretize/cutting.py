"""Floor plan to cell map: the one entry, whatever the method."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely

from discretize.cellmap import CellMap, Portal
from discretize.errors import DiscretizeError
from discretize.methods import DEFAULT_METHOD, METHODS
from discretize.numbering import number_cells
from discretize.parting import part_cells
from discretize.partition import Partition
from discretize.portals import find_checkpoints, find_portals
from discretize.routes import Ways, ways_of
from discretize.sharing import shared_segments
from discretize.splitting import split_bottlenecks
from maps import FloorPlan, nearest

__all__ = ["blocked_doors", "connect_cells", "convex_cells"]

LARGEST_RADIUS = 100.0
"""No body is larger than this, metres."""

_BESIDE = 0.01
"""A portal whose segment comes this near to the middle of a door is that door's, metres."""


def convex_cells(plan: FloorPlan, *, method: str = DEFAULT_METHOD, radius: float = 0.2) -> CellMap:
    """Cut a floor plan into convex cells, with the portals and routes that a round body can use.

    Parameters
    ----------
    plan : FloorPlan
        What to cut.
    method : str
        One of :data:`METHODS`.
    radius : float
        Radius of the largest body that will use the map, metres.

    Raises
    ------
    DiscretizeError
        If there is no such method, the radius is no positive length of at most 100 m, or the body fits nowhere or
        through no door.
    """
    if method not in METHODS:
        raise DiscretizeError(f"There is no method {method!r} to cut a plan into cells; {nearest(method, METHODS)}")
    if not 0 < radius <= LARGEST_RADIUS:
        raise DiscretizeError(
            f"The radius of a body must be a positive length in metres, not {radius!r}; at most {LARGEST_RADIUS:g} are "
            "possible."
        )
    ways = ways_of(plan.space, radius)
    cut = METHODS[method].cut(plan)
    if cut.strict:
        cells = split_bottlenecks(cut.cells, ways.tight, 1 - cut.tolerance)
    else:
        cells = part_cells(cut.cells, ways.tight)
    cells, names = number_cells(cells, plan.labels)
    return connect_cells(plan, replace(cut, cells=cells), names, ways, method)


def connect_cells(plan: FloorPlan, cut: Partition, names: Sequence[str], ways: Ways, method: str) -> CellMap:
    """Find checkpoints, portals and routes of given cells.

    Parameters
    ----------
    plan : FloorPlan
        What was cut.
    cut : Partition
        N cells in their order.
    names : sequence of str
        One for each.
    ways : Ways
        Where the largest body that will use the map can be.
    method : str
        Where the cells come from.

    Raises
    ------
    DiscretizeError
        If the body fits nowhere, through none of the plan's doors, or from no cell into another.
    """
    radius = ways.tight.radius
    cells = cut.cells
    if not ways.tight.parts:
        raise DiscretizeError(f"A body {2 * radius:.3g} m across does not fit anywhere in plan {plan.name!r}.")
    checkpoints = find_checkpoints(cells, ways)
    portals = find_portals(cells, checkpoints, ways)
    closed = len(blocked_doors(plan, portals)) == len(plan.doors) > 0
    widest = 0.0 if portals and not closed else _widest(plan, cells)
    if widest > 0:  # where no two cells touch there is no passage that could be wider
        raise DiscretizeError(
            f"A body {2 * radius:.3g} m across fits through no {'door' if plan.doors else 'passage'} of plan "
            f"{plan.name!r}: the widest is {widest:.3g} m."
        )
    checkpoints.setflags(write=False)
    return CellMap(
        plan, tuple(cells), portals, checkpoints, radius, method, tuple(names), cut.tolerance, cut.strict, cut.notes
    )


def blocked_doors(plan: FloorPlan, portals: Sequence[Portal]) -> tuple[int, ...]:
    """Doors of a plan through which no portal leads, counted from 0.

    Parameters
    ----------
    plan : FloorPlan
        Doors and free space.
    portals : sequence of Portal
        Of a map of this plan.
    """
    open_ = shapely.union_all(shapely.linestrings(np.array([p.segment for p in portals]).reshape(-1, 2, 2)))
    middles = [door.interpolate(0.5, normalized=True) for door in plan.doors]
    return tuple(k for k, middle in enumerate(middles) if not open_.dwithin(middle, _BESIDE))


def _widest(plan: FloorPlan, cells: Sequence[shapely.Polygon]) -> float:
    """Width of the widest door, or where the plan has none of the widest passage between two cells, metres."""
    if plan.doors:
        return max(door.length for door in plan.doors)
    middles = shapely.points(shared_segments(cells)[1].mean(axis=1))
    return float(2 * shapely.distance(plan.space.boundary, middles).max(initial=0.0))
