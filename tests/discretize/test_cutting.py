"""Cell maps: portals, checkpoints, routes, refusals and the invariant check."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, reject, settings

from discretize import METHODS, DiscretizeError, check_cells, convex_cells
from maps import FloorPlan
from tests.discretize.plans import grid_of_rooms, on_grid, pixel_plans, shard_plans, two_halls

RADIUS = 0.2


def places(plan, radius, slack=0.001):
    """Where a body can be, by GEOS alone: no nearer to a wall than the radius and a millimetre."""
    return shapely.set_precision(plan.space, 0).buffer(-radius - slack, quad_segs=64)


def clearance(plan, line):
    return shapely.LineString(line).distance(plan.space.boundary)


def check_map(cellmap):
    """Everything but the count of components, by other means than the package's own."""
    plan, radius = cellmap.plan, cellmap.radius
    assert len(set(cellmap.edges)) == len(cellmap.portals)
    for portal in cellmap.portals:
        a, b = portal.cells
        assert a < b
        middle = shapely.Point(portal.segment.mean(axis=0))
        for cell in (cellmap.cells[a], cellmap.cells[b]):
            assert cell.boundary.distance(middle) < 1e-6
            assert cell.boundary.distance(shapely.Point(portal.point)) < 1e-6
        if cellmap.strict:  # other cells may touch along lines that bend
            assert portal.width >= 2 * radius
        for k, leg in zip(portal.cells, portal.legs, strict=True):
            assert len(leg) >= 2
            assert leg[0] == pytest.approx(cellmap.checkpoints[k], abs=1e-9)
            assert leg[-1] == pytest.approx(portal.point, abs=1e-9)
            assert clearance(plan, leg) >= radius - 1e-6
            assert plan.space.covers(shapely.LineString(leg))
    for cell, point in zip(cellmap.cells, cellmap.checkpoints, strict=True):
        if np.isnan(point[0]):
            held = cell.intersection(places(plan, radius)).area
            narrow = cell.intersection(places(plan, 2 * radius)).is_empty
            assert held < 0.05 or (held < 50 * radius**2 and narrow)
        else:
            assert cell.distance(shapely.Point(point)) < 1e-9
            assert clearance(plan, [point, point]) >= radius - 1e-6


@pytest.mark.parametrize("method", ["exact", "rooms"])
@pytest.mark.parametrize(("columns", "rows"), [(1, 1), (3, 1), (4, 3)])
def test_rooms_in_a_grid(columns, rows, method):
    plan = grid_of_rooms(columns, rows)
    cellmap = convex_cells(plan, method=method, radius=RADIUS)
    check_map(cellmap)
    report = check_cells(cellmap)
    assert report.problems == ()
    assert report.free_components == report.graph_components == 1
    assert report.coverage == pytest.approx(1, abs=1e-12)
    assert report.overlap <= 1e-12
    assert report.convexity >= 1 - report.tolerance - 1e-12
    assert report.area == plan.area
    assert method == "exact" or len(cellmap) == columns * rows
    crossed = [any(shapely.LineString(p.segment).equals(d) for p in cellmap.portals) for d in plan.doors]
    assert all(crossed)


def test_two_rooms_that_touch_along_a_door():
    cellmap = convex_cells(two_halls(), radius=RADIUS)
    check_map(cellmap)
    (portal,) = cellmap.portals
    assert portal.width == pytest.approx(1.0)
    assert portal.point == pytest.approx([6, 2])
    for leg, side in zip(portal.legs, (-1, 1), strict=True):
        assert leg[-2] == pytest.approx([6 + side * (RADIUS + 0.05), 2])


def test_checkpoint_is_the_centroid_where_a_body_can_stand_there():
    cellmap = convex_cells(grid_of_rooms(2, 2), radius=RADIUS)
    wide = [k for k, cell in enumerate(cellmap.cells) if cell.area > 10]
    assert wide
    for k in wide:
        assert cellmap.checkpoints[k] == pytest.approx(shapely.get_coordinates(cellmap.cells[k].centroid)[0])


def test_pocket_has_no_checkpoint_and_no_portal():
    space = on_grid(shapely.box(0, 0, 5, 4).union(shapely.box(5, 1, 8, 1.3)))
    plan = FloorPlan("pocket", space, doors=(shapely.LineString([(2, 0), (2, 4)]),))
    cellmap = convex_cells(plan, method="exact", radius=RADIUS)
    report = check_cells(cellmap)
    assert report.problems == ()
    for number in report.pockets:
        assert np.isnan(cellmap.checkpoints[number - 1]).all()
        assert cellmap.components[number - 1] == -1
        assert not any(number in edge for edge in report.edges)
    assert any(cellmap.cells[number - 1].bounds[2] == 8 for number in report.pockets)


def test_body_that_cannot_pass_the_middle_is_not_joined_there():
    """Two rooms and a passage of 0.3 m: two components for a body of 0.4 m, one for a body of 0.2 m."""
    space = on_grid(shapely.union_all([shapely.box(0, 0, 4, 4), shapely.box(4, 1, 6, 1.3), shapely.box(6, 0, 9, 4)]))
    extra = (shapely.LineString([(2, 0), (2, 4)]), shapely.LineString([(7, 0), (7, 4)]))
    plan = FloorPlan("neck", space, doors=extra)
    for radius, parts in ((0.2, 2), (0.1, 1)):
        report = check_cells(convex_cells(plan, radius=radius))
        assert report.problems == ()
        assert report.free_components == report.graph_components == parts


@pytest.mark.parametrize("method", ["exact", "rooms"])
@settings(max_examples=100, deadline=None)
@given(plan=pixel_plans(pixel=1.0))
def test_bitmaps(method, plan):
    check_any(plan, method, 0.2)


@pytest.mark.parametrize("method", ["exact", "rooms"])
@settings(max_examples=100, deadline=None)
@given(plan=shard_plans())
def test_shards(method, plan):
    check_any(plan, method, 0.1)


def check_any(plan, method, radius):
    try:
        cellmap = convex_cells(plan, method=method, radius=radius)
    except DiscretizeError:
        reject()
    check_map(cellmap)
    report = check_cells(cellmap)
    assert [p for p in report.problems if "connected parts" not in p] == []
    # a cell that a body can enter from two sides but not cross belongs to one side, so parts can only be left out
    joined = {(a, b) for a, b in cellmap.edges}
    reach = shapely.get_parts(places(plan, radius, slack=-0.001))  # a gap of just the body's width joins
    for a, b in joined:
        both = [r for r in reach if all(r.distance(shapely.Point(cellmap.checkpoints[k])) < 0.05 for k in (a, b))]
        assert both


@pytest.mark.parametrize(
    ("plan", "radius", "words"),
    [
        (two_halls(door=0.8), 0.5, "1 m across fits through no door of plan 'halls': the widest is 0.8 m"),
        (FloorPlan("cross", shapely.box(0, 1, 3, 2).union(shapely.box(1, 0, 2, 3))), 0.6, "no passage of plan 'cross'"),
        (FloorPlan("closet", shapely.box(0, 0, 1, 1)), 0.5, "does not fit anywhere"),
        (two_halls(), -0.2, "positive length in metres, not -0.2"),
        (two_halls(), 1e308, "positive length in metres, not 1e+308; at most 100 are possible"),
        (two_halls(), float("nan"), "not nan"),
    ],
)
def test_refusals(plan, radius, words):
    with pytest.raises(DiscretizeError, match=r"^[^\n]*\.$") as caught:
        convex_cells(plan, radius=radius)
    assert words in str(caught.value)


def test_unknown_method_offers_the_nearest():
    with pytest.raises(DiscretizeError, match="did you mean 'exact'"):
        convex_cells(two_halls(), method="exakt")


def test_one_narrow_door_among_others_is_named():
    plan = grid_of_rooms(3, 1)
    narrow = shapely.box(4.0, 0, 4.1, 1.85)  # narrows the first doorway, 1.55 to 2.45, to 0.6 m
    plan = replace(plan, space=on_grid(plan.space.difference(narrow)))
    report = check_cells(convex_cells(plan, radius=0.35))
    assert report.blocked_doors == (1,)
    assert report.free_components == report.graph_components == 2
    assert report.problems == ()


@pytest.mark.parametrize("name", METHODS)
def test_every_method_says_what_it_is(name):
    method = METHODS[name]
    assert method.name == name
    assert method.summary
    assert method.source
    cut = method.cut(two_halls())
    assert 0 <= cut.tolerance < 1
    assert sum(cell.area for cell in cut.cells) == pytest.approx(two_halls().area)


def damaged(cellmap, kind):
    """A sound map with one thing broken."""
    cells, portals = list(cellmap.cells), list(cellmap.portals)
    if kind == "cell left out":
        cells[0] = shapely.box(*cells[0].bounds[:2], *np.array(cells[0].bounds[:2]) + 0.5)
    elif kind == "overlap":
        cells[0] = cells[0].union(shapely.box(*cells[0].bounds)).buffer(0.3, join_style="mitre")
    elif kind == "portal left out":
        portals.pop()
    elif kind == "portal twice":
        portals.append(portals[0])
    elif kind == "portal in a wall":
        portals.append(replace(portals[0], cells=(0, len(cells) - 1)))
    elif kind == "route through a wall":
        a, b = portals[0].legs
        portals[0] = replace(portals[0], legs=(np.array([a[0], [-5.0, -5.0], a[-1]]), b))
    elif kind == "route from elsewhere":
        a, b = portals[0].legs
        portals[0] = replace(portals[0], legs=(a + [[0.1, 0]] * len(a), b))
    elif kind == "not convex":
        a, b = cellmap.portals[0].cells
        cells[a] = cells[a].union(cells[b])
        cells[b] = shapely.box(0, 0, 0.1, 0.1)
    return replace(cellmap, cells=tuple(cells), portals=tuple(portals))


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("cell left out", "lie in no cell"),
        ("overlap", "in two cells or outside"),
        ("portal left out", "there is no portal"),
        ("portal twice", "more than one portal"),
        ("portal in a wall", "the body cannot go there"),
        ("route through a wall", "too near to a wall"),
        ("route from elsewhere", "does not lead from its checkpoint"),
        ("not convex", "of its convex hull; at least 1 was promised"),
    ],
)
def test_check_finds_what_is_broken(kind, words):
    plan = grid_of_rooms(3, 2)
    cellmap = convex_cells(plan, method="exact", radius=RADIUS)
    assert check_cells(cellmap).problems == ()
    problems = check_cells(damaged(cellmap, kind)).problems
    assert any(words in p for p in problems), problems
