"""Drawings whose lines have names, those of layers or of groups: which are walls, which is the space to walk in."""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from maps.errors import PlanError
from maps.floorplan import Repair
from maps.linework import enclosed

__all__ = ["space_of"]

FREE = re.compile(r"walk|free|room|space|corridor|hallway|raum", re.IGNORECASE)
SOLID = re.compile(r"obstacle|column|pillar|hindernis|st(ü|ue)tze", re.IGNORECASE)
WALL = re.compile(r"wall|wand|w(ä|ae)nde|mur|muro|pared|window|fenster|glaz|obstacle|column|pillar", re.IGNORECASE)
ASIDE = re.compile(
    r"door|t(ü|ue)r|porte|text|anno|dim|furn|möbel|hatch|title|defpoints|grid|axis|symbol|exit|journey|distribution",
    re.IGNORECASE,
)


def space_of(
    shapes: list[tuple[str, BaseGeometry]], where: str
) -> tuple[list[shapely.Polygon], list[shapely.Polygon], list[Repair]]:
    """Find the free space of a drawing.

    Closed lines that are named for walkable space are free, those named for obstacles or columns are not. Where nothing
    is named for walkable space, it is what walls enclose: the lines named for walls, or all lines but those named for
    doors, text and furniture if none is named for walls.

    Parameters
    ----------
    shapes : list of pairs of str and shapely geometry
        Lines with their names, metres.
    where : str
        What error sentences begin with.

    Returns
    -------
    free, solid : list of shapely.Polygon
        What to unite, and what to cut out of it.
    repairs : list of Repair
        What had to be done.

    Raises
    ------
    PlanError
        If there is nothing that could be a wall, or walls enclose no space.
    """
    free = _closed(g for name, g in shapes if FREE.search(name))
    solid = _closed(g for name, g in shapes if SOLID.search(name))
    if free:
        return free, solid, []
    lines = [g for name, g in shapes if WALL.search(name) and not ASIDE.search(name)]
    lines = lines or [g for name, g in shapes if not ASIDE.search(name)]
    if not lines:
        raise PlanError(f"{where}: there is no free space in it; the drawing has no lines that could be walls.")
    inside, repairs = enclosed(lines, where)
    return inside, solid, repairs


def _closed(lines: Iterable[BaseGeometry]) -> list[shapely.Polygon]:
    """Polygons of the lines that end where they begin."""
    rings = [shapely.get_coordinates(line) for line in lines]
    return [shapely.Polygon(xy) for xy in rings if len(xy) > 3 and np.allclose(xy[0], xy[-1])]
