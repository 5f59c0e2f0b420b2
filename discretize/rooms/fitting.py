"""From chosen faces back to the true free space: cells that cover it exactly and do not overlap."""

from collections.abc import Callable

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize.rooms.cuts import ring_segments
from discretize.rooms.faces import GRID, Faces
from discretize.rooms.frame import Frame
from discretize.rooms.rays import Walls
from discretize.sharing import points_of

__all__ = ["fit"]

Array = NDArray[np.float64]

CLOSE = 2 * GRID  # metres; corners are on the grid in either frame


def fit(
    space: shapely.Geometry, frame: Frame, faces: Faces, owner: NDArray[np.intp], reach: float
) -> list[shapely.Polygon]:
    """Cut the free space along the boundaries between chosen cells.

    Parameters
    ----------
    space : shapely.Geometry
        Free space, metres.
    frame : Frame
        Of the faces.
    faces : Faces
        Of the plan's structure.
    owner : ndarray of int, shape (F,)
        Cell of each face.
    reach : float
        How far a boundary is carried on to a wall, metres.
    """
    unions = [shapely.coverage_union_all(faces.polygons[owner == k]) for k in range(owner.max() + 1)]
    parts = shapely.get_parts(shapely.line_merge(_boundaries(faces, owner)))
    snap = _snap(shapely.get_coordinates(space))
    parts = shapely.transform(shapely.set_precision(parts, 0), lambda xy: snap(frame.outward(xy)))
    parts = shapely.remove_repeated_points(parts)
    walls = Walls(ring_segments(space))
    lines = [_reach_out(line, walls, reach) for line in parts[shapely.length(parts) > 0]]
    linework = shapely.union_all([shapely.boundary(space), *lines])
    pieces = shapely.get_parts(shapely.polygonize(shapely.get_parts(linework)))
    shapely.prepare(space)
    pieces = pieces[shapely.intersects(space, shapely.point_on_surface(pieces))]
    tree = shapely.STRtree(unions)
    inward = shapely.transform(shapely.set_precision(pieces, 0), frame.inward)
    piece, cell = tree.query(inward, predicate="intersects")
    shared = shapely.area(shapely.intersection(inward[piece], np.array(unions, dtype=object)[cell]))
    best = np.full(len(pieces), -1)
    order = np.argsort(shared, kind="stable")
    best[piece[order]] = cell[order]
    groups = []
    for k in range(len(unions)):
        if (best == k).any():
            groups += shapely.get_parts(shapely.union_all(pieces[best == k])).tolist()
    return groups


def _snap(corners: Array) -> Callable[[Array], Array]:
    """Return a function that moves places to the corner that they are, but for rounding in another frame."""
    tree = shapely.STRtree(points_of(corners))

    def snapped(places: Array) -> Array:
        near, corner = tree.query_nearest(points_of(places), max_distance=CLOSE, all_matches=False)
        places = places.copy()
        places[near] = corners[corner]
        return places

    return snapped


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
