"""What a robot sees against what geometry leaves when every wall's shadow is cut away."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from geomsim.drawing.visibility import Walls
from maps import FloorPlan


def cut_shadows(space: shapely.Geometry, eye: np.ndarray) -> shapely.Geometry:
    """Return the part of the free space that no wall hides, the slow way."""
    shadows = []
    for a, b in FloorPlan("", space).walls:
        far = [p + 50 * (p - eye) for p in (b, a)]
        shadow = shapely.Polygon([a, b, *far])
        if shadow.area > 1e-9:
            shadows.append(shadow.buffer(0))
    return space.difference(shapely.union_all(shadows))


def whole(corners: np.ndarray) -> shapely.Geometry:
    """Return what a polygon covers; where its outline touches itself within rounding, buffer(0) would lose it all."""
    return shapely.make_valid(shapely.Polygon(corners))


def disc(eye: np.ndarray, reach: float) -> shapely.Polygon:
    return shapely.Point(eye).buffer(reach, quad_segs=256)


corner = st.tuples(st.integers(0, 40), st.integers(0, 40)).map(lambda p: (p[0] / 4, p[1] / 4))
obstacle = st.lists(corner, min_size=3, max_size=4, unique=True).map(lambda c: shapely.MultiPoint(c).convex_hull)


@st.composite
def hostile_spaces(draw) -> tuple[shapely.Polygon, np.ndarray]:
    """A hall of 10 m x 10 m less some obstacles on a grid: holes, slivers, collinear walls, corners that touch."""
    obstacles = draw(st.lists(obstacle, max_size=7))
    space = shapely.box(0, 0, 10, 10).difference(shapely.union_all([o for o in obstacles if o.area > 0]))
    space = max(shapely.get_parts(space), key=lambda part: part.area)
    eye = np.array([draw(st.floats(0.1, 9.9)), draw(st.floats(0.1, 9.9))])
    assume(space.buffer(-0.05).contains(shapely.Point(eye)))
    return space, eye


@given(hostile_spaces())
@settings(max_examples=80)
def test_seen_is_what_no_wall_hides(case: tuple[shapely.Polygon, np.ndarray]) -> None:
    space, eye = case
    seen = whole(Walls(FloorPlan("", space)).seen_from(eye))
    assert seen.symmetric_difference(cut_shadows(space, eye)).area < 1e-3


@given(hostile_spaces(), st.floats(0.2, 12.0), st.floats(-7.0, 7.0), st.floats(0.1, 6.2))
@settings(max_examples=60)
def test_range_and_field_of_view_only_cut(
    case: tuple[shapely.Polygon, np.ndarray], reach: float, heading: float, field: float
) -> None:
    space, eye = case
    seen = whole(Walls(FloorPlan("", space)).seen_from(eye, reach, heading, field))
    turn = heading + field * np.linspace(-0.5, 0.5, 400)
    wedge = shapely.Polygon([eye, *(eye + 30 * np.stack([np.cos(turn), np.sin(turn)], axis=1))]).buffer(0)
    expected = cut_shadows(space, eye).intersection(wedge).intersection(disc(eye, reach))
    # The circle has a corner every two degrees: 0.02 % of its area is missing.
    assert seen.symmetric_difference(expected).area < 1e-3 + 0.0004 * np.pi * min(reach, 10.0) ** 2 * field / math.tau


@pytest.mark.parametrize("eye", [(0.0, 5.0), (5.0, 0.0), (10.0, 9.0)])
def test_an_eye_on_a_wall_sees_the_room(eye: tuple[float, float]) -> None:
    seen = Walls(FloorPlan("", shapely.box(0, 0, 10, 10))).seen_from(np.array(eye))
    assert shapely.Polygon(seen).buffer(0).area == pytest.approx(100.0, abs=1e-3)


def test_rooms_that_do_not_touch_hide_each_other() -> None:
    rooms = shapely.union_all([shapely.box(0, 0, 4, 4), shapely.box(6, 0, 10, 4)])
    seen = Walls(FloorPlan("", rooms)).seen_from(np.array([2.0, 2.0]))
    assert whole(seen).symmetric_difference(shapely.box(0, 0, 4, 4)).area < 1e-3


def test_orientation_of_rings_does_not_matter() -> None:
    space = shapely.Polygon(
        [(0, 0), (0, 10), (10, 10), (10, 0)], holes=[[(4, 4), (6, 4), (6, 6), (4, 6)]]
    )  # clockwise outside, counterclockwise inside
    eye = np.array([2.0, 5.0])
    for turned in (space, space.reverse()):
        seen = shapely.Polygon(Walls(FloorPlan("", turned)).seen_from(eye))
        assert seen.symmetric_difference(cut_shadows(space, eye)).area < 1e-6
