"""Statistics of capture times, censored at the time limit; all tests and estimates are SciPy's."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Difference", "Sample", "Survival", "Times", "compare_times", "describe_times", "survival"]

_LEVEL = 0.95


@dataclass(frozen=True, slots=True)
class Times:
    """Capture times of one method, in the order of trials.

    Attributes
    ----------
    time : ndarray, shape (n,)
        When the evader was captured, or the time limit, seconds.
    captured : ndarray of bool, shape (n,)
        Which of the two.
    runs : int
        Number of team runs; trial ``k`` met run ``k % runs``. Trials of the same run share its luck.
    """

    time: NDArray[np.float64]
    captured: NDArray[np.bool_]
    runs: int


@dataclass(frozen=True, slots=True)
class Sample:
    """What is told of one method.

    Attributes
    ----------
    mean : float
        Mean capture time, seconds; where trials are censored each counts with the time limit, so that this is a
        lower bound.
    sem : float or None
        Its standard error; where several runs of a team share the trials, that of the means of the runs.
    median : float or None
        From the Kaplan-Meier curve, seconds; None where fewer than half are captured.
    captured_share : float
        Share of trials captured within the time limit.
    censored : int
        Trials that were not.
    """

    mean: float
    sem: float | None
    median: float | None
    captured_share: float
    censored: int


@dataclass(frozen=True, slots=True)
class Survival:
    """Kaplan-Meier curve of the share still free, as steps.

    Attributes
    ----------
    time : ndarray, shape (k,)
        Seconds.
    free : ndarray, shape (k,)
        Share still free from that time on.
    low, high : ndarray, shape (k,)
        Bounds of the 95 % confidence band (log-log).
    """

    time: NDArray[np.float64]
    free: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Difference:
    """A method against the reference, trial by trial.

    Attributes
    ----------
    difference : float
        Mean of its capture time less that of the reference, seconds; censored trials count with the time limit.
    low, high : float or None
        95 % interval (Student's t); None where there is nothing to estimate it from.
    logrank : float or None
        p value of the log-rank test that both capture alike, which takes trials for independent and unpaired.
    """

    difference: float
    low: float | None
    high: float | None
    logrank: float | None


def describe_times(times: Times) -> Sample:
    """Describe the capture times of one method."""
    from scipy.stats import sem

    independent = _by_run(times.time, times.runs)
    curve = survival(times)
    half = np.flatnonzero(curve.free <= 0.5)
    return Sample(
        mean=float(times.time.mean()),
        sem=float(sem(independent)) if len(independent) > 1 else None,
        median=float(curve.time[half[0]]) if len(half) else None,
        captured_share=float(times.captured.mean()),
        censored=int(np.count_nonzero(~times.captured)),
    )


def survival(times: Times) -> Survival:
    """Return the Kaplan-Meier estimate; it begins at time 0 with all still free."""
    from scipy.stats import CensoredData, ecdf

    estimate = ecdf(CensoredData.right_censored(times.time, ~times.captured)).sf
    free = np.asarray(estimate.probabilities, dtype=np.float64)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="The confidence interval is undefined")
        band: Any = estimate.confidence_interval(_LEVEL, method="log-log")
    # the band is undefined where all or none are free
    low, high = (np.where(np.isnan(b.probabilities), free, b.probabilities) for b in (band.low, band.high))
    start = np.ones(1)
    return Survival(
        time=np.concatenate([[0.0], estimate.quantiles]),
        free=np.concatenate([start, free]),
        low=np.concatenate([start, low]),
        high=np.concatenate([start, high]),
    )


def compare_times(times: Times, reference: Times) -> Difference:
    """Compare a method with the reference, both with the same evaders."""
    from scipy.stats import CensoredData, logrank, ttest_1samp

    gap = times.time - reference.time
    independent = _by_run(gap, max(times.runs, reference.runs))
    low = high = None
    if len(independent) > 1 and np.ptp(independent) > 0:
        interval = ttest_1samp(independent, 0.0).confidence_interval(_LEVEL)
        low, high = float(interval.low), float(interval.high)
    elif len(independent) > 1:
        low = high = float(independent[0])
    x, y = (CensoredData.right_censored(t.time, ~t.captured) for t in (times, reference))
    differs = (times.captured.any() or reference.captured.any()) and gap.any()
    return Difference(float(gap.mean()), low, high, float(logrank(x, y).pvalue) if differs else None)


def _by_run(values: NDArray[np.float64], runs: int) -> NDArray[np.float64]:
    """Return independent values: those of the trials, or where trials share a run the means over each."""
    if runs == 1:
        return values
    run = np.arange(len(values)) % runs
    return np.asarray(np.bincount(run, weights=values) / np.bincount(run))
