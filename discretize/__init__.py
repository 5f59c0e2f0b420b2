"""Floor plan to convex cells, portals and cell graph."""

from discretize.bounds import Certificate, certify
from discretize.cellmap import CellMap, Portal, graph_components
from discretize.cells_geojson import cells_text, read_cells, write_cells
from discretize.checks import CellReport, check_cells
from discretize.cutting import convex_cells
from discretize.errors import DiscretizeError
from discretize.exact import exact_cells
from discretize.methods import DEFAULT_METHOD, METHODS, Method
from discretize.visibility import visibility_cells, visibility_count
from discretize.wallgrid import WallGrid

__all__ = [
    "DEFAULT_METHOD",
    "METHODS",
    "CellMap",
    "CellReport",
    "Certificate",
    "DiscretizeError",
    "Method",
    "Portal",
    "WallGrid",
    "cells_text",
    "certify",
    "check_cells",
    "convex_cells",
    "exact_cells",
    "graph_components",
    "read_cells",
    "visibility_cells",
    "visibility_count",
    "write_cells",
]
