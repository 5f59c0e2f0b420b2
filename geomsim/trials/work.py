"""The work of a comparison, in tasks that depend on nothing but their arguments."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geomsim.trials.bank import Meetings, meet
from geomsim.trials.episodes import run_episodes
from geomsim.trials.experiment import Experiment, Row
from geomsim.trials.fidelity import Forecast, forecast
from geomsim.trials.foresight import foresee
from geomsim.trials.results import MethodRun
from geomsim.trials.store import Store
from geomsim.trials.teamruns import TeamRun, run_team
from geomsim.trials.workforce import Workforce

__all__ = ["Progress", "Work"]

#: how far the first round goes, seconds, and how many times as far each next one; a round begins anew for those
#: evaders that are still free, so that tasks depend on nothing but their arguments
_FIRST_ROUND, _FURTHER = 75.0, 4

#: most evaders in one space: with more the broad phase costs more than it saves
_BLOCK = 500

#: most runs of a team that a forecast follows: where evaders react each trial has one of its own
_FORECASTS = 20

#: trials in a task of the separate engine
_EPISODES = 8

Progress = Callable[[str, int, int], None]
"""Told a method's name, how many of its trials are decided, and how many there are."""


@dataclass(slots=True)
class Work:
    """What is done, and what is left to do."""

    experiment: Experiment
    workforce: Workforce
    store: Store | None
    progress: Progress | None
    rows: dict[tuple[int, int], Row] = field(default_factory=dict)
    runs: dict[int, dict[int, TeamRun]] = field(default_factory=dict)
    seconds: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))
    forecasts: dict[int, Forecast] = field(default_factory=dict)
    crossings: int = 0
    held_up: set[int] = field(default_factory=set)

    def __post_init__(self) -> None:
        number = {method.name: m for m, method in enumerate(self.experiment.methods)}
        if self.store is not None:
            self.rows = {(number[row.method], row.trial): row for row in self.store.rows}
        self.runs = {m: {} for m in number.values()}
        self.seconds = np.zeros(len(number))
        for m in number.values():
            self._tell(m)

    def free(self, method: int) -> list[int]:
        """Return the trials of a method that are not decided yet."""
        return [k for k in range(self.experiment.trials) if (method, k) not in self.rows]

    def rounds(self) -> Iterator[int]:
        """Yield how far each round goes, physics steps; the last one goes to the time limit."""
        limit, reach = self.experiment.timing.steps, _FIRST_ROUND
        while (steps := math.ceil(reach / self.experiment.timing.physics_step)) < limit:
            yield steps
            reach *= _FURTHER
        yield limit

    def shared(self) -> None:
        """Go round after round, each further than the one before, until every trial is decided."""
        for steps in self.rounds():
            free = {m: left for m in self.runs if (left := self.free(m))}
            self._run_teams(free, steps)
            for found in self.workforce.do(meet, self._blocks(free, steps)):
                self._take(found)
        last = self.experiment.timing.steps
        self._keep(self.experiment.row(m, k, last, captured=False) for m in self.runs for k in self.free(m))

    def separate(self) -> None:
        """Run every trial as an episode of its own."""
        tasks = [
            (self.experiment, m, left[first : first + _EPISODES])
            for m in self.runs
            if (left := self.free(m))
            for first in range(0, len(left), _EPISODES)
        ]
        for found in self.workforce.do(run_episodes, tasks):
            self._take(found)

    def settle(self) -> None:
        """Learn what does not depend on evaders: whether chance had a part, and what is predicted."""
        tasks = []
        for m in self.runs:
            self._run([(m, [0])], max(self._reaches(m, 1)))
            runs = self.experiment.team_runs if self.runs[m][0].drew else 1
            reaches = self._reaches(m, runs)[:_FORECASTS]
            for steps in sorted(set(reaches)):
                self._run([(m, [r for r, reach in enumerate(reaches) if reach == steps])], steps)
            sight = self.experiment.capture == "sight"
            met = [self.runs[m][r].cut(steps, sight=sight) for r, steps in enumerate(reaches)]
            tasks.append((self.experiment, m, met))
        self.forecasts = dict(self.workforce.do(_numbered_forecast, tasks))

    def _reaches(self, method: int, runs: int) -> list[int]:
        """Return how far each run of a team went in the round in which the last of its trials was decided."""
        last = np.zeros(runs)
        for (m, trial), row in self.rows.items():
            if m == method:
                last[trial % runs] = max(last[trial % runs], row.time)
        ends = list(self.rounds())
        at = np.searchsorted(np.array(ends) * self.experiment.timing.physics_step, last - 1e-6)
        return [ends[k] for k in at.tolist()]

    def _run_teams(self, free: Mapping[int, list[int]], steps: int) -> None:
        """Make sure of the team runs that the free trials meet; the first run tells whether chance has a part."""
        self._run([(m, [0]) for m in free], steps)
        more = []
        for m, left in free.items():
            if self.runs[m][0].drew:
                met = sorted({k % self.experiment.team_runs for k in left} - {0})
                size = math.ceil(len(met) / self.workforce.workers) or 1
                more += [(m, met[first : first + size]) for first in range(0, len(met), size)]
        self._run(more, steps)

    def _run(self, wanted: Iterable[tuple[int, list[int]]], steps: int) -> None:
        missing = [(m, [r for r in runs if self._covered(m, r) < steps]) for m, runs in wanted]
        tasks = [(self.experiment, m, runs, steps) for m, runs in missing if runs]
        for m, made in self.workforce.do(_numbered_run, tasks):
            for run in made:
                self.runs[m][run.run] = run
                self.seconds[m] += run.seconds
                self.crossings += run.crossings

    def _covered(self, method: int, run: int) -> int:
        return self.runs[method][run].steps if run in self.runs[method] else -1

    def _blocks(self, free: Mapping[int, list[int]], steps: int) -> list[tuple[Any, ...]]:
        trials = sorted(set().union(*free.values()))
        size = min(_BLOCK, max(25, math.ceil(len(trials) / self.workforce.workers)))
        tasks = []
        for first in range(0, len(trials), size):
            block = set(trials[first : first + size])
            mine = {m: met for m, left in free.items() if (met := [k for k in left if k in block])}
            runs = {m: self._met(m, met, steps) for m, met in mine.items()}
            tasks.append((self.experiment, runs, mine, steps))
        return tasks

    def _met(self, method: int, trials: list[int], steps: int) -> list[TeamRun]:
        runs = self.runs[method]
        numbers = sorted({k % self.experiment.team_runs for k in trials}) if runs[0].drew else [0]
        return [runs[r].cut(steps, sight=self.experiment.capture == "sight") for r in numbers]

    def _take(self, found: Meetings) -> None:
        self.crossings += found.crossings
        self.held_up |= found.held_up
        self._keep(found.rows)

    def _keep(self, rows: Iterable[Row]) -> None:
        number = {method.name: m for m, method in enumerate(self.experiment.methods)}
        fresh = {(number[row.method], row.trial): row for row in rows}
        if self.store is not None and fresh:
            self.store.append(fresh.values())
        self.rows |= fresh
        for m in {m for m, _ in fresh}:
            self._tell(m)

    def _tell(self, method: int) -> None:
        if self.progress is not None:
            done = self.experiment.trials - len(self.free(method))
            self.progress(self.experiment.methods[method].name, done, self.experiment.trials)

    def sorted_rows(self) -> list[Row]:
        """Return the rows, method after method, in the order of trials."""
        return [self.rows[key] for key in sorted(self.rows)]

    def method_runs(self) -> tuple[MethodRun, ...]:
        """Return what is known of each method's team."""
        told = []
        for m in self.runs:
            first, runs = self.runs[m][0], self.runs[m].values()
            told.append(
                MethodRun(
                    runs=self.experiment.team_runs if first.drew else 1,
                    seconds=float(self.seconds[m]),
                    seconds_per_decision=sum(r.seconds for r in runs) / max(1, sum(r.decisions for r in runs)),
                    forecast=self.forecasts[m],
                )
            )
        return tuple(told)

    def notes(self) -> tuple[str, ...]:
        """Return what a person should know, a sentence each."""
        told = []
        if self.experiment.team.range_noise is not None:
            told.append("Predictions are those of the same team without its measurements of ranges.")
        for m, runs in self.runs.items():
            for run in runs.values():
                told += [
                    f"{self.experiment.methods[m].name}: pursuer {i + 1} was held up at a wall for 10 s or more."
                    for i in run.held_up
                ]
        if self.held_up:
            some = ", ".join(str(k) for k in sorted(self.held_up)[:5])
            told.append(f"The evader was held up at a wall for 10 s or more in {len(self.held_up)} trials: {some} ...")
        return tuple(dict.fromkeys(told))


def _numbered_run(experiment: Experiment, method: int, runs: list[int], steps: int) -> tuple[int, list[TeamRun]]:
    return method, run_team(experiment, method, runs, steps)


def _numbered_forecast(experiment: Experiment, method: int, runs: list[TeamRun]) -> tuple[int, Forecast]:
    predict = foresee if experiment.capture == "sight" else forecast
    return method, predict(experiment, runs)
