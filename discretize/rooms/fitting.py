"""From chosen faces back to the true free space: cells that cover it exactly and do not overlap."""

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.rooms.cuts import ring_segments
from discretize.rooms.faces import Faces
from discretize.rooms.rays import Walls

__all__ = ["fit"]


def fit(space: shapely.Geometry, faces: Faces, owner: NDArray[np.intp], reach: float) -> list[shapely.Polygon]:
    """Cut the free space along the boundaries between chosen cells."""
    unions = [shapely.coverage_union_all(faces.polygons[owner == k]) for k in range(owner.max() + 1)]
    kept = _boundaries(faces, owner)
    parts = shapely.get_parts(shapely.line_merge(kept))
    walls = Walls(ring_segments(space))
    lines = [_reach_out(line, walls, reach) for line in parts[shapely.length(parts) > 0]]
    linework = shapely.union_all([shapely.boundary(space), *lines])
    pieces = shapely.get_parts(shapely.polygonize(shapely.get_parts(linework)))
    shapely.prepare(space)
    pieces = pieces[shapely.intersects(space, shapely.point_on_surface(pieces))]
    tree = shapely.STRtree(unions)
    piece, cell = tree.query(pieces, predicate="intersects")
    shared = shapely.area(shapely.intersection(pieces[piece], np.array(unions, dtype=object)[cell]))
    best = np.full(len(pieces), -1)
    order = np.argsort(shared, kind="stable")
    best[piece[order]] = cell[order]
    groups = []
    for k in range(len(unions)):
        if (best == k).any():
            groups += shapely.get_parts(shapely.union_all(pieces[best == k])).tolist()
    return groups


def _boundaries(faces: Faces, owner: NDArray[np.intp]) -> shapely.Geometry:
    """Return the lines along which faces of different cells touch."""
    split = [
        shapely.intersection(shapely.boundary(faces.polygons[i]), shapely.boundary(faces.polygons[j]))
        for i, j in faces.borders
        if owner[i] != owner[j]
    ]
    return shapely.union_all([g for line in split for g in shapely.get_parts(line) if g.geom_type == "LineString"])


def _reach_out(line: shapely.LineString, walls: Walls, reach: float) -> shapely.LineString:
    """Carry both ends of a line on until they meet a wall of the true free space."""
    p = shapely.get_coordinates(line)
    ends = np.array([p[0], p[-1]])
    d = np.array([p[0] - p[1], p[-1] - p[-2]])
    d = d / np.hypot(*d.T)[:, None]
    far = np.minimum(walls.hits(ends, d, np.full(2, reach), skip=0.0) + 1e-6, reach)
    hit = far < reach
    extra = ends + np.where(hit, far, 0.0)[:, None] * d
    return shapely.LineString(np.concatenate([extra[:1], p, extra[1:]]))
