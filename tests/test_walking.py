"""Bodies go along routes at exactly their speed."""

import itertools

import numpy as np
import pytest

from discretize import CellMap
from geomsim.walking import Routes, Walkers
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
    walkers = Walkers(np.array([speed]), [routes.stay(0, 0.0)])
    world = World(house.plan.walls, house.checkpoints[:1], np.array([0.2]))
    ends = np.cumsum([leg.length for leg in legs])
    todo = list(legs)
    for k in range(int(ends[-1] / (speed * dt))):
        way = max(0.0, (k - 1) * speed * dt)  # a step is lost at the start, where the body is at rest
        leg = legs[int(np.searchsorted(ends, way, side="right"))]
        along = way - float(ends[legs.index(leg)] - leg.length)
        assert world.positions[0] == pytest.approx(leg.at(along), abs=0.02)
        if min(abs(along - leg.crossing), along, leg.length - along) > 2 * speed * dt:
            assert walkers.cells[0] == leg.cell(along)
        walkers.advance(world.positions, world.velocities, dt)
        while walkers.done[0] and todo:
            walkers.take(0, todo.pop(0))
        world.step(walkers.wanted(dt), dt)
        assert np.hypot(*world.velocities[0]) <= speed + 1e-9


def test_a_stay_takes_its_time(house: CellMap) -> None:
    walkers = Walkers(np.ones(1), [Routes(house).stay(3, 2.0)])
    here, still = house.checkpoints[3:4], np.zeros((1, 2))
    for _ in range(19):
        walkers.advance(here, still, 0.1)
        assert not walkers.done[0]
        assert walkers.wanted(0.1) == pytest.approx(np.zeros((1, 2)))
    assert walkers.time_left == pytest.approx([0.1])
    walkers.advance(here, still, 0.1)
    walkers.advance(here, still, 0.1)
    assert walkers.done[0]


def test_a_body_that_is_held_up_is_waited_for(house: CellMap) -> None:
    routes = Routes(house)
    walkers = Walkers(np.ones(1), [routes.between(0, 3)])
    here, still = house.checkpoints[:1], np.zeros((1, 2))
    for _ in range(30):
        walkers.advance(here, still, 0.1)
        wanted = walkers.wanted(0.1)
    assert walkers.aim[0] < 0.5
    assert walkers.idle[0] > 2.0
    assert np.hypot(*wanted[0]) > 0.5


def test_walkers_keep_out_of_each_others_way(house: CellMap) -> None:
    """Many together go as each would alone, also after some of them have left."""
    routes = Routes(house)
    speeds = np.array([0.5, 0.9, 1.3])
    tours = [[(0, 3), (3, 8), (8, 1)], [(1, 7), (7, 0)], [(5, 6), (6, 4), (4, 3), (3, 2)]]
    begins = [routes.between(*tour[0]) for tour in tours]

    def walk(members: list[int], leave: int) -> dict[int, list[np.ndarray]]:
        walkers = Walkers(speeds[members], [begins[m] for m in members])
        todo = {m: [routes.between(*hop) for hop in tours[m][1:]] for m in members}
        at = np.array([begins[m].points[0] for m in members])
        tracks: dict[int, list[np.ndarray]] = {m: [at[i]] for i, m in enumerate(members)}
        previous = at
        for step in range(90):
            if step == 40 and leave in members and len(members) > 1:
                stay = np.array([i for i, m in enumerate(members) if m != leave])
                members = [members[i] for i in stay]
                walkers.keep(stay)
                at, previous = at[stay], previous[stay]
            velocity = (at - previous) / 0.1
            walkers.advance(at, velocity, 0.1)
            for i, m in enumerate(members):
                while walkers.done[i] and todo[m]:
                    walkers.take(i, todo[m].pop(0))
            previous, at = at, at + 0.1 * walkers.wanted(0.1)
            for i, m in enumerate(members):
                tracks[m].append(at[i])
        return tracks

    together = walk([0, 1, 2], leave=1)
    for m in range(3):
        alone = walk([m], leave=-1)[m]
        assert np.array_equal(np.array(together[m]), np.array(alone[: len(together[m])]))


def test_the_shortest_way(house: CellMap) -> None:
    routes = Routes(house)
    assert routes.path(0, 0) == ()
    assert routes.path(2, 6) in ((3, 4, 6), (3, 5, 6))
    hops = itertools.pairwise((2, *routes.path(2, 6)))
    assert routes.distances(2)[6] == pytest.approx(sum(routes.between(a, b).length for a, b in hops))
