"""What the cell model predicts: exact where that can be checked by hand, and close to what happens in the world."""

import math

import numpy as np
import pytest

from discretize import CellMap
from geomsim import Decoupled, Evader, Random, Sensor, Stationary, Still, Team, Timing
from geomsim.curves import mean_time
from geomsim.trials import Trials, run_trials
from planners import SearchGraph


def stationary_mean(cells: CellMap, robots: tuple[int, ...]) -> float:
    """Expected time until an evader at 1 m/s enters a robot's cell: exact, by the first hop from each checkpoint."""
    graph = SearchGraph.from_cells(cells)
    system, gone = np.eye(len(graph)), np.zeros(len(graph))
    for cell in set(range(len(graph))) - set(robots):
        edges = range(graph.indptr[cell], graph.indptr[cell + 1])
        for edge in edges:
            to = int(graph.indices[edge])
            if to in robots:
                gone[cell] += graph.leave[edge] / len(edges)
            else:
                gone[cell] += graph.length[edge] / len(edges)
                system[cell, to] -= 1 / len(edges)
    times = np.linalg.solve(system, gone)
    return float(np.delete(times, robots).mean())


def predicted(trials: Trials) -> list[float]:
    return [line.predicted for line in trials.summary().methods]


def test_the_office_is_as_large_as_in_the_paper(office: CellMap) -> None:
    assert [cell - 1 for cell in office.plan.start] == [42, 43]
    assert stationary_mean(office, (42, 43)) == pytest.approx(749.319, rel=2e-3)


@pytest.mark.parametrize(("start", "speed"), [(4, 1.0), (7, 1.0), (9, 0.5)])
def test_a_team_that_stands_still(house: CellMap, start: int, speed: float) -> None:
    """The exact mean but for which portal the evader came by; the half dwell at the beginning is included."""
    trials = run_trials(
        house.plan,
        {"still": Stationary()},
        cells=house,
        team=Team(start=(start,)),
        evader=Evader(speed=speed),
        capture="cell",
        trials=4,
        workers=1,
    )
    assert predicted(trials) == pytest.approx([stationary_mean(house, (start - 1,)) / speed], rel=0.03)


def test_an_evader_that_stays(house: CellMap) -> None:
    """Whoever stands still finds it never; up to the time limit it counts as free, as in the trials."""
    trials = run_trials(
        house.plan,
        {"still": Stationary(), "going": Random()},
        cells=house,
        evader=Evader(model=Still()),
        capture="cell",
        trials=4,
        workers=1,
        timing=Timing(limit=400.0),
    )
    still, going = predicted(trials)
    assert still == pytest.approx(400.0)
    assert 5.0 < going < 390.0


def test_robots_that_notice_slowly(house: CellMap) -> None:
    quick, slow = (
        predicted(
            run_trials(
                house.plan,
                {"greedy": Decoupled(depth=1)},
                cells=house,
                team=Team(sensor=Sensor(detection=chance)),
                capture="cell",
                trials=4,
                workers=1,
            )
        )[0]
        for chance in (1.0, 0.1)
    )
    assert slow > quick + 2.0


@pytest.mark.parametrize("limit", [math.inf, 500.0])
def test_a_run_goes_on_as_it_ended(limit: float) -> None:
    free, step = np.exp(-0.01 * np.arange(300)), 0.5
    expected = step / (1 - math.exp(-0.01)) * (1 - math.exp(-0.02 * limit))
    assert mean_time(free, step, limit) == pytest.approx(expected, rel=0.03)


def test_prediction_and_world_agree(house: CellMap) -> None:
    """Within 10 %, with 400 evaders; the seed is fixed."""
    trials = run_trials(
        house.plan,
        {"still": Stationary(), "random": Random(), "greedy": Decoupled(depth=1), "far": Decoupled(depth=3)},
        cells=house,
        team=Team(pursuers=1),
        capture="cell",
        trials=400,
        workers=1,
    )
    for line in trials.summary().methods:
        assert line.predicted == pytest.approx(line.observed.mean, rel=0.1), line.name


@pytest.mark.parametrize("start", [2, 4])
def test_a_team_that_counts_on_sight(house: CellMap, start: int) -> None:
    """What it believes along its run is what comes out, to within a belief step."""
    trials = run_trials(
        house.plan,
        {"greedy": Decoupled(depth=1)},
        cells=house,
        team=Team(start=(start,), believes="sight"),
        trials=200,
        workers=1,
    )
    line = trials.summary()["greedy"]
    assert abs(line.predicted - line.observed.mean) < 1.0
