"""Bodies go along routes at exactly their speed."""

import itertools

import numpy as np
import pytest

from discretize import CellMap
from geomsim.walking import Routes, Walker
from geomsim.world import World


def test_routes_of_the_house(house: CellMap) -> None:
    routes = Routes(house)
    assert [[c + 1 for c in row] for row in routes.neighbours] == [
        [4, 8],
        [8, 9],
        [4],
        [1, 3, 5, 6, 9],
        [4, 7],
        [4, 7],
        [5, 6],
        [1, 2],
        [2, 4],
    ]
    for i, j in house.edges:
        there, back = routes.between(i, j), routes.between(j, i)
        assert there.length == pytest.approx(back.length)
        assert there.crossing + back.crossing == pytest.approx(there.length)
        assert there.at(0.0) == pytest.approx(house.checkpoints[i])
        assert there.at(there.length) == pytest.approx(house.checkpoints[j])
        assert (there.cell(there.crossing - 1e-6), there.cell(there.crossing)) == (i, j)


@pytest.mark.parametrize(("speed", "dt"), [(1.0, 0.1), (0.7, 0.05), (1.9, 0.1)])
def test_a_walker_keeps_its_speed(house: CellMap, speed: float, dt: float) -> None:
    """Round the house by 1-4-9-2-8-1: at every time the body is where a point at that speed would be."""
    routes = Routes(house)
    tour = [0, 3, 8, 1, 7, 0]
    legs = [routes.between(a, b) for a, b in itertools.pairwise(tour)]
    walker = Walker(speed, routes.stay(0, 0.0))
    world = World(house.plan.walls, house.checkpoints[:1], np.array([0.2]))
    ends = np.cumsum([leg.length for leg in legs])
    todo = list(legs)
    for k in range(int(ends[-1] / (speed * dt))):
        way = max(0.0, (k - 1) * speed * dt)  # a step is lost at the start, where the body is at rest
        leg = legs[int(np.searchsorted(ends, way, side="right"))]
        along = way - float(ends[legs.index(leg)] - leg.length)
        assert world.positions[0] == pytest.approx(leg.at(along), abs=0.02)
        if min(abs(along - leg.crossing), along, leg.length - along) > 2 * speed * dt:
            assert walker.cell == leg.cell(along)
        walker.advance(world.positions[0], world.velocities[0], dt)
        while walker.done and todo:
            walker.take(todo.pop(0))
        world.step(walker.wanted(world.positions[0], world.velocities[0], dt)[np.newaxis], dt)
        assert np.hypot(*world.velocities[0]) <= speed + 1e-9


def test_a_stay_takes_its_time(house: CellMap) -> None:
    walker = Walker(1.0, Routes(house).stay(3, 2.0))
    here, still = house.checkpoints[3], np.zeros(2)
    for _ in range(19):
        walker.advance(here, still, 0.1)
        assert not walker.done
        assert walker.wanted(here, still, 0.1) == pytest.approx([0.0, 0.0])
    assert walker.time_left == pytest.approx(0.1)
    walker.advance(here, still, 0.1)
    walker.advance(here, still, 0.1)
    assert walker.done


def test_a_body_that_is_held_up_is_waited_for(house: CellMap) -> None:
    routes = Routes(house)
    walker = Walker(1.0, routes.between(0, 3))
    here = house.checkpoints[0]
    for _ in range(30):
        walker.advance(here, np.zeros(2), 0.1)
        wanted = walker.wanted(here, np.zeros(2), 0.1)
    assert walker.aim < 0.5
    assert walker.idle > 2.0
    assert np.hypot(*wanted) > 0.5
