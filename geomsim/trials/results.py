"""The outcome of a comparison: a table of trials, and what it says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from geomsim.trials.experiment import Experiment, Row
from geomsim.trials.fidelity import Forecast
from geomsim.trials.statistics import (
    Difference,
    Sample,
    Survival,
    Times,
    compare_times,
    describe_times,
    survival,
)

__all__ = ["MethodRun", "MethodSummary", "Summary", "Trials"]


@dataclass(frozen=True, slots=True)
class MethodRun:
    """What is known of a method's team runs.

    Attributes
    ----------
    runs : int
        How many the trials share.
    seconds : float
        What they took to compute.
    seconds_per_decision : float
        The same for each decision of the planner, the belief and the bodies included.
    forecast : Forecast
        What is predicted.
    """

    runs: int
    seconds: float
    seconds_per_decision: float
    forecast: Forecast


@dataclass(frozen=True, slots=True)
class MethodSummary:
    """One line of the table.

    Attributes
    ----------
    name : str
        Of the method.
    observed : Sample
        What the trials say.
    predicted : float
        Predicted mean capture time, seconds: by a belief over places where capture is by sight, else in the cell
        model.
    gap : float
        Largest difference between the predicted and the observed share captured, over time.
    difference : Difference or None
        Against the reference; None for the reference itself.
    run : MethodRun
        What is known of its team runs.
    """

    name: str
    observed: Sample
    predicted: float
    gap: float
    difference: Difference | None
    run: MethodRun


@dataclass(frozen=True, slots=True)
class Summary:
    """The table of a comparison; its text is the table.

    Attributes
    ----------
    methods : tuple of MethodSummary
        In the order in which they were given.
    reference : str
        The method that others are compared with.
    trials : int
        For each method.
    limit : float
        Time limit, seconds.
    rank_correlation : float or None
        Kendall's tau between predicted and observed mean; None with less than two methods.
    """

    methods: tuple[MethodSummary, ...]
    reference: str
    trials: int
    limit: float
    rank_correlation: float | None

    def __getitem__(self, name: str) -> MethodSummary:
        return next(method for method in self.methods if method.name == name)

    def __str__(self) -> str:
        width = max(len(method.name) for method in self.methods)
        head = f"{'method':<{width}}  {'mean':>8} {'SEM':>6} {'median':>7} {'captured':>8} {'predicted':>9}"
        lines = [head + f"  against {self.reference}, 95 % interval"]
        for method in self.methods:
            seen, gap = method.observed, method.difference
            mean = f"{'>=' if seen.censored else ''}{seen.mean:.1f}"
            cells = f"{mean:>8} {_told(seen.sem, 2):>6} {_told(seen.median, 1):>7} {seen.captured_share:>8.1%}"
            line = f"{method.name:<{width}}  {cells} {method.predicted:>9.1f}"
            if gap is not None:
                line += f"  {gap.difference:+.1f} [{_told(gap.low, 1, '+')}, {_told(gap.high, 1, '+')}]"
            lines.append(line)
        if any(method.observed.censored for method in self.methods):
            lines.append(
                f"Trials not captured within {self.limit:g} s count with that time in means and differences, "
                "which are therefore bounds."
            )
        return "\n".join(lines)


@dataclass(frozen=True)
class Trials:
    """Many trials of several methods against the same evaders.

    Attributes
    ----------
    experiment : Experiment
        What was compared.
    rows : tuple of Row
        One for each method and trial, method after method, in the order of trials.
    runs : tuple of MethodRun
        What is known of each method's team.
    reference : str
        The method that others are compared with.
    engine : {"shared", "separate"}
        Whether one bank of evaders served all methods, or every trial had a world of its own.
    wall_crossings : int
        Moves of bodies through walls, which must be none.
    wall_seconds : float
        How long it all took.
    notes : tuple of str
        What a person should know, a sentence each.
    files : mapping
        What was written, by kind.
    """

    experiment: Experiment
    rows: tuple[Row, ...]
    runs: tuple[MethodRun, ...]
    reference: str
    engine: str
    wall_crossings: int
    wall_seconds: float
    notes: tuple[str, ...] = ()
    files: Mapping[str, Path] = field(default_factory=dict)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the methods."""
        return tuple(method.name for method in self.experiment.methods)

    def times(self, name: str) -> Times:
        """Return the capture times of a method, in the order of trials."""
        rows = [row for row in self.rows if row.method == name]
        return Times(
            time=np.array([row.time for row in rows]),
            captured=np.array([row.captured for row in rows]),
            runs=self.runs[self.names.index(name)].runs,
        )

    def survival(self, name: str) -> Survival:
        """Return the Kaplan-Meier curve of a method."""
        return survival(self.times(name))

    def summary(self) -> Summary:
        """Return the table."""
        return self._summary

    @cached_property
    def _summary(self) -> Summary:
        from scipy.stats import kendalltau

        reference = self.times(self.reference)
        lines = []
        for name, run in zip(self.names, self.runs, strict=True):
            times = self.times(name)
            gap = run.forecast.gap(self.survival(name), self.experiment.timing.limit)
            difference = None if name == self.reference else compare_times(times, reference)
            lines.append(MethodSummary(name, describe_times(times), run.forecast.mean, gap, difference, run))
        seen, said = np.array([(line.observed.mean, line.predicted) for line in lines]).T
        varied = len(lines) > 1 and np.ptp(seen) > 0 and np.ptp(said) > 0
        tau = float(kendalltau(seen, said).statistic) if varied else None
        return Summary(tuple(lines), self.reference, self.experiment.trials, self.experiment.timing.limit, tau)

    def as_dict(self) -> dict[str, Any]:
        """Return the table in plain values, as JSON has it."""
        summary = self.summary()
        return {
            "methods": [
                {
                    "name": line.name,
                    "mean": line.observed.mean,
                    "mean_is_lower_bound": line.observed.censored > 0,
                    "sem": line.observed.sem,
                    "median": line.observed.median,
                    "captured_share": line.observed.captured_share,
                    "censored": line.observed.censored,
                    "trials": self.experiment.trials,
                    "predicted_mean": line.predicted,
                    "predicted_ratio": line.predicted / line.observed.mean,
                    "curve_gap": line.gap,
                    "belief": self.experiment.team_for(k).belief,
                    "team_runs": line.run.runs,
                    "seconds": line.run.seconds,
                    "seconds_per_decision": line.run.seconds_per_decision,
                }
                for k, line in enumerate(summary.methods)
            ],
            "reference": self.reference,
            "paired": [
                {
                    "name": line.name,
                    "difference": line.difference.difference,
                    "low": line.difference.low,
                    "high": line.difference.high,
                    "logrank_p": line.difference.logrank,
                }
                for line in summary.methods
                if line.difference is not None
            ],
            "rank_correlation": summary.rank_correlation,
            "wall_seconds": self.wall_seconds,
            "wall_crossings": self.wall_crossings,
            "engine": self.engine,
            "notes": list(self.notes),
            "scenario": self.experiment.about(),
            "files": {kind: str(path) for kind, path in self.files.items()},
        }


def _told(value: float | None, digits: int, sign: str = "") -> str:
    return "-" if value is None else f"{value:{sign}.{digits}f}"
