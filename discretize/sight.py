"""Which places of a floor plan see each other."""

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.sharing import segment_tree
from maps import FloorPlan

__all__ = ["Sight"]

_HAIR = 1e-6
"""A line of sight may graze a wall by this much, metres: in doubt, places see each other."""


class Sight:
    """Lines of sight in the free space of a plan.

    Parameters
    ----------
    plan : FloorPlan
        Its walls are in the way.
    doors : ndarray, shape (k, 2, 2)
        Segments that are in the way, too, metres; a line that touches one or runs along it is free.
    """

    def __init__(self, plan: FloorPlan, doors: NDArray[np.float64] | None = None) -> None:
        space = shapely.set_precision(plan.space, 0).buffer(_HAIR, join_style="mitre")
        self._walls = shapely.multilinestrings(list(shapely.get_rings(shapely.get_parts(space))))
        shapely.prepare(self._walls)
        self._doors = np.empty((0, 2, 2)) if doors is None else doors
        self._tree = segment_tree(self._doors)

    def between(self, a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Tell whether each place of ``a`` sees the one of ``b`` beside it.

        Parameters
        ----------
        a, b : ndarray, shape (k, 2)
            Places in free space, metres.
        """
        lines = np.stack([a, b], axis=1)
        sees = np.asarray(~shapely.intersects(self._walls, shapely.linestrings(lines)), dtype=np.bool_)
        free = np.flatnonzero(sees)
        which, door = self._tree.query(shapely.linestrings(lines[free]))
        crossed = _parts(lines[free[which]], self._doors[door]) & _parts(self._doors[door], lines[free[which]])
        sees[free[which[crossed]]] = False
        return sees

    def among(self, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Tell for every pair of places whether they see each other, shape (k, k), true on the diagonal."""
        i, j = np.triu_indices(len(points), 1)
        sees = np.eye(len(points), dtype=np.bool_)
        sees[i, j] = sees[j, i] = self.between(points[i], points[j])
        return sees


def _parts(lines: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Tell whether each line keeps the ends of the other segment clearly apart."""
    way = lines[:, 1] - lines[:, 0]
    normal = np.stack([-way[:, 1], way[:, 0]], axis=1) / np.hypot(*way.T)[:, None]
    off = np.einsum("kpc,kc->kp", others - lines[:, :1], normal)
    return np.asarray((off.min(axis=1) < -_HAIR) & (off.max(axis=1) > _HAIR))
