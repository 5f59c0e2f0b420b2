"""Published cell graphs: an edge list in JSON, without geometry."""

from __future__ import annotations

from pathlib import Path

from maps.texts import load_json
from planners.capture import SameCell
from planners.graph import GraphError, SearchGraph
from planners.motion import UniformMotion
from planners.policy import SearchProblem

__all__ = ["read_edge_list", "unit_problem"]


def read_edge_list(path: str | Path) -> SearchGraph:
    """Read a graph from a JSON file with ``vertices`` (a number) and ``edges`` (pairs of vertices from 0).

    Other keys are notes. Every edge gets length 1 and every vertex area 1.

    Raises
    ------
    GraphError
        If the file cannot be read, is no such JSON, or describes no graph; the message names the file.
    """
    document = load_json(Path(path), str(path), GraphError)
    if not isinstance(document, dict):
        raise GraphError(f"{path}: must hold an object with 'vertices' and 'edges'.")
    vertices, edges = document.get("vertices"), document.get("edges")
    if not isinstance(vertices, int) or isinstance(vertices, bool) or vertices < 1:
        raise GraphError(f"{path}: 'vertices' must be a whole number above 0; got {vertices!r}.")
    if not isinstance(edges, list):
        raise GraphError(f"{path}: 'edges' must be a list of pairs; got {edges!r}.")
    for k, edge in enumerate(edges):
        pair = isinstance(edge, list) and len(edge) == 2
        if not pair or not all(isinstance(v, int) and not isinstance(v, bool) for v in edge):
            raise GraphError(f"{path}: edges[{k}] must be a pair of whole numbers; got {edge!r}.")
    try:
        return SearchGraph.from_edges(vertices, edges)
    except GraphError as exc:
        raise GraphError(f"{path}: {exc}") from exc


def unit_problem(graph: SearchGraph, pursuers: int) -> SearchProblem:
    """Return the problem that published results on edge lists are about, on a ``graph``, for so many ``pursuers``.

    In each step the evader stays or moves to a neighbour, all equally likely; then each pursuer stays or moves; then
    it captures in the cell where it is.
    """
    return SearchProblem(graph, UniformMotion(), SameCell(), (1.0,) * pursuers)
