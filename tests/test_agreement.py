"""What the belief predicts is what happens, within what is said here.

The bank of evaders has a fixed seed. With 4,000 evaders an observed curve is further than 0.04 from the true one with a
probability below 6e-6 (Dvoretzky, Kiefer and Wolfowitz), so a test fails by chance less than once in 50,000 seeds.
"""

import numpy as np
import pytest

from discretize import CellMap
from geomsim import Decoupled, Stationary, Team, Timing, run_trials
from geomsim.believing import believed_problem
from geomsim.team import place_team
from planners import DwellTime, Planner, predict

SECONDS = 300


def gap(office: CellMap, planner: Planner, capture: str, believes: str) -> float:
    """Return the largest difference between the observed curve and the one that the belief predicts."""
    team = Team(planner=planner, believes=believes)
    made = run_trials(
        office.plan,
        {"it": planner},
        trials=4000,
        cells=office,
        team=team,
        capture=capture,
        motion=DwellTime(),
        timing=Timing(limit=float(SECONDS)),
        workers=1,
    )
    when = np.array([row.time if row.captured else np.inf for row in made.rows])
    seconds = np.arange(SECONDS)
    observed = (when > seconds[:, np.newaxis] + 1e-9).mean(axis=1)
    _, problem = believed_problem(office, team, DwellTime(), 1.0)
    (told,) = predict(problem, planner, [place_team(office, team)], np.random.default_rng(0), reachable=True)
    length = min(SECONDS, len(told.survival))
    return float(np.abs(observed[:length] - told.survival[:length]).max())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("planner", "most"), [(Stationary(), 0.06), (Decoupled("target-probability", 3), 0.07)], ids=repr
)
def test_dwell_time_predicts_capture_in_the_same_cell(office: CellMap, planner: Planner, most: float) -> None:
    found = gap(office, planner, "cell", "cell")
    assert found <= most


@pytest.mark.slow
def test_sight_in_the_belief_predicts_capture_by_sight(office: CellMap) -> None:
    planner = Decoupled("target-probability", 3)
    by_cell, by_sight = (gap(office, planner, "sight", believes) for believes in ("cell", "sight"))
    assert by_sight <= 0.12
    assert by_sight < by_cell - 0.1
