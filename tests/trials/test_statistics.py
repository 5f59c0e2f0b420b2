"""Statistics against textbook numbers and hand-made samples."""

import numpy as np
import pytest

from geomsim.trials.statistics import Times, compare_times, describe_times, survival

# Weeks to relapse of 21 patients with 6-mercaptopurine and 21 with placebo (Freireich and others 1963), the example of
# Kaplan-Meier and log-rank in most textbooks; False: censored.
DRUG = [6, 6, 6, 6, 7, 9, 10, 10, 11, 13, 16, 17, 19, 20, 22, 23, 25, 32, 32, 34, 35]
RELAPSE = [1, 1, 1, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0]
PLACEBO = [1, 1, 2, 2, 3, 4, 4, 5, 5, 8, 8, 8, 8, 11, 11, 12, 12, 15, 17, 22, 23]


def times(values: list[float], captured: list[int] | None = None, runs: int = 1) -> Times:
    told = np.ones(len(values)) if captured is None else np.array(captured)
    return Times(np.array(values, dtype=float), told.astype(bool), runs)


def test_kaplan_meier_is_that_of_the_textbook() -> None:
    curve = survival(times(DRUG, RELAPSE))
    told = dict(zip(curve.time.tolist(), curve.free.tolist(), strict=True))
    expected = {0: 1.0, 6: 0.8571, 7: 0.8067, 10: 0.7529, 13: 0.6902, 16: 0.6275, 22: 0.5378, 23: 0.4482}
    assert {t: told[float(t)] for t in expected} == pytest.approx(expected, abs=1e-4)
    assert (curve.low <= curve.free + 1e-12).all()
    assert (curve.free <= curve.high + 1e-12).all()
    sample = describe_times(times(DRUG, RELAPSE))
    assert (sample.median, sample.censored, sample.captured_share) == (23.0, 12, pytest.approx(9 / 21))


def test_logrank_is_that_of_the_textbook() -> None:
    """Chi-squared 16.79 with one degree of freedom."""
    from scipy.stats import chi2

    difference = compare_times(times(DRUG, RELAPSE), times(PLACEBO))
    assert chi2.isf(difference.logrank, 1) == pytest.approx(16.79, abs=0.01)


def test_mean_and_its_error() -> None:
    sample = describe_times(times([1.0, 2.0, 3.0, 6.0]))
    assert (sample.mean, sample.median, sample.captured_share, sample.censored) == (3.0, 2.0, 1.0, 0)
    assert sample.sem == pytest.approx(np.std([1, 2, 3, 6], ddof=1) / 2)
    assert describe_times(times([4.0])).sem is None
    assert describe_times(times([9.0, 9.0, 3.0], [0, 0, 1])).median is None


def test_trials_of_one_run_count_once() -> None:
    """Trials that are copies of their run say no more than the runs do."""
    luck = [10.0, 20.0, 60.0]
    shared = describe_times(times(luck * 50, runs=3))
    assert shared.sem == pytest.approx(np.std(luck, ddof=1) / np.sqrt(3))
    assert describe_times(times(luck * 50)).sem < shared.sem / 5


def test_paired_differences() -> None:
    """The Student interval of the differences, which pairs by trial."""
    one, other = [3.0, 9.0, 27.0, 81.0], [1.0, 8.0, 26.0, 78.0]
    difference = compare_times(times(one), times(other))
    spread = 3.182446 * np.std([2, 1, 1, 3], ddof=1) / 2  # quantile of t with 3 degrees of freedom, from a table
    assert (difference.difference, difference.low, difference.high) == pytest.approx(
        (1.75, 1.75 - spread, 1.75 + spread)
    )
    same = compare_times(times(one), times(one))
    assert (same.difference, same.low, same.high, same.logrank) == (0.0, 0.0, 0.0, None)
    assert compare_times(times([1.0]), times([2.0])).low is None


def test_intervals_cover_as_they_say() -> None:
    """95 % of intervals hold the truth, with shared runs too: 400 experiments, false alarm below 1 in 10,000."""
    rng = np.random.default_rng(7)
    covered = 0
    for _ in range(400):
        evader = rng.exponential(10, 200)
        run = rng.normal(0, 5, 20)[np.arange(200) % 20]
        method = times((evader + run + 3 + rng.normal(0, 2, 200)).tolist(), runs=20)
        difference = compare_times(method, times(evader.tolist()))
        covered += difference.low <= 3 <= difference.high
    assert 363 <= covered <= 395
