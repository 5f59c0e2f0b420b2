"""Drawings in DXF, with the ``formats`` extra.

The name of a line is that of its layer; what names mean is in :mod:`maps.named`.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from maps.errors import PlanError
from maps.extras import need
from maps.floorplan import FloorPlan
from maps.making import make_plan
from maps.named import space_of
from maps.units import metres_per

__all__ = ["read_dxf"]

UNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 14: "dm"}
"""Values of the header's $INSUNITS (DXF Reference, HEADER section)."""

FLATTEN = 0.01
"""Curves become chords that are at most this far from them, metres."""

CURVES = ("LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE")


def read_dxf(path: Path, *, units: str | None = None) -> FloorPlan:
    """Read the model space of a drawing.

    Parameters
    ----------
    path : Path
        A ``.dxf`` file, text or binary.
    units : str or None
        Unit of the drawing, where it does not say it.

    Raises
    ------
    PlanError
        If the file is no drawing or damaged, has no unit and none is given, or there is no walkable space in it.
    """
    where = str(path)
    ezdxf = need("ezdxf", where)
    try:
        drawing = ezdxf.readfile(path)
    except OSError as exc:
        raise PlanError(f"{where}: the file cannot be read as a DXF drawing ({exc}).") from exc
    except Exception as exc:  # a damaged table leads ezdxf to errors of nearly every kind
        raise PlanError(f"{where}: this is no DXF drawing, or it is damaged.") from exc
    metres = _unit(drawing, units, where)
    try:
        drawn = list(_shapes(drawing, FLATTEN / metres))
    except PlanError:
        raise
    except Exception as exc:
        raise PlanError(f"{where}: the drawing is damaged; {type(exc).__name__} in its entities.") from exc
    shapes = [(layer, shapely.transform(g, lambda xy: xy * metres)) for layer, g in drawn]
    free, solid, repairs = space_of(shapes, where)
    return make_plan(free, name=path.stem, solid=solid, source=where, repairs=repairs)


def _unit(drawing: Any, units: str | None, where: str) -> float:
    code = drawing.header.get("$INSUNITS", 0)
    if units is not None:
        return metres_per(units, where)
    if code not in UNITS:
        raise PlanError(f"{where}: the drawing does not say its unit ($INSUNITS is {code}); give units, such as 'mm'.")
    return metres_per(UNITS[code], where)


def _shapes(drawing: Any, sagitta: float) -> Iterator[tuple[str, BaseGeometry]]:
    """Yield the lines of the model space with their layers; blocks are taken apart."""
    path_module = need("ezdxf.path", "DXF")
    waiting = [(entity, entity.dxf.layer) for entity in drawing.modelspace()]
    while waiting:
        entity, layer = waiting.pop()
        kind = entity.dxftype()
        if kind == "INSERT":
            # What a block draws on layer 0 belongs to the layer that the block is put on.
            parts = list(entity.virtual_entities())
            waiting += [(part, layer if part.dxf.layer == "0" else part.dxf.layer) for part in parts]
        elif kind in CURVES:
            outline = path_module.make_path(entity)
            xy = np.array([(p.x, p.y) for p in outline.flattening(sagitta)])
            if len(xy) > 1 and np.ptp(xy, axis=0).any():
                closed = bool(getattr(entity, "closed", False) or getattr(entity, "is_closed", False))
                ring = np.vstack([xy, xy[:1]]) if closed and not np.allclose(xy[0], xy[-1]) else xy
                yield layer, shapely.LineString(ring)
