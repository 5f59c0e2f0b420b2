"""What must hold for every cell map, checked afresh from its polygons."""

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.cellmap import CellMap
from discretize.covering import cover, cover_problems
from discretize.cutting import blocked_doors
from discretize.numbering import ignored_numbers
from discretize.portals import find_openings
from discretize.routes import Ways, ways_of
from discretize.sharing import segment_tree

__all__ = ["CellReport", "check_cells"]

_ROUND = 1e-12
"""Rounding of a cell's area against its hull's."""

_TOUCH = 1e-6
"""A route may come this much nearer to a wall than the body's radius, metres."""


@dataclass(frozen=True, slots=True)
class CellReport:
    """Figures of a cell map, and what is wrong with it.

    Attributes
    ----------
    cells, portals : int
        How many.
    edges : tuple of pairs of int
        Adjacent cells by number, from 1.
    area : float
        Free space, square metres.
    coverage : float
        Share of the free space that cells cover.
    overlap : float
        Area that lies in a second cell or outside the free space, as a share of the free space.
    convexity : float
        Smallest area of a cell as a share of its convex hull's.
    tolerance : float
        Largest share of its convex hull that a cell may miss, as its method promises; 1 where nothing is promised.
    beyond : tuple of int
        Numbers, from 1, of the cells that miss more of it, judged by what a body can touch in them and with the
        obstacles in them filled.
    free_components : int
        Connected parts of the places where the body's centre can be.
    graph_components : int
        Connected parts of the graph of the cells that the body can enter.
    pockets : tuple of int
        Numbers of the cells that the body cannot enter, from 1.
    blocked_doors : tuple of int
        Doors of the plan through which the body does not fit, from 1.
    problems : tuple of str
        One sentence for everything that must hold and does not; empty for a sound map.
    notes : tuple of str
        One sentence for everything that was done otherwise than usual, for a tolerance that cells miss, and for room
        numbers of the plan that are not those of cells.
    """

    cells: int
    portals: int
    edges: tuple[tuple[int, int], ...]
    area: float
    coverage: float
    overlap: float
    convexity: float
    tolerance: float
    beyond: tuple[int, ...]
    free_components: int
    graph_components: int
    pockets: tuple[int, ...]
    blocked_doors: tuple[int, ...]
    problems: tuple[str, ...]
    notes: tuple[str, ...]


def check_cells(cellmap: CellMap) -> CellReport:
    """Check that cells cover the free space, do not overlap and are as convex as promised, and that routes are free.

    Two cells must be adjacent exactly when they share an opening for the body, the graph connected exactly as the
    free space is for the body, and every route must lead from checkpoint to portal without touching a wall.

    Parameters
    ----------
    cellmap : CellMap
        Any map, also one made by hand.
    """
    shapes = np.array(cellmap.cells, dtype=object)
    ways = ways_of(cellmap.plan.space, cellmap.radius)
    coverage, overlap = cover(cellmap.plan, cellmap.cells)
    hulls = shapely.area(shapely.convex_hull(shapes))
    convexity = cellmap.areas / np.where(hulls > 0, hulls, 1.0)
    components = cellmap.components
    beyond = _beyond(cellmap, convexity, ways)
    report = CellReport(
        cells=len(cellmap),
        portals=len(cellmap.portals),
        edges=tuple((a + 1, b + 1) for a, b in cellmap.edges),
        area=cellmap.plan.area,
        coverage=coverage,
        overlap=overlap,
        convexity=float(convexity.min(initial=1.0)),
        tolerance=cellmap.tolerance,
        beyond=beyond,
        free_components=len(ways.tight.parts),
        graph_components=len(np.unique(components[components >= 0])),
        pockets=tuple((np.flatnonzero(components < 0) + 1).tolist()),
        blocked_doors=tuple(k + 1 for k in blocked_doors(cellmap.plan, cellmap.portals)),
        problems=(),
        notes=(*cellmap.notes, *_tolerance_note(cellmap, beyond), *ignored_numbers(cellmap.cells, cellmap.plan.labels)),
    )
    problems = (*_shape_problems(cellmap, convexity), *_graph_problems(cellmap, report, ways))
    return CellReport(**{name: getattr(report, name) for name in report.__slots__} | {"problems": problems})


def _beyond(cellmap: CellMap, convexity: NDArray[np.float64], ways: Ways) -> tuple[int, ...]:
    """Cells that miss more of their convex hull than is tolerated, by what a body can touch in them, from 1."""
    numbers = []
    for k in np.flatnonzero(convexity < 1 - cellmap.tolerance - _ROUND).tolist():
        places = shapely.get_parts(ways.tight.within(cellmap.cells[k]).buffer(cellmap.radius))
        outlines = [shapely.Polygon(place.exterior) for place in places if isinstance(place, shapely.Polygon)]
        largest = max(outlines, key=shapely.area, default=None)
        if largest is not None and largest.area < (1 - cellmap.tolerance) * largest.convex_hull.area:
            numbers.append(k + 1)
    return tuple(numbers)


def _tolerance_note(cellmap: CellMap, beyond: tuple[int, ...]) -> tuple[str, ...]:
    """Say which cells break the promise that they are nearly convex."""
    if not beyond or cellmap.strict:
        return ()
    numbers = ", ".join(map(str, beyond))
    return (f"{len(beyond)} of {len(cellmap)} cells miss more than {cellmap.tolerance:g} of their hulls: {numbers}.",)


def _shape_problems(cellmap: CellMap, convexity: NDArray[np.float64]) -> list[str]:
    promised = 1 - cellmap.tolerance if cellmap.strict else 0.0
    problems = [
        f"Cell {k + 1} is not one simple polygon."
        for k, cell in enumerate(cellmap.cells)
        if not cell.is_valid or cell.is_empty or (cell.interiors and cellmap.strict)
    ]
    problems += cover_problems(cellmap.plan, cellmap.cells)
    problems += [
        f"Cell {k + 1} fills {convexity[k]:.4f} of its convex hull; at least {promised:g} was promised."
        for k in np.flatnonzero(convexity < promised - _ROUND).tolist()
    ]
    return problems


def _graph_problems(cellmap: CellMap, report: CellReport, ways: Ways) -> list[str]:
    problems = []
    pairs = find_openings(cellmap.cells, cellmap.checkpoints, ways)[0]
    expected, found = {(a, b) for a, b in pairs.tolist()}, set(cellmap.edges)
    for a, b in sorted(expected - found):
        problems.append(f"The body can go from cell {a + 1} to cell {b + 1}, but there is no portal.")
    for a, b in sorted(found - expected):
        problems.append(f"There is a portal from cell {a + 1} to cell {b + 1}, but the body cannot go there.")
    if len(found) < len(cellmap.portals):
        problems.append("Two cells have more than one portal.")
    if report.graph_components != report.free_components:
        problems.append(
            f"The graph has {report.graph_components} connected parts, the free space of the body "
            f"{report.free_components}."
        )
    return problems + _route_problems(cellmap)


def _route_problems(cellmap: CellMap) -> list[str]:
    problems, ways, owner = [], [], []
    for k, portal in enumerate(cellmap.portals):
        for cell, leg in zip(portal.cells, portal.legs, strict=True):
            if not (np.allclose(leg[0], cellmap.checkpoints[cell]) and np.allclose(leg[-1], portal.point)):
                problems.append(f"A route in cell {cell + 1} does not lead from its checkpoint to portal {k + 1}.")
            ways += list(np.stack([leg[:-1], leg[1:]], axis=1))
            owner += [k] * (len(leg) - 1)
    if ways:
        lines = shapely.linestrings(np.array(ways))
        walls = segment_tree(cellmap.plan.walls)
        (which, _), gap = walls.query_nearest(lines, return_distance=True, all_matches=False)
        near = set(which[gap < cellmap.radius - _TOUCH].tolist())
        outside = set(np.flatnonzero(~shapely.covers(cellmap.plan.space, lines)).tolist())
        for k in sorted({owner[way] for way in near | outside}):
            a, b = cellmap.portals[k].cells
            problems.append(f"The route between cells {a + 1} and {b + 1} comes too near to a wall for the body.")
    return problems
