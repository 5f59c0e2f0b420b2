"""The floor plan: free space in metres, with what its source said about doors and names."""

from dataclasses import dataclass, field

import numpy as np
import shapely
from numpy.typing import NDArray

__all__ = ["FloorPlan", "FreeSpace", "Label", "Repair"]

FreeSpace = shapely.Polygon | shapely.MultiPolygon


@dataclass(frozen=True, slots=True)
class Repair:
    """One thing that was changed in the source so that it can be used.

    Attributes
    ----------
    kind : str
        What was done, in a word or two ("dropped part", "filled pin-hole").
    message : str
        One sentence for the report, with the place and the size.
    geometry : shapely.Geometry
        Where, in metres; drawn in red.
    """

    kind: str
    message: str
    geometry: shapely.Geometry


@dataclass(frozen=True, slots=True)
class Label:
    """A name, and if the source numbers its rooms a number, for the cell that contains a point.

    Attributes
    ----------
    point : tuple of float
        x and y, metres.
    name : str
        May be empty.
    number : int or None
        Number of the cell as people see it, from 1.
    """

    point: tuple[float, float]
    name: str = ""
    number: int | None = None


@dataclass(frozen=True, slots=True)
class FloorPlan:
    """Where a body can be, in metres, x right and y up. Its walls are the boundary of its free space.

    Made by :func:`maps.read_plan` or :func:`maps.make_plan`, which validate and repair; the constructor checks nothing.

    Attributes
    ----------
    name : str
        What to call it; also the stem of output files.
    space : shapely.Polygon or shapely.MultiPolygon
        Free space: valid, with holes, on a grid of one millimetre. A MultiPolygon where parts of it do not touch.
    doors : tuple of shapely.LineString
        Door segments that the source has, each with two points, from jamb to jamb.
    labels : tuple of Label
        Names and numbers of rooms that the source has.
    start : tuple of int
        Numbers of the cells in which a team starts unless told otherwise, from 1; empty where the source has none.
    source : str
        Where it came from: a file, or "bundled".
    repairs : tuple of Repair
        What was changed, in the order in which it was done.
    """

    name: str
    space: FreeSpace
    doors: tuple[shapely.LineString, ...] = ()
    labels: tuple[Label, ...] = ()
    start: tuple[int, ...] = ()
    source: str = ""
    repairs: tuple[Repair, ...] = field(default=())

    @property
    def parts(self) -> tuple[shapely.Polygon, ...]:
        """Connected parts of the free space, the largest first."""
        parts = [g for g in shapely.get_parts(self.space) if isinstance(g, shapely.Polygon)]
        return tuple(sorted(parts, key=lambda p: (-p.area, p.bounds)))

    @property
    def area(self) -> float:
        """Area of the free space in square metres."""
        return float(self.space.area)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Smallest x, smallest y, largest x and largest y, in metres."""
        x0, y0, x1, y1 = self.space.bounds
        return float(x0), float(y0), float(x1), float(y1)

    @property
    def walls(self) -> NDArray[np.float64]:
        """Wall segments, shape (W, 2, 2): every edge of every ring of the free space, in metres."""
        # get_rings finds none in a MultiPolygon.
        rings = shapely.get_rings(shapely.get_parts(self.space))
        coords, ring = shapely.get_coordinates(rings, return_index=True)
        follows = ring[1:] == ring[:-1]
        return np.stack([coords[:-1][follows], coords[1:][follows]], axis=1)
