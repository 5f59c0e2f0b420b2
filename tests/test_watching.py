"""When robots see somebody who strolls, predicted by a belief over places."""

import itertools
import json
import math

import numpy as np
import pytest
import shapely

from discretize import CellMap, convex_cells
from geomsim import Decoupled, Evader, Random, Sensor, Stationary, Still, Team, Timing
from geomsim.cli import main
from geomsim.curves import mean_time
from geomsim.particles import Swarm
from geomsim.trials import run_trials
from geomsim.watching import Track, Watch
from maps import FloorPlan

SENSORS = {"near": Sensor(range=5.0), "ahead": Sensor(field_of_view=math.pi / 2)}
STILL, STROLLING = Evader(model=Still()), Evader()


@pytest.fixture(scope="module")
def pillar() -> CellMap:
    """A room with a pillar in its middle, cut into cells around that."""
    return convex_cells(FloorPlan("pillar", shapely.box(0, 0, 12, 12).difference(shapely.box(4, 4, 8, 8))))


def standing(cells: CellMap, cell: int, seconds: float) -> Track:
    steps = round(seconds / 0.1) + 1
    return Track(np.tile(cells.checkpoints[cell], (steps, 1, 1)), np.zeros((steps, 1)), 0.1)


def test_who_stands_behind_a_pillar_is_never_seen_nor_said_to_be(pillar: CellMap) -> None:
    watch = Watch(pillar, STILL, 0.1)
    eye = pillar.checkpoints[0]
    hidden = [shapely.LineString([eye, other]).crosses(shapely.box(4, 4, 8, 8)) for other in pillar.checkpoints[1:]]
    assert 0 < sum(hidden) < len(hidden)
    free = watch.survival(standing(pillar, 0, 60.0), [Sensor()], watch.first_belief([0]))
    assert len(free) == 300
    assert free == pytest.approx(np.mean(hidden), abs=1e-12)


def test_looking_again_sees_nothing_new_but_what_moves(pillar: CellMap) -> None:
    watch = Watch(pillar, STROLLING, 0.1)
    free = watch.survival(standing(pillar, 0, 30.0), [Sensor()], watch.first_belief([0]))
    assert (np.diff(free) <= 1e-15).all()
    assert free[-1] < free[0] / 2


def test_a_slow_eye_notices_at_its_rate(pillar: CellMap) -> None:
    watch = Watch(pillar, STILL, 0.1)
    sure, slow = (
        watch.survival(standing(pillar, 0, 20.0), [Sensor(detection=p)], watch.first_belief([0])) for p in (1.0, 0.3)
    )
    looks = np.arange(1, len(slow) + 1)
    assert slow == pytest.approx(sure[0] + (1 - sure[0]) * 0.7 ** (watch.step * looks))


def test_range_and_field_of_view(pillar: CellMap) -> None:
    watch = Watch(pillar, STILL, 0.1)
    first = watch.first_belief([0])
    eye = pillar.checkpoints[0]
    way = pillar.checkpoints[1:] - eye
    near = np.hypot(*way.T) <= 5.0
    ahead = np.abs(np.arctan2(way[:, 1], way[:, 0])) <= math.pi / 4
    free = {k: watch.survival(standing(pillar, 0, 1.0), [s], first)[-1] for k, s in SENSORS.items()}
    open_view = np.array([not shapely.LineString([eye, p]).crosses(shapely.box(4, 4, 8, 8)) for p in eye + way])
    assert free["near"] == pytest.approx(1 - np.mean(open_view & near))
    assert free["ahead"] == pytest.approx(1 - np.mean(open_view & ahead))


def test_mean_time_of_a_curve_that_falls_at_a_rate() -> None:
    free = 0.9 ** np.arange(40)
    assert mean_time(free, 2.0, 1e9) == pytest.approx(20.0, rel=0.01)
    assert mean_time(free, 1.0, 12.0) == pytest.approx(sum(0.9**k for k in range(12)))
    assert mean_time(np.array([0.4, 0.4, 0.4]), 1.0, 10.0) == pytest.approx(4.0)
    assert mean_time(np.array([0.4, 0.0]), 1.0, 10.0) == pytest.approx(0.4)


@pytest.mark.parametrize("evader", [STILL, STROLLING, Evader(speed=0.45)])
@pytest.mark.parametrize("sensor", [Sensor(), Sensor(5.0, 2.5, 0.4)])
def test_places_agree_with_a_hundred_thousand_particles(house: CellMap, evader: Evader, sensor: Sensor) -> None:
    """The curve of so many particles is off by 0.005 in one case of a thousand; the rest is due to rounding."""
    watch = Watch(house, evader, 0.1)
    first = watch.first_belief([0])
    swarm = Swarm(watch, [sensor], first, np.random.default_rng(1))
    looker = watch.lookout([sensor], first)
    route = [house.checkpoints[k] for k in (0, 1, 0)]
    ways = np.concatenate([np.linspace(a, b, 30) for a, b in itertools.pairwise(route)])
    for k, eye in enumerate(ways):
        heading = np.array([0.1 * k])
        told, counted = looker.look(eye[np.newaxis], heading), swarm.look(eye[np.newaxis], heading)
        assert told == pytest.approx(counted, abs=0.012), k


METHODS = {"stationary": Stationary(), "random": Random(), "entropy": Decoupled("entropy", 2)}


@pytest.mark.parametrize(
    ("kind", "limit"),
    [
        ({}, 300.0),
        ({"evader": STILL, "timing": Timing(limit=120.0)}, 120.0),
        ({"team": Team(start=(3,), sensor=Sensor(4.0, 2.5, 0.5)), "evader": Evader(speed=0.6)}, 300.0),
    ],
)
def test_prediction_and_trials_agree(house: CellMap, kind: dict, limit: float) -> None:
    """Of 600 evaders, one curve in a thousand is further off than 0.08 by chance."""
    given = {"trials": 600, "workers": 1, "timing": Timing(limit=limit), "cells": house} | kind
    for line in run_trials(house.plan, METHODS, **given).summary().methods:
        assert line.gap < 0.08, line.name
        assert line.predicted == pytest.approx(line.observed.mean, rel=0.12, abs=0.3)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["office", "school", "museum", "house"])
def test_curves_are_within_three_hundredths(name: str) -> None:
    from geomsim import load_plan

    plan = load_plan(name)
    methods = ["random", "decoupled-entropy-1", "decoupled-probability-1", "decoupled-target-probability-3"]
    for line in run_trials(plan, methods, trials=4000).summary().methods:
        assert line.gap <= 0.03, line.name


def test_predict_by_sight(capsys: pytest.CaptureFixture[str]) -> None:
    def told(*argv: str) -> dict:
        with pytest.raises(SystemExit):
            main(["predict", "house", "--planner", "decoupled", "--depth", "2", "--json", *argv])
        return json.loads(capsys.readouterr()[0])

    sight, cells = told("--capture", "sight"), told()
    assert (sight["belief"], cells["belief"]) == ("places", "cells")
    assert (sight["survival_step"], cells["survival_step"]) == (pytest.approx(0.2), 1.0)
    assert 0 < sight["expected_time"] < cells["expected_time"]
    assert sight["expected_time"] == pytest.approx(0.2 * sum(sight["survival"]), rel=0.01)
    assert told("--capture", "cell")["expected_time"] == cells["expected_time"]
    assert 0 < sight["lower_bound"] < sight["expected_time"]
    counted = told("--capture", "sight", "--belief", "particles")
    assert counted["belief"] == "particles"
    assert counted["expected_time"] == pytest.approx(sight["expected_time"], rel=0.03)
