"""Drawings in SVG, with the ``formats`` extra.

A shape's name is its ``id``, ``class`` and label together with those of the groups around it; what names mean is in
:mod:`maps.named`. The lower left corner of all that is drawn is the origin.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from maps.errors import PlanError
from maps.extras import need
from maps.floorplan import FloorPlan
from maps.making import make_plan
from maps.named import space_of
from maps.units import check_resolution, metres_per
from maps.xmlfiles import kind_of, read_xml

__all__ = ["read_svg"]

HIDDEN = ("defs", "clipPath", "mask", "symbol", "marker", "pattern", "metadata", "style")
CHORDS = 32
"""Number of chords for each curved segment of a path."""


def read_svg(path: Path, *, resolution: float | None = None, units: str | None = None) -> FloorPlan:
    """Read a drawing.

    Parameters
    ----------
    path : Path
        An ``.svg`` file.
    resolution : float or None
        Size of a unit of the drawing, metres.
    units : str or None
        Unit of the drawing, instead of a resolution. One of the two is needed: what SVG says about millimetres is about
        paper, not about the building.

    Raises
    ------
    PlanError
        If neither is given, the file is no SVG, or it holds no walkable space.
    """
    where = str(path)
    if resolution is None and units is None:
        raise PlanError(f"{where}: a drawing does not say its scale; give the resolution, metres for a unit of it.")
    metres = metres_per(units, where) if resolution is None else check_resolution(resolution, where)
    root = read_xml(path, "svg", "SVG")
    lines = [(name, xy) for name, xy in _lines(root, np.eye(3), "", where) if len(xy) > 1 and np.ptp(xy, axis=0).any()]
    if not lines:
        raise PlanError(f"{where}: there is no free space in it; nothing is drawn in it.")
    left, bottom = np.concatenate([xy for _, xy in lines]).min(axis=0) * [1, 0], max(xy[:, 1].max() for _, xy in lines)
    place = np.array([left[0], bottom])
    shapes = [(name, shapely.LineString((xy - place) * [metres, -metres])) for name, xy in lines]
    free, solid, repairs = space_of([(name, line) for name, line in shapes], where)
    return make_plan(free, name=path.stem, solid=solid, source=where, repairs=repairs)


def _lines(
    element: Any, outer: NDArray[np.float64], names: str, where: str
) -> Iterator[tuple[str, NDArray[np.float64]]]:
    """Yield the name and the vertices, shape (n, 2), of every line below an element, in the units of the drawing."""
    tools = need("svgpathtools", where)
    if kind_of(element) in HIDDEN or "display:none" in element.get("style", "").replace(" ", ""):
        return
    own = [value for key, value in element.attrib.items() if key.rpartition("}")[2] in ("id", "class", "label")]
    name = " ".join([names, *own])
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # what it does not understand of a transform it would leave out
            matrix = outer @ tools.parser.parse_transform(element.get("transform"))
        for xy in _vertices(element, tools):
            yield name, (np.column_stack([xy, np.ones(len(xy))]) @ matrix.T)[:, :2]
    except (ValueError, IndexError, KeyError, TypeError, AssertionError, Warning) as exc:
        what = f"{kind_of(element)} {element.get('id', '')}".strip()
        raise PlanError(f"{where}: the shape {what!r} has coordinates that are missing or wrong.") from exc
    for child in element:
        if isinstance(child.tag, str):
            yield from _lines(child, matrix, name, where)


def _vertices(element: Any, tools: Any) -> Iterator[NDArray[np.float64]]:
    kind = kind_of(element)
    if kind == "rect":
        x, y, w, h = (float(element.get(key, 0)) for key in ("x", "y", "width", "height"))
        yield np.array([[x, y], [x + w, y], [x + w, y + h], [x, y + h], [x, y]])
    elif kind in ("circle", "ellipse"):
        rx, ry = float(element.get("rx") or element.get("r") or 0), float(element.get("ry") or element.get("r") or 0)
        turn = np.linspace(0, 2 * np.pi, 4 * CHORDS + 1)
        middle = np.array([float(element.get("cx", 0)), float(element.get("cy", 0))])
        yield middle + np.stack([rx * np.cos(turn), ry * np.sin(turn)], axis=1)
    elif kind == "line":
        yield np.array([[float(element.get(key, 0)) for key in pair] for pair in (("x1", "y1"), ("x2", "y2"))])
    elif kind in ("polygon", "polyline"):
        xy = np.array([float(v) for v in element.get("points", "").replace(",", " ").split()]).reshape(-1, 2)
        yield np.vstack([xy, xy[:1]]) if kind == "polygon" else xy
    elif kind == "path":
        for run in tools.parse_path(element.get("d", "")).continuous_subpaths():
            points = [run[0].start]
            for segment in run:
                steps = 1 if isinstance(segment, tools.Line) else CHORDS
                points += [segment.point(k / steps) for k in range(1, steps + 1)]
            yield np.array([[p.real, p.imag] for p in points])
