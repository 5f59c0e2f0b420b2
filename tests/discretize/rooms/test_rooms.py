"""Rooms as people see them: found, whole, and the same however the plan is written."""

from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from discretize.rooms import room_cells, search
from discretize.rooms.search import mutual_sight
from maps import FloorPlan, Repair, read_plan
from tests.discretize.plans import on_grid, shard_plans

SHARED = Path(__file__).parents[4] / "shared"


def plan_of(space, doors=()):
    """A plan of a geometry, on its grid."""
    return FloorPlan("drawn", shapely.set_precision(space, 1e-3), tuple(doors))


def two_rooms(door=0.9, wall=0.2):
    """Two rooms of 5 m x 4 m side by side, a doorway through the wall between them."""
    return shapely.union_all(
        [shapely.box(0, 0, 5, 4), shapely.box(5, 2, 5 + wall, 2 + door), shapely.box(5 + wall, 0, 10 + wall, 4)]
    )


def office(n=4):
    """``n`` rooms on either side of a hallway 2 m wide, doors 0.9 m wide in walls 0.1 m thick."""
    parts = [shapely.box(0, 0, 4 * n, 2)]
    for k in range(n):
        for side in (1, -1):
            low, door = (2.1, (2, 2.1)) if side > 0 else (-4.1, (-0.1, 0))
            parts.append(shapely.box(4 * k + 0.05, low, 4 * k + 3.95, low + 4))
            parts.append(shapely.box(4 * k + 0.5, door[0], 4 * k + 1.4, door[1]))
    return shapely.union_all(parts)


def assert_partition(plan, cells):
    """Cells are simple polygons that cover the plan and do not overlap."""
    assert all(cell.is_valid and cell.geom_type == "Polygon" for cell in cells)
    union = shapely.union_all(cells)
    assert sum(cell.area for cell in cells) - union.area <= 1e-9 * plan.area
    assert shapely.difference(plan.space, union).area <= 1e-9 * plan.area
    assert shapely.difference(union, plan.space).area <= 1e-9 * plan.area


def same_sets(a, b, share=0.02):
    """Whether two lists of cells are the same but for a small share of each."""
    return len(a) == len(b) and all(
        min(shapely.symmetric_difference(x, y).area for y in b) <= share * x.area for x in a
    )


def test_rooms_are_parted_at_the_doorway():
    plan = plan_of(two_rooms())
    cells = room_cells(plan).cells
    assert_partition(plan, cells)
    assert sorted(round(cell.area) for cell in cells) == [20, 20]


@pytest.mark.parametrize("n", [2, 4, 6])
def test_hallway_stays_whole(n):
    plan = plan_of(office(n))
    cells = room_cells(plan).cells
    assert_partition(plan, cells)
    assert len(cells) == 2 * n + 1
    assert max(cell.area for cell in cells) == pytest.approx(8 * n, rel=0.05)


def test_thin_wall_between_rooms_is_seen_although_their_hull_is_full():
    """Two halves of a square, parted by a wall a hair thick that leaves a fifth of their width open."""
    square = shapely.difference(shapely.box(0, 0, 10, 10), shapely.box(4.97, 0, 5.03, 8))
    cells = room_cells(plan_of(square)).cells
    assert sorted(round(cell.area) for cell in cells) == [50, 50]


def test_t_junction_becomes_two_hallways():
    cells = room_cells(plan_of(shapely.union(shapely.box(0, 0, 20, 2), shapely.box(9, 2, 11, 12)))).cells
    assert sorted(round(cell.area) for cell in cells) == [20, 40]


def test_small_obstacle_does_not_end_a_room():
    plan = plan_of(shapely.difference(shapely.box(0, 0, 6, 5), shapely.box(2, 2, 2.4, 2.4)))
    cells = room_cells(plan).cells
    assert_partition(plan, cells)
    assert len(cells) == 1


def test_doors_of_the_source_are_boundaries():
    """A door across a square that nothing else would cut."""
    door = shapely.LineString([(3, 0), (3, 4)])
    plan = plan_of(shapely.box(0, 0, 6, 4), [door])
    cells = room_cells(plan).cells
    assert_partition(plan, cells)
    assert sorted(cell.area for cell in cells) == pytest.approx([12, 12])


@st.composite
def crooked_offices(draw):
    """Rooms of uneven sizes on both sides of a hallway, doors anywhere: nothing about it is symmetric."""
    width = draw(st.floats(1.6, 2.4))
    parts, x = [], [0.0, 0.0]
    for k in range(draw(st.integers(3, 6))):
        side = k % 2
        length, depth = draw(st.floats(2.5, 6.0)), draw(st.floats(3.0, 5.0))
        door = x[side] + draw(st.floats(0.4, length - 1.6))
        low, jamb = (width + 0.1, width) if side else (-0.1 - depth, -0.1)
        parts.append(shapely.box(x[side] + 0.05, low, x[side] + length - 0.05, low + depth))
        parts.append(shapely.box(door, jamb, door + 0.9, jamb + 0.1))
        x[side] += length
    return on_grid(shapely.union_all([shapely.box(0, 0, max(x), width), *parts]))


@settings(max_examples=40, deadline=None)
@given(crooked_offices(), st.floats(0, 2 * np.pi), st.integers(-100_000, 100_000), st.integers(-100_000, 100_000))
def test_rotation_and_shift_change_nothing(space, angle, x, y):
    c, s = np.cos(angle), np.sin(angle)

    def turn(xy):
        return xy @ np.array([[c, s], [-s, c]]) + 1e-3 * np.array([x, y])

    expected = [shapely.transform(cell, turn) for cell in room_cells(plan_of(space)).cells]
    assert same_sets(expected, room_cells(plan_of(shapely.transform(shapely.set_precision(space, 0), turn))).cells)


def reordered(polygon, rng):
    """The same polygon written in another way: other first corners, other directions, holes in another order."""
    rings = [np.array(ring.coords)[:-1] for ring in (polygon.exterior, *polygon.interiors)]
    rings = [np.roll(ring, rng.integers(len(ring)), axis=0)[:: rng.choice([-1, 1])] for ring in rings]
    return shapely.Polygon(rings[0], [rings[k + 1] for k in rng.permutation(len(rings) - 1)])


@settings(max_examples=40, deadline=None)
@given(st.one_of(shard_plans(), crooked_offices().map(plan_of)), st.integers(0, 2**32 - 1))
def test_order_of_vertices_changes_nothing(plan, seed):
    rng = np.random.default_rng(seed)
    parts = [reordered(part, rng) for part in plan.parts]
    other = plan_of(shapely.MultiPolygon([parts[k] for k in rng.permutation(len(parts))]), plan.doors[::-1])
    assert same_sets(room_cells(plan).cells, room_cells(other).cells)


def test_same_plan_gives_same_cells():
    plan = plan_of(office(3))
    assert room_cells(plan) == room_cells(plan)


def test_fewer_merges_are_said_so(monkeypatch):
    assert room_cells(plan_of(office(4))).notes == ()
    monkeypatch.setattr(search, "EFFORT", 1)
    (note,) = room_cells(plan_of(office(4))).notes
    assert note.startswith("2 randomised merges instead of 24")


@pytest.mark.parametrize("wall", [0.05, 0.2, 0.5])
def test_what_lies_in_a_doorway_is_no_cell_of_its_own(wall):
    assert len(room_cells(plan_of(two_rooms(wall=wall))).cells) == 2


@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    st.lists(
        st.tuples(st.integers(0, 20), st.integers(0, 20), st.integers(1, 9), st.integers(1, 9), st.booleans()),
        min_size=1,
        max_size=9,
    ),
    st.floats(0, 3),
)
def test_hostile_plans_are_partitioned(boxes, angle):
    """Boxes added and taken away, turned by any angle."""
    space = shapely.Polygon()
    for x, y, w, h, add in boxes:
        box = shapely.box(0.5 * x, 0.5 * y, 0.5 * (x + w), 0.5 * (y + h))
        space = shapely.union(space, box) if add else shapely.difference(space, box)
    c, s = np.cos(angle), np.sin(angle)
    space = shapely.set_precision(shapely.transform(space, lambda xy: xy @ np.array([[c, s], [-s, c]])), 1e-3)
    parts = [part for part in shapely.get_parts(space) if part.area > 0.01]
    if parts:
        plan = plan_of(shapely.MultiPolygon(parts))
        assert_partition(plan, room_cells(plan).cells)


@pytest.mark.skipif(not SHARED.exists(), reason="the shared floor plans are not here")
@pytest.mark.parametrize("name", ["Freiburg52_scan", "office_c", "lab_c_scan"])
def test_drawn_offices_give_nearly_convex_rooms(name):
    plan = read_plan(SHARED / "floorplans" / "ipa" / f"{name}.png", resolution=0.05)
    cells = room_cells(plan).cells
    assert_partition(plan, cells)
    full = np.array([cell.area / cell.convex_hull.area for cell in cells])
    assert (full >= 0.9).mean() >= 0.9
    assert min(mutual_sight(cell) for cell in cells) >= 0.8


def test_aisles_between_desks_belong_to_their_room_in_a_scan_alone():
    """A classroom whose rows of desks reach to the wall, and beside it closets as narrow as the aisles."""
    desks = [shapely.box(1.3 + 2 * k, 3, 2 + 2 * k, 7) for k in range(4)]
    room = shapely.difference(shapely.box(0, 0, 9.3, 7), shapely.union_all(desks))
    closets = [shapely.box(2 * k, -4, 1.4 + 2 * k, -0.2) for k in range(4)]
    leaves = [shapely.box(0.3 + 2 * k, -0.2, 1.1 + 2 * k, 0) for k in range(4)]
    space = shapely.union_all([room, *closets, *leaves])
    drawn = plan_of(space)
    scan = FloorPlan("scanned", drawn.space, repairs=(Repair("removed furniture", "Chairs.", shapely.Point(0, 0)),))
    assert len(room_cells(drawn).cells) == 10  # the front of the room and five aisles
    cells = room_cells(scan).cells
    assert_partition(scan, cells)
    found = [cell for cell in cells if cell.centroid.y > 0]
    assert len(found) <= 2
    assert same_sets([cell for cell in cells if cell.centroid.y < 0], closets, 0.1)


def test_no_cell_is_narrower_than_two_robots_beside_each_other():
    recess = shapely.box(1, 4, 4, 4.7)
    assert len(room_cells(plan_of(shapely.union(two_rooms(), recess))).cells) == 2
