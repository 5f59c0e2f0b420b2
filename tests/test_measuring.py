"""Ranges that robots measure draw the belief to where the evader is."""

import math

import numpy as np
import pytest

from discretize import CellMap
from geomsim import Communication, Evader, GeomsimError, Stationary, Still, Team, Timing, run_episode, run_trials
from geomsim.believing import believed_problem
from geomsim.measuring import RangeReadings
from geomsim.prediction import predict_scenario
from planners import AreaSpeedDegree, EvidenceError, StationaryMotion, measured_range


def readings(cells: CellMap, noise: float) -> RangeReadings:
    _, problem = believed_problem(cells, Team(), AreaSpeedDegree(), 1.0)
    return RangeReadings.of(cells, problem, noise)


def test_the_likelihood_of_a_reading_by_hand(house: CellMap) -> None:
    made, eyes = readings(house, 0.5), house.checkpoints[:1]
    told = made.likelihoods(eyes, np.array([[4.0, np.nan]]))
    assert told.shape == (1, 2, 9)
    np.testing.assert_array_equal(told[0, 1], 1.0)
    spread = np.sqrt(0.25 + house.areas / 12)
    away = np.array([math.dist(eyes[0], cell.centroid.coords[0]) for cell in house.cells])
    density = np.exp(-0.5 * ((away - 4.0) / spread) ** 2) / spread
    np.testing.assert_allclose(told[0, 0], density / density.max())


@pytest.mark.parametrize("believes", ["cell", "sight"])
def test_robots_that_stand_find_out_where_a_still_evader_is(office: CellMap, believes: str) -> None:
    """From two places there are at most two cells at the right distances."""
    team = Team(planner=Stationary(), start=(1, 60), range_noise=0.3, believes=believes)
    for hidden in (20, 35):
        episode = run_episode(
            office.plan,
            office,
            team,
            Evader(model=Still(), start=hidden),
            capture="cell",
            motion=StationaryMotion(),
            timing=Timing(limit=20.0),
        )
        free = episode.beliefs[-1, 1:] / (1.0 - episode.beliefs[-1, 0])
        likely = np.argsort(-free)[:2]
        assert hidden - 1 in likely
        assert free[likely].sum() > 0.9
        np.testing.assert_allclose(episode.beliefs.sum(axis=1), 1.0)


def test_readings_are_told_to_those_who_hear(office: CellMap) -> None:
    told, alone = (
        run_episode(
            office.plan,
            office,
            Team(start=(1, 60), range_noise=0.5, communication=links),
            seed=6,
            capture="cell",
            timing=Timing(limit=8.0),
        )
        for links in (Communication("full"), Communication("range", 2.0))
    )
    np.testing.assert_array_equal(told.own_beliefs[:, 0], told.beliefs)
    assert np.abs(alone.own_beliefs[-1, 0] - alone.beliefs[-1]).sum() > 0.1


def test_trials_of_a_team_that_measures_have_worlds_of_their_own(house: CellMap) -> None:
    given = {"trials": 3, "cells": house, "workers": 1, "capture": "cell", "timing": Timing(limit=60.0)}
    team = Team(range_noise=1.0, start=(1, 7))
    made = run_trials(house.plan, ["decoupled-entropy-1"], team=team, **given)
    assert made.engine == "separate"
    assert len(made.rows) == 3
    with pytest.raises(GeomsimError, match="measures ranges goes where its evader leads it"):
        run_trials(house.plan, ["decoupled-entropy-1"], team=team, engine="shared", **given)
    with pytest.raises(GeomsimError, match="A trial has one evader, but 2"):
        run_trials(house.plan, ["decoupled-entropy-1"], evader=Evader(count=2), **given)


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(GeomsimError, match="noise of ranges must be positive and finite, but is -1 m"):
        Team(range_noise=-1.0)
    with pytest.raises(GeomsimError, match="cannot be predicted: leave out range_noise"):
        predict_scenario(None, {"plan": "house", "range_noise": 1.0})
    with pytest.raises(EvidenceError, match="above 0; got 0"):
        measured_range([1.0, 2.0], 1.0, [1.0, 0.0])
