import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from shapely import Point, box

from maps import PlanError
from maps.raster import plan_from_mask
from maps.tracing import straighten, trace

masks = arrays(np.bool_, st.tuples(st.integers(1, 12), st.integers(1, 12)))


def drawn(*rectangles, shape=(100, 160)):
    """A mask with free rectangles (column, row from below, columns, rows)."""
    free = np.zeros(shape, dtype=bool)
    for x, y, w, h in rectangles:
        free[shape[0] - y - h : shape[0] - y, x : x + w] = True
    return free


def plan_of(free, **more):
    return plan_from_mask(free, 0.05, name="scan", source="scan.yaml", **more)


@given(masks.filter(lambda mask: mask.any()))
def test_outline_of_a_mask_is_its_pixels_exactly(mask):
    outline = trace(mask)
    height = mask.shape[0]
    pixels = shapely.union_all([box(c, height - r - 1, c + 1, height - r) for r, c in np.argwhere(mask)])
    assert outline.is_valid
    assert outline.symmetric_difference(pixels).area == 0
    assert outline.area == mask.sum()


@given(masks.filter(lambda mask: mask.any()), st.sampled_from([0.5, 1.0, 2.0]))
def test_straight_walls_keep_every_part_and_hole_and_stay_near(mask, tolerance):
    outline = trace(mask)
    simple = straighten(outline, tolerance)
    assert simple.is_valid
    assert len(simple.geoms) == len(outline.geoms)
    assert len(shapely.get_rings(simple.geoms)) == len(shapely.get_rings(outline.geoms))
    assert simple.boundary.hausdorff_distance(outline.boundary) <= 2 * tolerance + 1e-9


def test_a_slanted_wall_becomes_straight():
    columns, rows = np.meshgrid(np.arange(200), np.arange(200))
    outline = trace((columns + 3 * rows < 500) & (columns > 3) & (rows > 3))
    assert shapely.get_num_coordinates(outline) > 100
    assert shapely.get_num_coordinates(straighten(outline, 1.5)) <= 7


def test_a_clean_room_is_exact():
    plan = plan_of(drawn((10, 20, 100, 60)), origin=(-3.0, 2.0))
    assert plan.repairs == ()
    assert plan.space.equals(box(-2.5, 3.0, 2.5, 6.0))


def test_yaw_turns_the_map_about_its_lower_left_corner():
    plan = plan_of(drawn((0, 0, 100, 60)), origin=(1.0, 1.0), yaw=np.pi / 2)
    assert plan.space.equals(box(-2.0, 1.0, 1.0, 6.0))


def test_thin_walls_and_doors_stay():
    """Two rooms with a wall of one pixel and a door of 18 pixels."""
    free = drawn((10, 10, 50, 60), (61, 10, 50, 60), (60, 30, 1, 18))
    plan = plan_of(free)
    assert len(plan.parts) == 1
    assert plan.area == pytest.approx(free.sum() * 0.05**2, rel=0.01)
    apart = plan_of(drawn((10, 10, 50, 60), (61, 10, 50, 60)))
    assert len(apart.parts) == 2


def test_noise_is_taken_out_and_listed():
    free = drawn((10, 10, 100, 60), (110, 30, 40, 2), (5, 90, 3, 3))
    free[50, 40:43] = False
    plan = plan_of(free)
    kinds = {repair.kind: repair for repair in plan.repairs}
    assert list(kinds) == ["filled pin-hole", "dropped speck", "closed slit"]
    assert plan.space.equals(box(0.5, 0.5, 5.5, 3.5))
    assert shapely.get_parts(kinds["filled pin-hole"].geometry)[0].equals(Point(41.5 * 0.05, 49.5 * 0.05))
    assert kinds["closed slit"].geometry.equals(shapely.MultiPolygon([box(5.5, 1.5, 7.5, 1.6)]))
    assert kinds["closed slit"].message.endswith("0.2 square metres in all.")


def test_corners_and_pillars_and_alcoves_stay_sharp():
    free = drawn((10, 10, 100, 60), (110, 30, 12, 12))
    free[40:45, 40:45] = False
    plan = plan_of(free)
    assert plan.repairs == ()
    assert plan.area == pytest.approx(free.sum() * 0.05**2)


def test_what_is_drawn_is_not_taken_for_noise():
    free = drawn((10, 10, 100, 60), (110, 30, 40, 2))
    free[50, 40] = False
    plan = plan_of(free, clean=False)
    assert plan.area == pytest.approx(free.sum() * 0.05**2)
    assert plan.repairs == ()


@pytest.mark.parametrize(
    ("free", "more", "sentence"),
    [
        (np.zeros((5, 5), bool), {}, "none of its 25 pixels is free"),
        (np.ones((5, 5), bool), {}, "no wall in it; all of its 25 pixels are free"),
        (np.ones((1, 1), bool), {}, "no wall in it"),
        (drawn((0, 0, 160, 3)), {}, "no free space in it as wide as 0.3 m"),
        (drawn((10, 10, 3, 3)), {"clean": False}, "no free space in it for a person"),
    ],
)
def test_pictures_that_are_no_plan_are_refused(free, more, sentence):
    with pytest.raises(PlanError, match=sentence) as caught:
        plan_of(free, **more)
    assert str(caught.value).startswith("scan.yaml: ")


@given(arrays(np.bool_, (24, 24)))
def test_any_noise_at_all_gives_a_sound_plan_or_a_sentence(noise):
    free = np.kron(noise, np.ones((3, 3), dtype=bool))
    try:
        plan = plan_of(free)
    except PlanError as error:
        message = str(error)
    else:
        assert plan.space.is_valid
        assert plan.area <= free.sum() * 0.05**2 * 1.25
        return
    assert "free space" in message or "no wall" in message


# Structure mode


def furnished(chairs, shape=(200, 200)):
    """A room of 8 m x 8 m with a pillar-like leg of 0.2 m at each of the given places."""
    free = drawn((20, 20, 160, 160), shape=shape)
    for x, y in chairs:
        free[y : y + 4, x : x + 4] = False
    return free


GRID = [(x, y) for x in range(40, 160, 20) for y in range(40, 160, 20)]


def test_the_scan_of_a_furnished_room_keeps_its_walls_only():
    plan = plan_of(furnished(GRID))
    assert plan.space.equals(box(1, 1, 9, 9))
    assert [repair.kind for repair in plan.repairs] == ["removed furniture"]
    assert "plainly a scan: 36 piece(s)" in plan.repairs[0].message
    assert plan.repairs[0].geometry.area == pytest.approx(36 * 0.04)


def test_a_few_pillars_are_no_scan():
    plan = plan_of(furnished(GRID[:1]))
    assert plan.repairs == ()
    assert plan.area == pytest.approx(64 - 0.04)


def test_structure_mode_is_as_asked_for():
    kept = plan_of(furnished(GRID), structure=False)
    assert kept.repairs == ()
    assert kept.area == pytest.approx(64 - 36 * 0.04)
    cleared = plan_of(furnished(GRID[:1]), structure=True)
    assert cleared.area == pytest.approx(64)
    assert "as asked for: 1 piece(s)" in cleared.repairs[0].message


def test_walls_that_stand_alone_are_no_furniture():
    free = furnished(GRID)
    free[30:34, 60:120] = False
    free[100:104, 66:86] = False
    free[165:185, 100:102] = False
    plan = plan_of(free)
    assert 64 - plan.area == pytest.approx(60 * 4 * 0.0025 + 20 * 4 * 0.0025 + 2 * 15 * 0.0025, rel=0.1)


def test_dead_ends_are_closed_and_passages_are_not():
    two = drawn((10, 10, 60, 60), (90, 10, 60, 60), (70, 30, 20, 9), (30, 70, 9, 25))
    plan = plan_of(two, structure=True)
    assert len(plan.parts) == 1
    assert [repair.kind for repair in plan.repairs] == ["removed furniture", "closed bay"]
    assert plan.area == pytest.approx((2 * 60 * 60 + 20 * 9) * 0.0025, rel=0.01)
