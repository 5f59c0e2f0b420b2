"""What a method of cutting returns: cells, and what to know about them."""

from collections.abc import Sequence
from dataclasses import dataclass

import shapely

__all__ = ["Partition"]


@dataclass(frozen=True, slots=True)
class Partition:
    """The free space of a plan cut into polygons.

    Attributes
    ----------
    cells : sequence of shapely.Polygon
        They cover the free space and do not overlap.
    tolerance : float
        Largest share of its convex hull that a cell may miss.
    strict : bool
        Whether every cell keeps to the tolerance as it is drawn, and so has no holes. Otherwise it was judged with
        walls straightened, and with small obstacles and what is too narrow for a robot left out.
    notes : tuple of str
        One sentence for everything that was done otherwise than usual.
    """

    cells: Sequence[shapely.Polygon]
    tolerance: float
    strict: bool = True
    notes: tuple[str, ...] = ()
