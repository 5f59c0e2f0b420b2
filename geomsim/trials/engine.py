"""Trials by the thousand: one bank of evaders, one run of the team for each method, one pass of sight over the bank.

Sharing is right as long as nothing that robots learn, and nothing that the evader does, depends on the other side
before the capture. Where an evader reacts, every trial gets a world of its own.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from discretize import CellMap
from geomsim.pursuit import Timing, check_pursuit, run_episode
from geomsim.team import Evader, Team
from geomsim.trials.bank import Meetings, meet
from geomsim.trials.experiment import Experiment, Row
from geomsim.trials.methods import make_methods
from geomsim.trials.results import MethodRun, Trials
from geomsim.trials.store import Store
from geomsim.trials.teamruns import NEARLY_SURE, TeamRun, run_team
from geomsim.trials.workforce import Workforce
from geomsim.world import World
from maps import FloorPlan, GeomsimError, nearest
from planners import AreaSpeedDegree, MotionModel, Planner

__all__ = ["ENGINES", "run_trials"]

ENGINES = {
    "auto": "shared where it is right, else separate",
    "shared": "one bank of evaders for all methods, one team run for all evaders",
    "separate": "one world for each trial",
}

#: how far the first round goes, seconds, and how many times as far each next one; a round begins anew for those
#: evaders that are still free, so that tasks depend on nothing but their arguments
_FIRST_ROUND, _FURTHER = 75.0, 4

#: most evaders in one space: with more the broad phase costs more than it saves
_BLOCK = 250

#: trials in a task of the separate engine
_EPISODES = 8

Progress = Callable[[str, int, int], None]


def run_trials(
    plan: FloorPlan,
    methods: Iterable[str] | Mapping[str, Planner],
    *,
    trials: int = 1000,
    cells: CellMap | None = None,
    team: Team | None = None,
    evader: Evader | None = None,
    seed: int = 0,
    capture: str = "sight",
    motion: MotionModel | None = None,
    timing: Timing | None = None,
    reference: str | None = None,
    team_runs: int = 20,
    engine: str = "auto",
    executor: Executor | None = None,
    workers: int | None = None,
    folder: str | Path | None = None,
    progress: Progress | None = None,
) -> Trials:
    """Let several methods search for the same evaders, many times.

    Parameters
    ----------
    plan : FloorPlan
        Where.
    methods : iterable of str, or mapping of str to Planner
        Names such as ``random`` or ``decoupled-entropy-5``, or a user's own planners by name.
    trials : int
        Number of evaders that each method searches for.
    cells : CellMap, optional
        The plan cut into cells; by default ``convex_cells`` for the larger of the bodies.
    team : Team, optional
        Who searches; its planner is that of each method in turn.
    evader : Evader, optional
        Who is searched for.
    seed : int
        The same seed gives the same table, whatever the workers, and the same evaders whatever the methods.
    capture : {"sight", "cell"}
        What counts as capture.
    motion : MotionModel, optional
        What the team believes of the evader's motion; by default area, speed and degree (Section V).
    timing : Timing, optional
        Clocks; by default trials are given up after 10,000 s.
    reference : str, optional
        The method that others are compared with; by default the first.
    team_runs : int
        Runs of a team whose planner draws random numbers, spread evenly over the trials. A planner that draws none
        has one run.
    engine : {"auto", "shared", "separate"}
        See ``ENGINES``.
    executor : Executor, optional
        Where the work is done; by default a pool of processes.
    workers : int, optional
        Size of that pool; by default one for each core.
    folder : str or Path, optional
        Where results are kept as they come; the same call goes on where it was interrupted.
    progress : callable, optional
        Told a method's name, how many of its trials are decided, and how many there are.

    Returns
    -------
    Trials
        One row for each method and trial, and their statistics.

    Raises
    ------
    GeomsimError
        If something cannot be run, or every evader would be captured at once.
    """
    begun = clock.perf_counter()
    team, evader, timing = team or Team(), evader or Evader(), timing or Timing(limit=10_000.0)
    made = make_methods(methods)
    names = [method.name for method in made]
    for what, count in (("trial", trials), ("team run", team_runs)):
        if count < 1:
            raise GeomsimError(f"There must be at least one {what}, but {count} were asked for.")
    if reference is not None and reference not in names:
        raise GeomsimError(f"The reference {reference!r} is none of the methods: {nearest(reference, names)}")
    chosen = _engine(engine, evader)
    if cells is None:
        from discretize import convex_cells

        cells = convex_cells(plan, radius=max(team.radius, evader.radius))
    check_pursuit(cells, team, evader, capture)
    reacts = bool(getattr(evader.model, "reacts", False))
    experiment = Experiment(
        cells=cells,
        methods=made,
        team=team,
        evader=evader,
        capture=capture,
        motion=motion or AreaSpeedDegree(evader.speed),
        timing=timing,
        trials=trials,
        team_runs=trials if reacts else min(team_runs, trials),
        seed=seed,
    )
    _check_start(experiment)
    store = None if folder is None else Store(Path(folder), {**experiment.about(), "engine": chosen})
    with Workforce(executor, workers) as workforce:
        work = _Work(experiment, workforce, store, progress)
        work.shared() if chosen == "shared" else work.separate()
    rows = work.sorted_rows()
    return Trials(
        experiment=experiment,
        rows=tuple(rows),
        runs=work.method_runs(),
        reference=reference or names[0],
        engine=chosen,
        wall_crossings=work.crossings,
        wall_seconds=clock.perf_counter() - begun,
        notes=work.notes(),
        files={} if store is None else store.finish(rows),
    )


def _engine(asked: str, evader: Evader) -> str:
    if asked not in ENGINES:
        raise GeomsimError(f"There is no engine {asked!r}: {nearest(asked, ENGINES)}")
    if not getattr(evader.model, "reacts", False):
        return "shared" if asked == "auto" else asked
    if asked == "shared":
        raise GeomsimError(
            f"An evader of the kind {type(evader.model).__name__} reacts to robots, so that each of its trials needs "
            "a world of its own: choose the engine 'separate' or 'auto'."
        )
    return "separate"


def _check_start(experiment: Experiment) -> None:
    """Refuse a team that sees every evader before it has moved: there is nothing to be compared."""
    if experiment.capture == "cell":
        if set(experiment.hideouts) <= set(experiment.starts):
            raise GeomsimError("The evader starts in a pursuer's cell in every trial; there is nothing to search for.")
        return
    if experiment.team.sensor.detection < 1:
        return
    at = experiment.cells.checkpoints
    eyes = at[list(experiment.starts)]
    world = World(experiment.cells.plan.walls, eyes[:1], np.array([experiment.team.radius]))
    for hideout in sorted(set(experiment.hideouts)):
        if not any(experiment.team.sensor.sees(world, eye, 0.0, at[hideout]) for eye in eyes):
            return
    raise GeomsimError(
        "The team sees the evader from where it starts, in whichever cell that is; start it elsewhere, or shorten "
        "the range of its sensor."
    )


@dataclass(slots=True)
class _Work:
    """What is done, and what is left to do."""

    experiment: Experiment
    workforce: Workforce
    store: Store | None
    progress: Progress | None
    rows: dict[tuple[int, int], Row] = field(default_factory=dict)
    runs: dict[int, dict[int, TeamRun]] = field(default_factory=dict)
    seconds: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))
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

    def shared(self) -> None:
        """Go round after round, each further than the one before, until every trial is decided."""
        limit, reach = self.experiment.timing.steps, _FIRST_ROUND
        while True:
            steps = min(limit, math.ceil(reach / self.experiment.timing.physics_step))
            free = {m: left for m in self.runs if (left := self.free(m))}
            self._run_teams(free, steps)
            for found in self.workforce.do(meet, self._blocks(free, steps)):
                self._take(found)
            if steps == limit or not any(self.free(m) for m in self.runs):
                break
            reach *= _FURTHER
        self._give_up()

    def separate(self) -> None:
        """Run every trial as an episode of its own."""
        self._run_teams({m: [0] for m in self.runs}, 0)
        tasks = [
            (self.experiment, m, left[first : first + _EPISODES])
            for m in self.runs
            if (left := self.free(m))
            for first in range(0, len(left), _EPISODES)
        ]
        for found in self.workforce.do(run_episodes, tasks):
            self._take(found)

    def _run_teams(self, free: Mapping[int, list[int]], steps: int) -> None:
        """Make sure of the team runs that the free trials meet; the first run tells whether there is any chance."""
        wanted = [(m, [0]) for m in self.runs if m in free or not self.runs[m]]
        self._run(wanted, steps)
        count = self.experiment.team_runs
        more = []
        for m, left in free.items():
            if self.runs[m][0].drew:
                met = sorted(({k % count for k in left} | (set(range(count)) - set(self.runs[m]))) - {0})
                half = math.ceil(len(met) / min(self.workforce.workers, 4)) or 1
                more += [(m, met[first : first + half]) for first in range(0, len(met), half)]
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

    def _give_up(self) -> None:
        steps = self.experiment.timing.steps
        self._keep(self.experiment.row(m, k, steps, captured=False) for m in self.runs for k in self.free(m))

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
            runs = [self.runs[m][r] for r in sorted(self.runs[m])]
            chance = runs[0].drew
            decisions = max(1, sum(run.decisions for run in runs))
            told.append(
                MethodRun(
                    runs=self.experiment.team_runs if chance else 1,
                    seconds=float(self.seconds[m]),
                    seconds_per_decision=sum(run.seconds for run in runs) / decisions,
                    missed=tuple(_until_sure(run.missed) for run in runs),
                )
            )
        return tuple(told)

    def notes(self) -> tuple[str, ...]:
        """Return what a person should know, a sentence each."""
        told = []
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


def _until_sure(missed: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a curve up to where every run of the team goes, however many went further together."""
    sure = np.flatnonzero(missed <= NEARLY_SURE)
    return missed[: sure[0] + 1] if len(sure) else missed


def _numbered_run(experiment: Experiment, method: int, runs: list[int], steps: int) -> tuple[int, list[TeamRun]]:
    return method, run_team(experiment, method, runs, steps)


def run_episodes(experiment: Experiment, method: int, trials: list[int]) -> Meetings:
    """Run some trials of a method, each as an episode of its own."""
    from geomsim.trials.kernels import blocked_moves
    from geomsim.trials.walls import WallGrid

    found, grid = Meetings(), WallGrid.of(experiment.cells.plan.walls)
    for k in trials:
        episode = run_episode(
            experiment.cells.plan,
            experiment.cells,
            experiment.team_for(method),
            experiment.evader,
            seed=experiment.seeds[k],
            team_seed=experiment.seeds[k % experiment.team_runs],
            capture=experiment.capture,
            motion=experiment.motion,
            timing=experiment.timing,
        )
        steps, out = len(episode.times) - 1, episode.outcome
        tracks = np.concatenate([episode.pursuers, episode.evader[:, np.newaxis]], axis=1)
        found.crossings += blocked_moves(grid, tracks)
        found.evader_steps += steps
        if any("evader" in note for note in out.notes):
            found.held_up.add(k)
        if out.pursuer is None or out.cell is None or out.position is None:
            found.rows.append(experiment.row(method, k, steps, captured=False))
            continue
        x, y = (round(float(np.float32(v)), 3) for v in out.position)
        found.rows.append(
            experiment.row(method, k, steps, captured=True, pursuer=out.pursuer + 1, cell=out.cell + 1, x=x, y=y)
        )
    return found
