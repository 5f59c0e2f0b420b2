"""``geomsim compare``: many methods, many trials, the same evaders."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from geomsim.cli.console import complain, say, say_json, tally
from geomsim.cli.flags import JsonFlag, OutFlag, ScenarioFlags

__all__ = ["DaskFlag", "WorkersFlag", "compare"]

WorkersFlag = Annotated[int | None, Parameter(name="--workers", help="Processes; by default one for each core.")]
DaskFlag = Annotated[str | None, Parameter(name="--dask", help="Address of a Dask scheduler to do the work.")]

_FORMATS = ("png", "svg", "pdf")

#: trials are given up after this, unless told otherwise, seconds: far more than a team needs that stands still
_LIMIT = 10_000.0


def compare(
    plan: str | None = None,
    *,
    methods: Annotated[str | None, Parameter(help="Methods with commas between them.")] = None,
    trials: Annotated[int, Parameter(help="Evaders that each method searches for.")] = 1000,
    reference: Annotated[str | None, Parameter(help="Method that the others are compared with.")] = None,
    team_runs: Annotated[int, Parameter(help="Runs of a team whose planner draws random numbers.")] = 20,
    engine: Annotated[str, Parameter(help="auto, shared or separate.")] = "auto",
    workers: WorkersFlag = None,
    dask: DaskFlag = None,
    scenario: Annotated[Path | None, Parameter(help="A scenario file (TOML); flags override its keys.")] = None,
    figures: Annotated[bool, Parameter(help="Draw means, capture curves and predictions.")] = True,
    figures_format: Annotated[str, Parameter(help="png, svg or pdf.")] = "png",
    out: OutFlag = None,
    json: JsonFlag = False,
    flags: ScenarioFlags = ScenarioFlags(),  # noqa: B008 a frozen value without fields set
) -> int:
    """Let several methods search for the same evaders, and say which is soonest, by how much, and how surely.

    Methods are named by planner, cost heuristic and depth, like `stationary`, `random`, `decoupled-entropy-5`; by
    default those of the paper's Fig. 5 and the planners since. Results are kept as they come: the same command goes
    on where it was interrupted.

    Parameters
    ----------
    plan
        A bundled plan (`geomsim maps` lists them) or a file.
    """
    from geomsim.scenario import read_scenario
    from geomsim.trials import dask_executor, default_methods, run_trials
    from maps import GeomsimError, nearest

    given = flags.given() | ({} if plan is None else {"plan": plan})
    for key in ("planner", "cost", "depth", "options"):
        if key in given:
            flag = "option" if key == "options" else key
            raise GeomsimError(f"compare takes --methods, with each method's whole name, not --{flag}.")
    if figures_format not in _FORMATS:
        raise GeomsimError(f"--figures-format is not {figures_format!r}: {nearest(figures_format, _FORMATS)}")
    told = read_scenario(scenario, {"time_limit": _LIMIT} | given if scenario is None else given)
    names = default_methods() if methods is None else [name.strip() for name in methods.split(",")]
    place, cells = told.place()
    folder = out or Path("geomsim-output") / f"{place.name}-{told.capture}-{trials}-trials-{told.seed}"
    try:
        with ExitStack() as stack:
            executor = None if dask is None else stack.enter_context(dask_executor(dask))
            result = run_trials(
                place,
                names,
                trials=trials,
                cells=cells,
                team=told.team(),
                evader=told.quarry(),
                seed=told.seed,
                capture=told.capture,
                motion=told.belief_motion(),
                timing=told.timing(),
                reference=reference,
                team_runs=team_runs,
                engine=engine,
                executor=executor,
                workers=workers,
                folder=folder,
                progress=stack.enter_context(tally()),
            )
    except KeyboardInterrupt:
        complain(f"Interrupted; what was finished is in {folder}, and the same command goes on from there.")
        return 130
    _report(result, folder, figures=figures_format if figures else None, json=json)
    return 0


def _report(result: Any, folder: Path, *, figures: str | None, json: bool) -> None:
    from json import dumps

    from geomsim.files import write_text

    told = result.as_dict()
    told["cell_notes"] = list(result.experiment.cells.notes)
    if figures is not None:
        from geomsim.trials.figures import FIGURES

        for name, draw in FIGURES.items():
            drawn = draw(result, folder / f"{name}.{figures}")
            if drawn is not None:
                told["files"][name] = str(drawn)
    told["files"]["summary"] = str(folder / "summary.json")
    write_text(folder / "summary.json", dumps(told, indent=1) + "\n")
    if json:
        say_json(told)
        return
    team = result.experiment.team.pursuers
    say(
        f"{result.experiment.cells.plan.name}: {team} pursuers, {result.experiment.trials} trials a method, "
        f"capture by {result.experiment.capture}, {result.engine} engine, {result.wall_seconds:.1f} s"
    )
    for line in str(result.summary()).splitlines():
        say(line)
    for note in (*told["cell_notes"], *result.notes):
        say(note)
    for kind, file in told["files"].items():
        say(f"{kind + ':':<10} {file}")
