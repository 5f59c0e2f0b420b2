"""Compiled sight against pymunk's own ray casts."""

import math

import numpy as np
import pytest
import shapely

from discretize import CellMap, WallGrid
from discretize.raycast import seen_pairs
from geomsim.sensing import Sensor
from geomsim.trials.kernels import Looked, Lookers, blocked_moves, first_looks, first_meetings
from geomsim.world import World, count_wall_crossings


def places(cells: CellMap, count: int, rng: np.random.Generator) -> np.ndarray:
    x0, y0, x1, y1 = cells.plan.bounds
    shapely.prepare(cells.plan.space)
    points = rng.uniform((x0, y0), (x1, y1), size=(4 * count, 2))
    inside = points[shapely.contains_xy(cells.plan.space, *points.T)][:count]
    assert len(inside) == count
    return inside


@pytest.mark.parametrize("size", [0.4, 1.0, 30.0])
def test_sight_is_that_of_pymunk(office: CellMap, size: float) -> None:
    """40,000 random pairs, half of them near each other; no disagreement."""
    rng = np.random.default_rng(1)
    grid = WallGrid.of(office.plan.walls, size)
    world = World(office.plan.walls, office.checkpoints[:1], np.array([0.2]))
    a = places(office, 40_000, rng)
    b = np.concatenate([places(office, 20_000, rng), a[20_000:] + rng.normal(0, 3, (20_000, 2))])
    x0, y0, x1, y1 = office.plan.bounds
    b = np.clip(b, (x0, y0), (x1, y1))
    expected = np.array([world.sees(p, q) for p, q in zip(a, b, strict=True)])
    assert 0.1 < expected.mean() < 0.9
    assert np.array_equal(seen_pairs(grid, a, b), expected)


def test_rays_on_the_corners_of_a_grid() -> None:
    """Walls and rays with whole coordinates, which meet squares' corners and walls' ends: still as pymunk has it."""
    rng = np.random.default_rng(2)
    walls = rng.integers(0, 9, (14, 2, 2)).astype(float)
    walls = walls[np.any(walls[:, 0] != walls[:, 1], axis=1)]
    grid = WallGrid.of(walls)
    world = World(walls, np.zeros((1, 2)), np.array([0.2]))
    a, b = rng.integers(0, 9, (2, 8000, 2)).astype(float)
    a += 0.5 * rng.integers(0, 2, (8000, 1))
    # on a slanted wall rounding decides, on which side of it an end is
    tree = shapely.STRtree(list(shapely.linestrings(walls)))
    clear = np.ones(8000, dtype=bool)
    for ends in (a, b):
        clear[np.unique(tree.query(shapely.points(ends), predicate="dwithin", distance=1e-9)[0])] = False
    assert clear.sum() > 500
    expected = np.array([world.sees(p, q) for p, q in zip(a[clear], b[clear], strict=True)])
    assert np.array_equal(seen_pairs(grid, a[clear], b[clear]), expected)
    assert 0.02 < expected.mean() < 0.98


def test_blocked_moves_are_counted(house: CellMap) -> None:
    rng = np.random.default_rng(3)
    track = np.stack([places(house, 300, rng) for _ in range(5)])
    grid = WallGrid.of(house.plan.walls)
    assert blocked_moves(grid, track) == count_wall_crossings(track, house.plan.walls) > 0


@pytest.mark.parametrize("sensor", [Sensor(), Sensor(4.0), Sensor(math.inf, 1.5), Sensor(6.0, 2.0, 0.3)], ids=repr)
def test_first_looks_are_those_of_the_sensor(office: CellMap, sensor: Sensor) -> None:
    rng = np.random.default_rng(4)
    t, p, k = 60, 2, 25
    grid = WallGrid.of(office.plan.walls)
    world = World(office.plan.walls, office.checkpoints[:1], np.array([0.2]))
    eyes = places(office, t * p, rng).reshape(t, p, 2)
    headings = rng.uniform(-math.pi, math.pi, (t, p))
    targets = places(office, t * k, rng).reshape(t, k, 2).astype(np.float32)
    patience = rng.exponential(size=(k, p))
    which = np.arange(0, k, 2)
    lookers = Lookers(*(np.full(p, v) for v in (sensor.range, sensor.field_of_view / 2, sensor.attention * 0.5)))
    looked = Looked(patience, np.zeros((k, p)))
    when, who = first_looks(grid, lookers, eyes[:30], headings[:30], targets[:30], which, looked)
    rest = which[when[which] < 0]
    later, other = first_looks(grid, lookers, eyes[30:], headings[30:], targets[30:], rest, looked)
    when[rest], who[rest] = np.where(later[rest] < 0, -1, later[rest] + 30), other[rest]

    for e in range(k):
        paid, found = np.zeros(p), (-1, -1)
        for step in range(t if e in which else 0):
            for i in range(p):
                target = targets[step, e].astype(float)
                if found == (-1, -1) and sensor.sees(world, eyes[step, i], float(headings[step, i]), target):
                    paid[i] += sensor.attention * 0.5
                    if paid[i] >= patience[e, i]:
                        found = (step, i)
        assert (when[e], who[e]) == found
    assert (when[which] >= 0).any()


def test_first_meetings() -> None:
    lookers = Lookers(*(np.array([v, v]) for v in (math.inf, math.pi, math.inf)))
    occupied = np.array([[0, 5], [1, 5], [2, 6]], dtype=np.int32)
    hidden = np.array([[3, 5, 9, 1], [1, 4, 9, 2], [0, 4, 6, 2]], dtype=np.int32)
    looked = Looked(np.ones((4, 2)), np.zeros((4, 2)))
    when, who = first_meetings(lookers, occupied, hidden, np.arange(3), looked)
    assert when.tolist() == [1, 0, 2, -1]
    assert who.tolist() == [0, 1, 1, -1]
