"""Floor plan to convex cells, portals and cell graph."""

from discretize.cellmap import CellMap, Portal, graph_components
from discretize.checks import CellReport, check_cells
from discretize.cutting import convex_cells
from discretize.errors import DiscretizeError
from discretize.exact import exact_cells
from discretize.methods import METHODS, Method

__all__ = [
    "METHODS",
    "CellMap",
    "CellReport",
    "DiscretizeError",
    "Method",
    "Portal",
    "check_cells",
    "convex_cells",
    "exact_cells",
    "graph_components",
]
