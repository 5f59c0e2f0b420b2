import math

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely import LineString, MultiPolygon, Point, Polygon, box

from maps import FloorPlan, Label, PlanError, Repair, make_plan
from maps.making import GRID

ROOM = box(0, 0, 5, 4)


def odd(polygon, *coordinates):
    """Make a geometry of numbers about which shapely itself warns."""
    with np.errstate(all="ignore"):
        return polygon(coordinates)


def kinds(plan):
    return [repair.kind for repair in plan.repairs]


def check(plan: FloorPlan):
    """What every plan promises, whatever it was made from."""
    assert plan.space.is_valid
    assert plan.space.geom_type in ("Polygon", "MultiPolygon")
    assert plan.area >= 0.5
    xy = shapely.get_coordinates(plan.space)
    assert np.abs(xy / GRID - np.round(xy / GRID)).max() < 1e-6 * max(1.0, np.abs(xy / GRID).max())
    assert all(part.area >= 0.5 - 1e-2 and not part.buffer(-0.24).is_empty for part in plan.parts)
    again = make_plan(plan.space, name=plan.name)
    assert again.space.symmetric_difference(plan.space).area < 1e-3 * plan.space.length + 1e-9


def test_a_plain_room_stays_as_it_is():
    plan = make_plan(ROOM, name="room")
    assert plan.repairs == ()
    assert plan.space.equals(ROOM)
    assert len(plan.walls) == 4


@pytest.mark.parametrize(
    ("space", "area", "expected"),
    [
        pytest.param(Polygon([(0, 0), (4, 4), (4, 0), (0, 4)]), 8.0, ["mended ring"], id="bow tie"),
        pytest.param(Polygon([(0, 0), (0, 4), (5, 4), (5, 0)]), 20.0, [], id="clockwise"),
        pytest.param(
            Polygon(ROOM.exterior.coords, [box(1, 1, 2, 2).exterior.coords]), 19.0, [], id="hole like its shell"
        ),
        pytest.param(
            Polygon(ROOM.exterior.coords, [box(7, 1, 8, 2).exterior.coords]), 21.0, ["mended ring"], id="hole outside"
        ),
        pytest.param(
            Polygon([(0, 0), (5, 0), (5, 4), (2, 4), (2, 1), (2, 4), (0, 4)]),
            20.0,
            ["mended ring", "removed spike"],
            id="wall without width",
        ),
        pytest.param(
            Polygon([(0, 0), (5, 0), (5, 4), (2.003, 4), (2, 9), (2, 4), (0, 4)]), 20.0, ["removed spike"], id="needle"
        ),
        pytest.param([ROOM, box(5, 0, 9, 4)], 36.0, [], id="rooms side by side"),
        pytest.param([ROOM, box(4, 0, 9, 4)], 36.0, [], id="rooms that overlap"),
        pytest.param([ROOM, box(7, 0, 7.2, 9), box(8, 0, 8.4, 0.4)], 20.0, ["dropped part"], id="sliver and speck"),
        pytest.param([ROOM, box(7, 0, 9, 2)], 24.0, [], id="two parts"),
    ],
)
def test_broken_polygons_are_repaired_and_every_repair_is_listed(space, area, expected):
    plan = make_plan(
        Polygon(space) if isinstance(space, list) and isinstance(space[0], tuple) else space, name="broken"
    )
    check(plan)
    assert plan.area == pytest.approx(area, abs=0.02)
    assert kinds(plan) == expected
    assert all(repair.message.endswith(".") and not repair.geometry.is_empty for repair in plan.repairs)


def test_duplicate_and_collinear_vertices_are_left_out():
    plan = make_plan(Polygon([(0, 0), (0, 0), (2, 0.0002), (5, 0), (5, 4), (5.0003, 4), (0, 4)]), name="room")
    assert plan.space.equals(ROOM)
    assert shapely.get_num_coordinates(plan.space) == 5


def test_thin_walls_stay():
    halves = box(0, 0, 10, 8).difference(box(4.999, 0, 5.002, 7))
    plan = make_plan(halves, name="two rooms")
    assert plan.repairs == ()
    assert plan.space.equals(halves)


def test_same_space_gives_same_plan_whatever_the_order_of_its_rings():
    holes = [box(1, 1, 2, 2).exterior.coords[:], box(3, 1, 4, 2).exterior.coords[:]]
    one = make_plan([Polygon(ROOM.exterior.coords, holes), box(7, 0, 9, 2)], name="a")
    turned = [h[2:] + h[1:3] for h in (holes[1][::-1], holes[0])]
    two = make_plan([box(7, 0, 9, 2).reverse(), Polygon(ROOM.exterior.coords[::-1], turned)], name="a")
    assert one == two


def test_walls_are_the_edges_of_every_part():
    hole = box(1, 1, 2, 2)
    plan = make_plan([ROOM.difference(hole), box(7, 0, 9, 2)], name="two parts")
    assert plan.walls.shape == (12, 2, 2)
    assert np.hypot(*(plan.walls[:, 1] - plan.walls[:, 0]).T).sum() == pytest.approx(plan.space.length)


def test_obstacles_are_cut_out():
    plan = make_plan(ROOM, name="room", solid=[box(1, 1, 2, 2), box(1.5, 1, 3, 2)])
    assert plan.area == pytest.approx(18.0)


def test_doors_and_labels_are_kept_where_they_belong():
    bent = LineString([(5, 1), (5.1, 1.5), (5, 2)])
    plan = make_plan(
        [ROOM, box(5, 0, 9, 4)],
        name="flat",
        doors=[bent, LineString([(20, 0), (20, 1)])],
        labels=[Label((1, 1), "kitchen", 2), Label((30, 1), "garden")],
        start=[2],
        repairs=[Repair("guess", "A reader did this.", Point(0, 0))],
    )
    assert kinds(plan) == ["guess", "straightened door", "dropped door", "dropped label"]
    assert [list(d.coords) for d in plan.doors] == [[(5, 1), (5, 2)]]
    assert plan.labels == (Label((1.0, 1.0), "kitchen", 2),)
    assert plan.start == (2,)


@pytest.mark.parametrize(
    ("space", "more", "sentence"),
    [
        ([], {}, "no polygon at all"),
        (Polygon(), {}, "no polygon at all"),
        (LineString([(0, 0), (1, 1)]), {}, "made of polygons, not of LineString"),
        (["room"], {}, "made of polygons, not of str"),
        (ROOM, {"solid": [Point(0, 0)]}, "walls and obstacles are made of polygons, not of Point"),
        (odd(Polygon, (0, 0), (1, math.nan), (1, 1)), {}, r"vertex 2 is \(1, nan\)"),
        (odd(Polygon, (0, 0), (1, math.inf), (1, 1)), {}, r"vertex 2 is \(1, inf\)"),
        (box(0, 0, 100_000, 5), {}, "100000 m x 5 m; at most 10 km"),
        (box(1e12, 0, 1e12 + 5, 5), {}, "too far from the origin"),
        (box(0, 0, 0.1, 0.2), {}, "0.1 m x 0.2 m with 0.02 square metres. Are its units metres?"),
        (Polygon([(0, 0), (3, 3), (6, 6)]), {}, "no free space in it for a person"),
        (ROOM, {"doors": [Point(0, 0)]}, "LineString from jamb to jamb, not a Point"),
        (ROOM, {"doors": [odd(LineString, (0, 0), (math.nan, 0))]}, "they must be finite numbers"),
        (ROOM, {"doors": [LineString([(0, 0), (0, 1e-5)])]}, "has no width"),
        (ROOM, {"labels": [Label((math.nan, 0), "hall")]}, "label 'hall' is at .*must be finite"),
        (ROOM, {"labels": [Label((1, 1), "hall", 0)]}, "number 0 must be 1 or more"),
        (ROOM, {"labels": [Label((1, 1), "a", 1), Label((2, 2), "b", 1)]}, "number 1 must be .* once only"),
        (ROOM, {"start": [0]}, "0 is not one"),
        (ROOM, {"start": [1.5]}, "1.5 is not one"),
        (ROOM, {"start": [True]}, "True is not one"),
    ],
)
def test_what_is_no_plan_is_refused_with_a_sentence(space, more, sentence):
    with pytest.raises(PlanError, match=sentence) as caught:
        make_plan(space, name="plan", source="plan.geojson", **more)
    assert str(caught.value).startswith("plan.geojson: ")
    assert str(caught.value).endswith((".", "?"))


def test_too_many_vertices_are_refused():
    angle = np.linspace(0, 2 * np.pi, 2_000_002)
    with pytest.raises(PlanError, match="2000003 vertices are too many"):
        make_plan(Polygon(np.stack([np.cos(angle), np.sin(angle)], axis=1)), name="disc")


def coordinates(low, high):
    """Numbers that meet: many equal ones, many that are nearly equal, and any others."""
    near = st.sampled_from([-0.0004, 0.0, 0.0004, 0.0011])
    return st.one_of(
        st.builds(lambda whole, bit: whole + bit, st.integers(low, high).map(float), near),
        st.floats(low, high, allow_nan=False, width=32),
    )


rings = st.lists(st.tuples(coordinates(0, 8), coordinates(0, 8)), min_size=3, max_size=12)
hostile = st.builds(Polygon, rings, st.lists(rings, max_size=2))


@given(st.lists(hostile, min_size=1, max_size=4), st.lists(hostile, max_size=2))
def test_hostile_polygons_give_a_sound_plan_or_a_sentence(polygons, walls):
    try:
        plan = make_plan(polygons, name="hostile", solid=walls)
    except PlanError as error:
        message = str(error)
    else:
        check(plan)
        return
    assert "no free space" in message


@given(st.lists(st.floats(), min_size=6, max_size=12))
def test_any_numbers_at_all_give_a_plan_or_a_sentence(numbers):
    xy = np.array([0.0, 0.0, *numbers[: len(numbers) // 2 * 2]]).reshape(-1, 2)
    try:
        plan = make_plan(odd(Polygon, *xy), name="any")
    except PlanError as error:
        message = str(error)
    else:
        check(plan)
        return
    assert message.startswith("any: ")


@given(st.sets(st.tuples(st.integers(0, 7), st.integers(0, 7)), min_size=1))
def test_touching_squares_become_one_space_of_the_same_area(squares):
    plan = make_plan(MultiPolygon([box(x, y, x + 1, y + 1) for x, y in sorted(squares)][:1]), name="first")
    assert plan.area == pytest.approx(1.0)
    plan = make_plan([box(x, y, x + 1, y + 1) for x, y in sorted(squares)], name="squares")
    assert plan.area == pytest.approx(len(squares))
    check(plan)
