"""Floor plan to convex cells, portals and cell graph."""

from discretize.cellmap import CellMap, Portal, graph_components

__all__ = ["CellMap", "Portal", "graph_components"]
