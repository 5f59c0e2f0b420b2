"""The physical world: no body crosses a wall, bodies follow what is wanted, sight ends at walls."""

import math

import numpy as np
import pytest
import shapely

from geomsim.sensing import Sensor
from geomsim.world import World, count_wall_crossings
from maps import FloorPlan, GeomsimError, read_plan


def rooms(columns: int, rows: int, size: float = 5.0, wall: float = 0.1, door: float = 0.9) -> FloorPlan:
    """A grid of square rooms with a door in the middle of every inner wall."""
    parts = [
        shapely.box(i * size + wall / 2, j * size + wall / 2, (i + 1) * size - wall / 2, (j + 1) * size - wall / 2)
        for i in range(columns)
        for j in range(rows)
    ]
    for i in range(columns):
        for j in range(rows):
            x, y = (i + 0.5) * size, (j + 0.5) * size
            if i + 1 < columns:
                parts.append(shapely.box((i + 1) * size - wall, y - door / 2, (i + 1) * size + wall, y + door / 2))
            if j + 1 < rows:
                parts.append(shapely.box(x - door / 2, (j + 1) * size - wall, x + door / 2, (j + 1) * size + wall))
    return FloorPlan("rooms", shapely.union_all(parts))


def places(plan: FloorPlan, count: int, radius: float, rng: np.random.Generator) -> np.ndarray:
    """Random places where a disc fits."""
    x0, y0, x1, y1 = plan.bounds
    free = plan.space.buffer(-radius - 0.01)
    points = rng.uniform((x0, y0), (x1, y1), size=(40 * count, 2))
    return points[shapely.contains_xy(free, *points.T)][:count]


@pytest.mark.parametrize("name", ["rooms", "house", "office"])
def test_no_body_crosses_a_wall(name: str) -> None:
    """200 bodies driven at 1 m/s for 300 s, half of them straight on until they are stuck, half turning often."""
    rng = np.random.default_rng(1)
    plan = rooms(4, 3) if name == "rooms" else read_plan(name)
    start = places(plan, 200, 0.2, rng)
    assert len(start) == 200
    world = World(plan.walls, start, np.full(200, 0.2))
    track = [world.positions]
    angle = rng.uniform(0, math.tau, 200)
    touched = np.zeros(200, dtype=bool)
    for _ in range(3000):
        often = np.arange(200) % 2 == 0
        turn = rng.random(200) < np.where(often, 0.05, 0.002)
        angle = np.where(turn, rng.uniform(0, math.tau, 200), angle)
        world.step(np.stack([np.cos(angle), np.sin(angle)], axis=1), 0.1)
        track.append(world.positions)
        touched |= np.hypot(*world.velocities.T) < 0.5
    assert touched.all()  # every body was stopped by a wall at some time, so the count below means something
    assert count_wall_crossings(np.array(track), plan.walls) == 0
    assert shapely.contains_xy(plan.space, *world.positions.T).all()


def test_crossings_are_counted() -> None:
    walls = np.array([[[0.0, -1.0], [0.0, 1.0]]])
    track = np.array([[[-1.0, 0.0]], [[1.0, 0.0]], [[1.0, 0.5]], [[-1.0, 0.5]]])
    assert count_wall_crossings(track, walls) == 2


def test_setting_velocities_would_cross_walls() -> None:
    """The obvious way, which World avoids: it shows that the count above can fail."""
    import pymunk

    space = pymunk.Space()
    space.add(pymunk.Segment(space.static_body, (0, -5), (0, 5), 0))
    body = pymunk.Body(1, float("inf"))
    body.position = (-1, 0)
    space.add(body, pymunk.Circle(body, 0.2))
    for _ in range(40):
        body.velocity = (1, 0)
        space.step(0.1)
    assert body.position.x > 0

    world = World(np.array([[[0.0, -5.0], [0.0, 5.0]]]), np.array([[-1.0, 0.0]]), np.array([0.2]))
    for _ in range(40):
        world.step(np.array([[1.0, 0.0]]), 0.1)
    assert world.positions[0, 0] == pytest.approx(-0.2, abs=0.01)


def test_bodies_do_not_meet() -> None:
    nowhere = np.array([[[0.0, 9.0], [1.0, 9.0]]])
    world = World(nowhere, np.array([[-1.0, 0.0], [1.0, 0.0]]), np.array([0.25, 0.25]))
    for _ in range(21):
        world.step(np.array([[1.0, 0.0], [-1.0, 0.0]]), 0.1)
    assert world.positions[0] == pytest.approx([1.0, 0.0])
    assert world.positions[1] == pytest.approx([-1.0, 0.0])


def test_a_step_too_long_for_the_body_is_refused() -> None:
    world = World(np.array([[[0.0, 9.0], [1.0, 9.0]]]), np.zeros((1, 2)), np.array([0.2]))
    with pytest.raises(GeomsimError, match="might miss a wall"):
        world.step(np.array([[3.0, 0.0]]), 0.1)


@pytest.fixture
def world() -> World:
    return World(np.array([[[0.0, -1.0], [0.0, 1.0]]]), np.array([[-1.0, 0.0]]), np.array([0.2]))


@pytest.mark.parametrize(
    ("target", "sensor", "heading", "seen"),
    [
        ((1.0, 0.0), Sensor(), 0.0, False),  # through the wall
        ((1.0, 4.0), Sensor(), 0.0, True),  # past its end
        ((-3.0, 0.0), Sensor(), 0.0, True),  # no wall
        ((-3.0, 0.0), Sensor(range=1.9), 0.0, False),
        ((-3.0, 0.0), Sensor(range=2.1), 0.0, True),
        ((-3.0, 0.0), Sensor(field_of_view=math.pi / 2), 0.0, False),  # behind
        ((-3.0, 0.0), Sensor(field_of_view=math.pi / 2), math.pi, True),
        ((-3.0, 0.0), Sensor(field_of_view=math.pi / 2), -math.pi, True),  # the angle wraps
        ((-1.0, 1.0), Sensor(field_of_view=math.pi / 2), math.radians(40), False),
        ((-1.0, 1.0), Sensor(field_of_view=math.pi / 2), math.radians(50), True),
        ((-1.0, 0.0), Sensor(field_of_view=0.1), 1.0, True),  # on the spot
    ],
)
def test_sight(world: World, target: tuple[float, float], sensor: Sensor, heading: float, seen: bool) -> None:
    assert sensor.sees(world, world.positions[0], heading, np.array(target)) is seen


def test_sight_agrees_with_shapely() -> None:
    """Ray casts against geometry on 2,000 random pairs; touching cases have probability zero."""
    rng = np.random.default_rng(2)
    plan = rooms(4, 3)
    world = World(plan.walls, np.array([[2.5, 2.5]]), np.array([0.2]))
    a, b = places(plan, 2000, 0.2, rng), places(plan, 2000, 0.2, rng)
    walls = shapely.multilinestrings(shapely.linestrings(plan.walls))
    shapely.prepare(walls)
    expected = ~shapely.intersects(walls, shapely.linestrings(np.stack([a, b], axis=1)))
    assert 0.05 < expected.mean() < 0.95
    assert [world.sees(p, q) for p, q in zip(a, b, strict=True)] == expected.tolist()


@pytest.mark.parametrize(
    "sensor", [{"range": 0.0}, {"range": math.nan}, {"field_of_view": 0.0}, {"field_of_view": 7.0}]
)
def test_a_useless_sensor_is_refused(sensor: dict[str, float]) -> None:
    with pytest.raises(GeomsimError):
        Sensor(**sensor)


@pytest.mark.parametrize("bodies", [1, 2, 3])
def test_positions_that_were_asked_for_stay_what_they_were(bodies: int) -> None:
    world = World(np.array([[[0.0, 0.0], [9.0, 0.0]]]), np.tile([[4.0, 5.0]], (bodies, 1)), np.full(bodies, 0.2))
    before, wanted = world.positions, np.full((bodies, 2), 0.5)
    for _ in range(3):
        world.step(wanted, 0.1)
    assert before.tolist() == [[4.0, 5.0]] * bodies
    assert (world.positions > 4.05).all()
