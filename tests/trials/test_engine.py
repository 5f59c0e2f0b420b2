"""Shared and separate engines give the same captures; so do any workers, and a run that was cut off."""

import math
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from discretize import CellMap
from geomsim import (
    Decoupled,
    Evader,
    GeomsimError,
    Hiding,
    Random,
    Sensor,
    ShortestPaths,
    Stationary,
    Still,
    Team,
    Timing,
    run_episode,
)
from geomsim.evaders import Fleeing
from geomsim.seeds import trial_seeds
from geomsim.trials import Trials, run_trials
from geomsim.trials.bank import Bank
from geomsim.trials.experiment import Experiment
from geomsim.walking import Route, Routes

FAST = {"still": Stationary(), "random": Random(), "greedy": Decoupled(depth=1)}


def compare(cells: CellMap, **options: object) -> Trials:
    given = {"methods": FAST, "trials": 24, "workers": 1, "timing": Timing(limit=400.0), "team_runs": 3} | options
    methods = given.pop("methods")
    return run_trials(cells.plan, methods, cells=cells, **given)


KINDS = {
    "sight": {},
    "cell": {"capture": "cell"},
    "a short, narrow and slow eye": {"team": Team(start=(2,), sensor=Sensor(5.0, 2.0, 0.3)), "trials": 12},
    "an eye for each": {
        "team": Team(sensor=(Sensor(4.0), Sensor(detection=0.3, field_of_view=2.0)), speed=(1.0, 0.6)),
        "trials": 12,
    },
    "cell, slow": {"capture": "cell", "team": Team(sensor=Sensor(detection=0.2))},
    "shortest paths": {"evader": Evader(model=ShortestPaths(), speed=0.7), "capture": "cell"},
    "hiding": {"evader": Evader(model=Hiding()), "team": Team(pursuers=3, speed=1.4)},
    "immobile": {"evader": Evader(model=Still(), radius=0.15), "timing": Timing(limit=60.0)},
    "other clocks": {"timing": Timing(limit=90.3, belief_step=0.5, physics_step=0.05)},
}


@pytest.mark.parametrize("kind", KINDS)
def test_shared_and_separate_agree(house: CellMap, kind: str) -> None:
    """The same rows to the last digit: capture or not, when, by whom and where."""
    shared, separate = (compare(house, engine=engine, **KINDS[kind]) for engine in ("shared", "separate"))
    assert (shared.engine, separate.engine) == ("shared", "separate")
    assert shared.rows == separate.rows
    assert len(shared.rows) == 3 * shared.experiment.trials
    assert shared.wall_crossings == separate.wall_crossings == 0
    assert len({row.time for row in shared.rows}) > 6


@pytest.mark.slow
@pytest.mark.parametrize("capture", ["sight", "cell"])
def test_shared_and_separate_agree_in_the_office(office: CellMap, capture: str) -> None:
    shared, separate = (
        compare(office, engine=engine, capture=capture, trials=100, workers=2) for engine in ("shared", "separate")
    )
    assert shared.rows == separate.rows


def test_a_trial_is_an_episode(house: CellMap) -> None:
    """What a row tells is enough to repeat it."""
    trials = compare(house, capture="cell")
    for row in trials.rows[5::7]:
        team = Team(planner=FAST[row.method])
        episode = run_episode(
            house.plan, house, team, seed=row.seed, team_seed=row.team_seed, capture="cell", timing=Timing(limit=400.0)
        )
        out = episode.outcome
        assert episode.evader_cells[0] + 1 == row.start
        assert (out.captured, out.time) == (row.captured, pytest.approx(row.time))
        if row.captured:
            assert (out.pursuer + 1, out.cell + 1) == (row.pursuer, row.cell)
            assert out.position == pytest.approx((row.x, row.y), abs=1e-3)


def test_the_bank_moves_as_single_evaders_do(office: CellMap) -> None:
    """Positions in single precision, step by step, also after others have left."""
    timing = Timing(limit=150.0)
    experiment = Experiment(
        cells=office,
        methods=(),
        team=Team(),
        evader=Evader(),
        capture="cell",
        motion=None,
        timing=timing,
        trials=40,
        team_runs=1,
        seed=4,
    )
    bank = Bank(experiment, range(40))
    reels = [bank.reel(500)]
    bank.keep(np.isin(np.arange(40), [3, 17, 21]))
    reels.append(bank.reel(1000))
    assert reels[1].trials.tolist() == [3, 17, 21]
    for column, trial in enumerate(reels[1].trials):
        alone = run_episode(
            office.plan,
            office,
            Team(planner=Stationary(), sensor=Sensor(range=0.01)),
            seed=experiment.seeds[trial],
            timing=timing,
        )
        track = np.concatenate([reels[0].positions[:, trial], reels[1].positions[1:, column]])
        cells = np.concatenate([reels[0].cells[:, trial], reels[1].cells[1:, column]])
        steps = len(alone.times)  # it may walk into the robot
        assert steps > 700
        assert np.array_equal(track[:steps], alone.evader.astype(np.float32))
        assert np.array_equal(cells[:steps], alone.evader_cells)


def test_workers_change_nothing(house: CellMap) -> None:
    one = compare(house, trials=60)
    assert compare(house, trials=60, workers=3).rows == one.rows
    with ThreadPoolExecutor(2) as pool:
        assert compare(house, trials=60, executor=pool).rows == one.rows
    assert compare(house, trials=60, workers=3, engine="separate").rows == one.rows
    assert one.as_dict()["methods"][0]["predicted_mean"] == pytest.approx(
        compare(house, trials=60, workers=3).as_dict()["methods"][0]["predicted_mean"], rel=1e-12
    )


def test_more_methods_and_trials_change_nothing(house: CellMap) -> None:
    few, many = compare(house, trials=12, methods={"random": Random()}), compare(house)
    assert few.rows == tuple(row for row in many.rows if row.method == "random" and row.trial < 12)
    assert trial_seeds(3, 10) == trial_seeds(3, 1000)[:10]
    assert len(set(trial_seeds(3, 1000) + trial_seeds(4, 1000))) == 2000


def test_only_chance_needs_several_runs(house: CellMap) -> None:
    trials = compare(house)
    runs = {line.name: line.run.runs for line in trials.summary().methods}
    assert (runs["still"], runs["random"]) == (1, 3)
    assert [row.team_seed for row in trials.rows] == [trials.rows[k % 24 % 3].seed for k in range(3 * 24)]


def test_who_reacts_gets_a_world_of_its_own(house: CellMap) -> None:
    fleeing = compare(house, evader=Evader(model=Fleeing()), capture="cell", trials=8)
    assert fleeing.engine == "separate"
    assert len({row.team_seed for row in fleeing.rows}) == 8
    with pytest.raises(GeomsimError, match="Fleeing reacts to robots"):
        compare(house, evader=Evader(model=Fleeing()), engine="shared")


def test_several_evaders(house: CellMap) -> None:
    """A trial ends with the last of them; robots learn of each capture, so that each trial has a world of its own."""
    pair = compare(house, evader=Evader(count=2), capture="cell", trials=8)
    assert (pair.engine, len(pair.rows), pair.wall_crossings) == ("separate", 24, 0)
    for row in pair.rows[::5]:
        team = Team(planner=FAST[row.method])
        episode = run_episode(
            house.plan,
            house,
            team,
            Evader(count=2),
            seed=row.seed,
            team_seed=row.team_seed,
            capture="cell",
            timing=Timing(limit=400.0),
        )
        assert (episode.outcome.captured, episode.outcome.time) == (row.captured, pytest.approx(row.time))
        assert len(episode.outcome.captures) == 2
    one = compare(house, capture="cell", trials=8)
    for alone, both in zip(one.summary().methods, pair.summary().methods, strict=True):
        assert both.predicted > alone.predicted
    with pytest.raises(GeomsimError, match="With 2 evaders robots search on"):
        compare(house, evader=Evader(count=2), engine="shared")


class Stubborn:
    """Walks east, walls or not."""

    def walk(self, routes: Routes, cell: int, rng: np.random.Generator, lookout: object) -> Iterator[Route]:
        here = routes.checkpoint(cell)
        way = np.stack([here, here + np.array([100.0, 0.0])])
        while True:
            yield Route((cell, cell), (cell, cell), way, np.array([0.0, 100.0]), math.inf, 100.0)


@pytest.mark.parametrize("engine", ["shared", "separate"])
def test_who_makes_no_progress_is_reported(house: CellMap, engine: str) -> None:
    """Ten seconds at a wall are a note, not silence; and the wall holds."""
    trials = compare(
        house,
        methods={"still": Stationary()},
        evader=Evader(model=Stubborn()),
        team=Team(start=(7,)),
        capture="cell",
        engine=engine,
        trials=6,
        timing=Timing(limit=30.0),
    )
    assert trials.wall_crossings == 0
    assert any("The evader was held up at a wall for 10 s or more in 6 trials" in note for note in trials.notes)


def test_what_is_not_captured_is_censored(house: CellMap) -> None:
    trials = compare(
        house, evader=Evader(model=Still()), team=Team(start=(7,)), capture="cell", timing=Timing(limit=30.0)
    )
    left = [row for row in trials.rows if row.method == "still"]
    assert {(row.captured, row.time, row.pursuer, row.x) for row in left} == {(False, 30.0, None, None)}
    line = trials.summary()["still"]
    assert (line.observed.censored, line.observed.mean, line.observed.median) == (24, 30.0, None)
    assert ">=30.0" in str(trials.summary())
    assert "bounds" in str(trials.summary())


def test_progress_is_told(house: CellMap) -> None:
    told: list[tuple[str, int, int]] = []
    compare(house, progress=lambda *said: told.append(said))
    for name in FAST:
        counts = [done for who, done, total in told if who == name and total == 24]
        assert counts == sorted(counts)
        assert (counts[0], counts[-1]) == (0, 24)


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"trials": 0}, "at least one trial, but 0"),
        ({"team_runs": 0}, "at least one team run"),
        ({"workers": 0}, "at least one worker"),
        ({"methods": []}, "no method to be tried"),
        ({"methods": ["random", "stationary", "random"]}, "'random' is named twice"),
        ({"methods": ["decoupled", "decoupled-entropy-5"]}, "'decoupled-entropy-5' is named twice"),
        ({"methods": ["rondom"]}, "no method 'rondom'; did you mean 'random'"),
        ({"methods": ["decoupled-entrpy-5"]}, "did you mean 'entropy'"),
        ({"methods": ["random-3"]}, "takes none"),
        ({"methods": ["random-entropy"]}, "takes no cost"),
        ({"reference": "rando"}, "none of the methods: did you mean 'random'"),
        ({"engine": "both"}, "There is no engine 'both'"),
        ({"capture": "smell"}, "no capture rule"),
        ({"team": Team(start=(99,))}, "no start cell 99"),
        ({"evader": Evader(start=4), "team": Team(start=(4,))}, "sees the evader from where it starts"),
        ({"evader": Evader(start=4), "team": Team(start=(4,)), "capture": "cell"}, "starts in a pursuer's cell"),
    ],
    ids=str,
)
def test_bad_input_is_a_sentence(house: CellMap, options: dict[str, object], sentence: str) -> None:
    with pytest.raises(GeomsimError, match=sentence):
        compare(house, **options)


def test_names_say_what_methods_are() -> None:
    from geomsim.trials.methods import make_methods

    (method,) = make_methods(["decoupled-target-probability-3"])
    assert method.planner == Decoupled(cost="target-probability", depth=3)
    assert [m.name for m in make_methods(["decoupled", "decoupled-2", "decoupled-probability"])] == [
        "decoupled-entropy-5",
        "decoupled-entropy-2",
        "decoupled-probability-5",
    ]


def test_evaders_start_in_all_cells_alike(house: CellMap) -> None:
    """Chi-squared test at 0.1 %."""
    from scipy.stats import chisquare

    trials = compare(house, trials=240, methods={"still": Stationary()}, team=Team(start=(7,)))
    starts = np.bincount([row.start for row in trials.rows], minlength=10)[1:]
    assert starts[6] == 0
    assert chisquare(np.delete(starts, 6)).pvalue > 1e-3
    assert starts.max() < 240 / 8 + 4 * math.sqrt(240 / 8)
