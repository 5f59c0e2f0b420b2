"""Trials by the thousand: one bank of evaders, one run of the team for each method, one pass of sight over the bank.

Sharing is right as long as nothing that robots learn, and nothing that the evader does, depends on the other side
before the capture. Where an evader reacts, every trial gets a world of its own.
"""

from __future__ import annotations

import time as clock
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Executor
from pathlib import Path

import numpy as np

from discretize import CellMap
from geomsim.pursuit import Timing, check_pursuit
from geomsim.team import Evader, Team
from geomsim.trials.experiment import Experiment
from geomsim.trials.methods import make_methods
from geomsim.trials.results import Trials
from geomsim.trials.store import Store
from geomsim.trials.work import Progress, Work
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
    _check_request([method.name for method in made], trials, team_runs, reference)
    chosen = _engine(engine, team, evader)
    if cells is None:
        from discretize import convex_cells

        cells = convex_cells(plan, radius=max(team.radius, evader.radius))
    check_pursuit(cells, team, evader, capture)
    experiment = Experiment(
        cells=cells,
        methods=made,
        team=team,
        evader=evader,
        capture=capture,
        motion=motion or AreaSpeedDegree(evader.speed),
        timing=timing,
        trials=trials,
        team_runs=min(team_runs, trials) if _reason(team, evader) is None else trials,
        seed=seed,
    )
    _check_start(experiment)
    store = None if folder is None else Store(Path(folder), {**experiment.about(), "engine": chosen})
    with Workforce(executor, workers) as workforce:
        work = Work(experiment, workforce, store, progress)
        work.shared() if chosen == "shared" else work.separate()
        work.settle()
    rows = work.sorted_rows()
    return Trials(
        experiment=experiment,
        rows=tuple(rows),
        runs=work.method_runs(),
        reference=reference or made[0].name,
        engine=chosen,
        wall_crossings=work.crossings,
        wall_seconds=clock.perf_counter() - begun,
        notes=work.notes(),
        files={} if store is None else store.finish(rows),
    )


def _check_request(names: Sequence[str], trials: int, team_runs: int, reference: str | None) -> None:
    for what, count in (("trial", trials), ("team run", team_runs)):
        if count < 1:
            raise GeomsimError(f"There must be at least one {what}, but {count} were asked for.")
    if reference is not None and reference not in names:
        raise GeomsimError(f"The reference {reference!r} is none of the methods: {nearest(reference, names)}")


def _engine(asked: str, team: Team, evader: Evader) -> str:
    if asked not in ENGINES:
        raise GeomsimError(f"There is no engine {asked!r}: {nearest(asked, ENGINES)}")
    reason = _reason(team, evader)
    if reason is None:
        return "shared" if asked == "auto" else asked
    if asked == "shared":
        raise GeomsimError(
            f"{reason}, so that each trial needs a world of its own: choose the engine 'separate' or 'auto'."
        )
    return "separate"


def _reason(team: Team, evader: Evader) -> str | None:
    """Return why trials cannot share runs of the team, if they cannot."""
    if team.range_noise is not None:
        return "A team that measures ranges goes where its evader leads it"
    if getattr(evader.model, "reacts", False):
        return f"An evader of the kind {type(evader.model).__name__} reacts to robots"
    if evader.count > 1:
        return f"With {evader.count} evaders robots search on for the others once one is captured"
    return None


def _check_start(experiment: Experiment) -> None:
    """Refuse a team that sees every evader before it has moved: there is nothing to be compared."""
    if experiment.capture == "cell":
        if set(experiment.hideouts) <= set(experiment.starts):
            raise GeomsimError("The evader starts in a pursuer's cell in every trial; there is nothing to search for.")
        return
    if any(sensor.detection < 1 for sensor in experiment.team.sensors):
        return
    at = experiment.cells.checkpoints
    eyes = at[list(experiment.starts)]
    world = World(experiment.cells.plan.walls, eyes[:1], np.array([experiment.team.radius]))
    for hideout in sorted(set(experiment.hideouts)):
        looks = zip(experiment.team.sensors, eyes, strict=True)
        if not any(sensor.sees(world, eye, 0.0, at[hideout]) for sensor, eye in looks):
            return
    raise GeomsimError(
        "The team sees the evader from where it starts, in whichever cell that is; start it elsewhere, or shorten "
        "the range of its sensor."
    )
