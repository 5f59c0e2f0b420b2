"""The graph of cells as GraphML, which networkx, Gephi, igraph and others read."""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np

from discretize import CellMap

__all__ = ["graphml_text"]

_NODE = {"x": "double", "y": "double", "area": "double", "component": "int", "name": "string"}
_EDGE = {"length": "double", "width": "double", "portal_x": "double", "portal_y": "double"}


def graphml_text(cells: CellMap) -> str:
    """Return the graph of cells as GraphML (http://graphml.graphdrawing.org), undirected.

    A node's id is the cell's number, from 1. Its attributes are ``x`` and ``y`` of the checkpoint (metres; without them
    where no body can stand), ``area`` (square metres), ``component`` (0 for the part of the building with most area, -1
    where no body fits) and ``name``. An edge has the ``length`` of the way from checkpoint to checkpoint, the ``width``
    of the portal and the point ``portal_x``, ``portal_y`` at which it is crossed, all in metres. The plan's name is the
    graph's id.
    """
    root = ElementTree.Element("graphml", xmlns="http://graphml.graphdrawing.org/xmlns")
    for owner, kinds in (("node", _NODE), ("edge", _EDGE)):
        for name, kind in kinds.items():
            about = {"id": f"{owner}_{name}", "for": owner, "attr.name": name, "attr.type": kind}
            ElementTree.SubElement(root, "key", about)
    graph = ElementTree.SubElement(root, "graph", id=_plain(cells.plan.name) or "plan", edgedefault="undirected")
    for k, (checkpoint, area) in enumerate(zip(cells.checkpoints.tolist(), cells.areas.tolist(), strict=True)):
        node = ElementTree.SubElement(graph, "node", id=str(k + 1))
        values: dict[str, float | int | str] = {
            "area": area,
            "component": int(cells.components[k]),
            "name": _plain(cells.names[k]),
        }
        if np.isfinite(checkpoint).all():
            values |= {"x": checkpoint[0], "y": checkpoint[1]}
        _fill(node, "node", values)
    for portal in cells.portals:
        i, j = portal.cells
        edge = ElementTree.SubElement(graph, "edge", source=str(i + 1), target=str(j + 1))
        length = sum(float(np.hypot(*np.diff(leg, axis=0).T).sum()) for leg in portal.legs)
        x, y = portal.point.tolist()
        _fill(edge, "edge", {"length": length, "width": portal.width, "portal_x": x, "portal_y": y})
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def _fill(element: ElementTree.Element, owner: str, values: dict[str, float | int | str]) -> None:
    for name, value in values.items():
        ElementTree.SubElement(element, "data", key=f"{owner}_{name}").text = str(value)


def _plain(name: str) -> str:
    """Leave out what XML cannot hold: names come from files."""
    return "".join(c for c in name if c.isprintable())
