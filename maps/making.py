"""The door to floor plans: validate, repair, normalise and freeze once, so that nothing behind it checks again."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from maps.errors import PlanError
from maps.floorplan import FloorPlan, FreeSpace, Label, Repair

__all__ = ["BODY", "GRID", "SMALLEST_PART", "make_plan"]

GRID = 0.001
"""Every coordinate of a plan is a multiple of this, metres."""

BODY = 0.25
"""A part of the free space counts if a disc of this radius fits into it, metres ..."""

SMALLEST_PART = 0.5
"""... and it has at least this area, square metres."""

LARGEST_EXTENT = 10_000.0
MOST_VERTICES = 2_000_000
# A needle is a corner whose sides are no further apart at the end of the shorter one than this, metres.
NEEDLE = 0.005


def make_plan(
    space: BaseGeometry | Iterable[BaseGeometry],
    *,
    name: str,
    solid: Iterable[BaseGeometry] = (),
    doors: Iterable[BaseGeometry] = (),
    labels: Iterable[Label] = (),
    start: Sequence[int] = (),
    source: str = "",
    repairs: Iterable[Repair] = (),
) -> FloorPlan:
    """Make a floor plan from polygons that may be broken.

    Polygons that overlap or touch along an edge become one free space, whose coordinates are rounded to a millimetre
    and whose vertices within half a millimetre of a straight wall are left out. Whatever changes more than that is
    listed in the repairs of the plan: broken rings, walls and crevices without width, needles, and parts that are too
    small for a person (see ``BODY`` and ``SMALLEST_PART``). The same free space gives the same plan whatever the
    order, direction and first vertex of its rings.

    Parameters
    ----------
    space : shapely geometry or iterable of them
        Polygons, multipolygons or collections of these, in metres.
    name : str
        What to call the plan.
    solid : iterable of shapely geometry
        Polygons of walls and obstacles that are cut out of the space, metres.
    doors : iterable of shapely.LineString
        Door segments from jamb to jamb, metres.
    labels : iterable of Label
        Names and numbers of rooms.
    start : sequence of int
        Cells in which a team starts, numbered from 1.
    source : str
        Where it comes from; errors begin with it.
    repairs : iterable of Repair
        What a reader has already changed.

    Raises
    ------
    PlanError
        If there is no polygon, a coordinate is not finite, the plan is more than 10 km across or has more than two
        million vertices, or nothing of it is large enough for a person.
    """
    where = source or name
    done = list(repairs)
    polygons = _polygons(space, where, "free space is made")
    if not polygons:
        raise PlanError(f"{where}: there is no free space in it, no polygon at all.")
    walls = _polygons(solid, where, "walls and obstacles are made")
    _check_size(polygons + walls, where)
    free = shapely.union_all([_mend(polygon, done) for polygon in polygons], grid_size=GRID)
    if walls:
        cut = shapely.union_all([_mend(wall, done) for wall in walls], grid_size=GRID)
        free = _without(free, cut)
    free = _without_needles(free, done)
    free = _without_specks(free, where, done)
    simple = shapely.simplify(free, GRID / 2, preserve_topology=True)
    free = _canonical(simple if simple.is_valid else free)
    return FloorPlan(
        name=name,
        space=free,
        doors=tuple(_doors(doors, free, where, done)),
        labels=tuple(_labels(labels, free, where, done)),
        start=_start(start, where),
        source=source,
        repairs=tuple(done),
    )


def _polygons(space: BaseGeometry | Iterable[BaseGeometry], where: str, what: str) -> list[shapely.Polygon]:
    """Take geometries apart into polygons; empty ones are left out."""
    given = [space] if isinstance(space, BaseGeometry) else list(space)
    found: list[shapely.Polygon] = []
    for geometry in given:
        if not isinstance(geometry, BaseGeometry):
            raise PlanError(f"{where}: {what} of polygons, not of {type(geometry).__name__}.")
        for part in _flatten(shapely.force_2d(geometry)):
            if not isinstance(part, shapely.Polygon):
                raise PlanError(f"{where}: {what} of polygons, not of {part.geom_type}.")
            if not part.is_empty:
                found.append(part)
    return found


def _flatten(geometry: BaseGeometry) -> list[BaseGeometry]:
    if isinstance(geometry, shapely.GeometryCollection | shapely.MultiPolygon):
        return [part for member in geometry.geoms for part in _flatten(member)]
    return [geometry]


def _check_size(polygons: list[shapely.Polygon], where: str) -> None:
    xy = shapely.get_coordinates(polygons)
    if len(xy) > MOST_VERTICES:
        raise PlanError(f"{where}: {len(xy)} vertices are too many; at most {MOST_VERTICES} are possible.")
    bad = np.flatnonzero(~np.isfinite(xy).all(axis=1))
    if len(bad):
        x, y = xy[bad[0]]
        raise PlanError(f"{where}: vertex {bad[0] + 1} is ({x:g}, {y:g}); coordinates must be finite numbers.")
    width, height = np.ptp(xy, axis=0)
    if max(width, height) > LARGEST_EXTENT:
        raise PlanError(
            f"{where}: the plan is {width:.0f} m x {height:.0f} m; at most 10 km are possible. Are its units metres?"
        )
    # Beyond this, numbers of 64 bits cannot hold a millimetre.
    if np.abs(xy).max() > 1e11:
        raise PlanError(f"{where}: the coordinate {np.abs(xy).max():g} m is too far from the origin for millimetres.")


def _mend(polygon: shapely.Polygon, done: list[Repair]) -> BaseGeometry:
    """Make one polygon valid on the millimetre grid, and list what that took."""
    valid: BaseGeometry = polygon
    broken = not polygon.is_valid
    if broken:
        reason, _, place = shapely.is_valid_reason(polygon).partition("[")
        valid = shapely.make_valid(polygon, method="structure", keep_collapsed=False)
        at = ", ".join(place.rstrip("]").split())
        message = f"A broken ring ({reason.lower()} at ({at})) was mended; it now holds {valid.area:.3g} square metres."
        done.append(Repair("mended ring", message, polygon.boundary))
    snapped = shapely.set_precision(valid, GRID)
    if broken or shapely.get_num_coordinates(snapped) < shapely.get_num_coordinates(valid):
        lost = _lost_edges(polygon, snapped)
        if not lost.is_empty:
            message = f"{lost.length:.3g} m of walls or crevices thinner than a millimetre {_near(lost)} were removed."
            done.append(Repair("removed spike", message, lost))
    return snapped


def _lost_edges(polygon: shapely.Polygon, snapped: BaseGeometry) -> shapely.MultiLineString:
    """Find the edges of a polygon that have an end of which nothing is left after snapping."""
    xy, ring = shapely.get_coordinates(shapely.get_rings(polygon), return_index=True)
    boundary = snapped.boundary
    shapely.prepare(boundary)
    gone = ~np.asarray(shapely.dwithin(boundary, shapely.points(xy), 3 * GRID))
    lost = (gone[1:] | gone[:-1]) & (ring[1:] == ring[:-1]) & (xy[1:] != xy[:-1]).any(axis=1)
    return shapely.MultiLineString(list(np.stack([xy[:-1][lost], xy[1:][lost]], axis=1)))


def _without(free: BaseGeometry, cut: BaseGeometry) -> BaseGeometry:
    """Cut something out; on a grid that may leave lines and points behind, which are no space."""
    rest = shapely.get_parts(shapely.difference(free, cut, grid_size=GRID))
    return shapely.MultiPolygon([part for part in rest if isinstance(part, shapely.Polygon)])


def _without_needles(free: BaseGeometry, done: list[Repair]) -> BaseGeometry:
    """Cut off corners of the free space that end in a point too fine for anything; needles of wall stay."""
    needles = [triangle for ring in shapely.get_rings(shapely.get_parts(free)) for triangle in _needles(ring, free)]
    if not needles:
        return free
    cut = shapely.union_all(needles, grid_size=GRID)
    message = f"{len(needles)} needle(s) of free space, the first {_near(needles[0])}, were cut off."
    done.append(Repair("removed spike", message, cut))
    return _without(free, cut)


def _needles(ring: shapely.LinearRing, free: BaseGeometry) -> list[shapely.Polygon]:
    xy = shapely.get_coordinates(ring)[:-1]
    before, after = np.roll(xy, 1, axis=0) - xy, np.roll(xy, -1, axis=0) - xy
    a, b = np.hypot(*before.T), np.hypot(*after.T)
    short = np.minimum(a, b)
    mouth = np.hypot(*((before / a[:, None] - after / b[:, None]) * short[:, None]).T)
    sharp = np.flatnonzero((mouth <= NEEDLE) & (short > 10 * mouth))
    tips = (
        shapely.Polygon([xy[i], xy[i] + before[i] / a[i] * short[i], xy[i] + after[i] / b[i] * short[i]]) for i in sharp
    )
    return [t for t in tips if t.area > 0 and free.covers(t.representative_point())]


def _without_specks(free: BaseGeometry, where: str, done: list[Repair]) -> BaseGeometry:
    """Drop the parts in which no person could be."""
    parts = shapely.get_parts(free)
    parts = parts[shapely.area(parts) > 0]
    fits = (shapely.area(parts) >= SMALLEST_PART) & ~shapely.is_empty(shapely.buffer(parts, -BODY, quad_segs=4))
    rule = f"smaller than {SMALLEST_PART} square metres or too narrow for a disc of {2 * BODY} m"
    if not fits.any():
        size = f"; it is {_size(free)}. Are its units metres?" if len(parts) else "."
        raise PlanError(f"{where}: there is no free space in it for a person{size}")
    dropped = parts[~fits]
    if len(dropped):
        largest = dropped[np.argmax(shapely.area(dropped))]
        message = (
            f"{len(dropped)} part(s) of the free space, {rule}, were dropped: {shapely.area(dropped).sum():.3g} square "
            f"metres in all, the largest of {largest.area:.3g} {_near(largest)}."
        )
        done.append(Repair("dropped part", message, shapely.MultiPolygon(list(dropped))))
    return shapely.MultiPolygon(list(parts[fits]))


def _size(geometry: BaseGeometry) -> str:
    x0, y0, x1, y1 = geometry.bounds
    return f"{x1 - x0:.3g} m x {y1 - y0:.3g} m with {geometry.area:.3g} square metres"


def _canonical(free: BaseGeometry) -> FreeSpace:
    """Fix order, direction and first vertex of the rings; one part is a Polygon, several are a MultiPolygon."""
    free = shapely.orient_polygons(shapely.normalize(free))
    parts = [p for p in shapely.get_parts(free) if isinstance(p, shapely.Polygon)]
    return parts[0] if len(parts) == 1 else shapely.MultiPolygon(parts)


def _doors(doors: Iterable[BaseGeometry], free: FreeSpace, where: str, done: list[Repair]) -> list[shapely.LineString]:
    kept: list[shapely.LineString] = []
    for door in doors:
        if not isinstance(door, shapely.LineString) or door.is_empty:
            raise PlanError(f"{where}: a door is a LineString from jamb to jamb, not a {door.geom_type}.")
        ends = shapely.get_coordinates(door)[[0, -1]]
        if not np.isfinite(ends).all():
            raise PlanError(f"{where}: a door has the coordinates {ends.tolist()}; they must be finite numbers.")
        segment = shapely.LineString(np.round(ends, 3) + 0.0)
        if segment.length == 0:
            raise PlanError(f"{where}: the door {_near(segment)} has no width.")
        if door.length > segment.length + GRID:
            done.append(Repair("straightened door", f"The door {_near(door)} was made one straight segment.", door))
        if free.distance(segment) > 10 * GRID:
            done.append(
                Repair("dropped door", f"The door {_near(segment)} is not on the free space and was dropped.", segment)
            )
        else:
            kept.append(segment)
    return kept


def _labels(labels: Iterable[Label], free: FreeSpace, where: str, done: list[Repair]) -> list[Label]:
    kept: list[Label] = []
    numbers: set[int] = set()
    for label in labels:
        if not np.isfinite(label.point).all():
            raise PlanError(
                f"{where}: the label {label.name!r} is at {label.point}; coordinates must be finite numbers."
            )
        if label.number is not None and (label.number < 1 or label.number in numbers):
            raise PlanError(f"{where}: the room number {label.number} must be 1 or more and be there once only.")
        numbers.update([] if label.number is None else [label.number])
        x, y = (round(float(v), 3) + 0.0 for v in label.point)
        point = shapely.Point(x, y)
        if free.covers(point):
            kept.append(Label((x, y), label.name, label.number))
        else:
            message = (
                f"The label {label.name or label.number!r} {_near(point)} is not in the free space and was dropped."
            )
            done.append(Repair("dropped label", message, point))
    return kept


def _start(start: Sequence[int], where: str) -> tuple[int, ...]:
    for number in start:
        if isinstance(number, bool) or not isinstance(number, int) or number < 1:
            raise PlanError(f"{where}: start is a list of cell numbers from 1, and {number!r} is not one.")
    return tuple(start)


def _near(geometry: BaseGeometry) -> str:
    """Say where something is."""
    point = shapely.point_on_surface(geometry)
    return "nowhere" if point.is_empty else f"near ({point.x:.2f}, {point.y:.2f})"
