"""Floor plans for tests: small ones drawn here, hostile ones drawn by hypothesis."""

import numpy as np
import shapely
from hypothesis import strategies as st

from maps import FloorPlan

GRID = 1e-3


def on_grid(geometry):
    """Polygons of a geometry on the grid of a millimetre; None where none is left."""
    parts = [p for p in shapely.get_parts(shapely.set_precision(geometry, GRID)) if isinstance(p, shapely.Polygon)]
    if not parts:
        return None
    return parts[0] if len(parts) == 1 else shapely.MultiPolygon(parts)


def grid_of_rooms(columns, rows, room=4.0, wall=0.1, door=0.9, doors=None):
    """Square rooms in a grid that touch along door segments from jamb to jamb, with the plan's doors.

    ``doors`` names pairs of rooms, counted from 0 row by row from below; all neighbours where it is None.
    """
    step = room + wall
    centre = {j * columns + i: (i * step + room / 2, j * step + room / 2) for j in range(rows) for i in range(columns)}
    pairs = [(k, k + 1) for k in centre if (k + 1) % columns] + [
        (k, k + columns) for k in centre if k + columns in centre
    ]
    shapes = {k: shapely.box(x - room / 2, y - room / 2, x + room / 2, y + room / 2) for k, (x, y) in centre.items()}
    segments = []
    for a, b in pairs if doors is None else doors:
        (x, y), (u, v) = centre[a], centre[b]
        mx, my = (x + u) / 2, (y + v) / 2
        # the doorway belongs to the lower room: its far side is the door
        if u > x:
            shapes[a] = shapes[a].union(shapely.box(mx - wall / 2, my - door / 2, mx + wall / 2, my + door / 2))
            segments.append(shapely.LineString([(mx - wall / 2, my - door / 2), (mx - wall / 2, my + door / 2)]))
        else:
            shapes[a] = shapes[a].union(shapely.box(mx - door / 2, my - wall / 2, mx + door / 2, my + wall / 2))
            segments.append(shapely.LineString([(mx - door / 2, my - wall / 2), (mx + door / 2, my - wall / 2)]))
    space = on_grid(shapely.union_all(list(shapes.values())))
    return FloorPlan("rooms", space, doors=tuple(shapely.set_precision(s, GRID) for s in segments))


def two_halls(door=1.0, height=4.0, width=6.0):
    """Two rooms that touch exactly along a door segment from wall tip to wall tip, as convex hulls."""
    low, high = (height - door) / 2, (height + door) / 2
    left = shapely.Polygon([(0, 0), (width - 1, 0), (width, low), (width, high), (width - 1, height), (0, height)])
    right = shapely.Polygon(
        [(2 * width, 0), (2 * width, height), (width + 1, height), (width, high), (width, low), (width + 1, 0)]
    )
    return FloorPlan("halls", on_grid(left.union(right)), doors=(shapely.LineString([(width, low), (width, high)]),))


@st.composite
def pixel_plans(draw, side=9, pixel=0.5):
    """Free space of a bitmap: rectilinear, with holes and corners that touch."""
    width, height = draw(st.integers(1, side)), draw(st.integers(1, side))
    free = draw(st.lists(st.booleans(), min_size=width * height, max_size=width * height).filter(any))
    squares = [
        shapely.box(pixel * (k % width), pixel * (k // width), pixel * (k % width + 1), pixel * (k // width + 1))
        for k in np.flatnonzero(free)
    ]
    return FloorPlan("pixels", shapely.union_all(squares))


@st.composite
def shard_plans(draw, size=5000):
    """Free space of a square less triangles and thin walls: slivers, holes, sharp corners; ends of doors anywhere."""
    point = st.tuples(st.integers(-500, size + 500), st.integers(-500, size + 500))
    space = shapely.box(0, 0, size * GRID, size * GRID)
    for corners in draw(st.lists(st.lists(point, min_size=3, max_size=4, unique=True), max_size=6)):
        space = space.difference(shapely.MultiPoint(np.array(corners) * GRID).convex_hull.buffer(0))
    for ends in draw(st.lists(st.lists(point, min_size=2, max_size=2, unique=True), max_size=4)):
        space = space.difference(shapely.LineString(np.array(ends) * GRID).buffer(0.02, quad_segs=1, cap_style="flat"))
    space = on_grid(space) or shapely.box(0, 0, 1, 1)
    rings = list(shapely.get_rings(shapely.get_parts(space)))
    place = st.tuples(st.integers(0, len(rings) - 1), st.floats(0, 1))
    doors = []
    for ends in draw(st.lists(st.tuples(place, place), max_size=3)):
        xy = np.round([shapely.get_coordinates(rings[k].interpolate(at, normalized=True))[0] for k, at in ends], 3)
        if np.hypot(*(xy[1] - xy[0])) > 0.1:
            doors.append(shapely.LineString(xy))
    return FloorPlan("shards", space, doors=tuple(doors))
