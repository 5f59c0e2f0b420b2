"""Ways across a large region, over the triangles that fill it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.sparse import csr_array

__all__ = ["NavMesh", "navmesh_of"]


@dataclass(frozen=True, slots=True)
class NavMesh:
    """Triangles of a region, and the graph of the edges that they share.

    Attributes
    ----------
    tree : shapely.STRtree
        Index of the T triangles.
    doors : ndarray, shape (T, 3)
        Shared edges of each triangle, -1 where an edge is on the boundary.
    edges : ndarray, shape (m, 2, 2)
        Ends of the edges that triangles share, metres.
    graph : csr_array, shape (m, m)
        Distances between the middles of edges of one triangle, metres.
    """

    tree: shapely.STRtree
    doors: NDArray[np.intp]
    edges: NDArray[np.float64]
    graph: csr_array

    def corners(self, start: NDArray[np.float64], goal: NDArray[np.float64]) -> NDArray[np.float64]:
        """Corners of the triangles on a short way, shape (k, 2): at some of them the shortest such way bends.

        There are none where start or goal lies in no triangle, in the same one, or where they are not joined.

        Parameters
        ----------
        start, goal : ndarray, shape (2,)
            Metres.
        """
        from scipy.sparse.csgraph import dijkstra

        ends = [self._doors_at(point) for point in (start, goal)]
        if not all(len(end) for end in ends):
            return np.empty((0, 2))
        middles = self.edges.mean(axis=1)
        far, before = dijkstra(self.graph, directed=False, indices=ends[0], return_predecessors=True)
        total = far[:, ends[1]]
        total += np.hypot(*(middles[ends[0]] - start).T)[:, None] + np.hypot(*(middles[ends[1]] - goal).T)
        i, j = np.unravel_index(int(total.argmin()), total.shape)
        if not np.isfinite(total[i, j]):
            return np.empty((0, 2))
        path = [int(ends[1][j])]
        while path[-1] != ends[0][i]:
            path.append(int(before[i, path[-1]]))
        return np.unique(self.edges[path].reshape(-1, 2), axis=0)

    def _doors_at(self, point: NDArray[np.float64]) -> NDArray[np.intp]:
        at = self.tree.query(shapely.Point(point), predicate="dwithin", distance=1e-9)
        doors = np.unique(self.doors[at])
        return doors[doors >= 0]


def navmesh_of(region: shapely.Polygon) -> NavMesh:
    """Triangulate a region.

    Parameters
    ----------
    region : shapely.Polygon
        Metres.
    """
    from scipy.sparse import csr_array

    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(region))
    corners = shapely.get_coordinates(triangles).reshape(-1, 4, 2)[:, :3]
    xy, index = np.unique(corners.reshape(-1, 2), axis=0, return_inverse=True)
    index = index.reshape(-1, 3)
    sides = np.sort(np.stack([index, np.roll(index, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    edges, side, uses = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    inner = uses == 2
    doors = np.where(inner, np.cumsum(inner) - 1, -1)[side.ravel()].reshape(-1, 3)
    shared = xy[edges[inner]]
    middles = shared.mean(axis=1)
    pairs = np.concatenate([doors[:, [0, 1]], doors[:, [1, 2]], doors[:, [2, 0]]])
    pairs = pairs[(pairs >= 0).all(axis=1)]
    length = np.hypot(*(middles[pairs[:, 0]] - middles[pairs[:, 1]]).T)
    graph = csr_array((length, (pairs[:, 0], pairs[:, 1])), shape=(len(middles), len(middles)))
    return NavMesh(shapely.STRtree(list(triangles)), doors, shared, graph)
