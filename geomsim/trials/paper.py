"""The experiments of the paper's Section V."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path

from geomsim.evaders import Still
from geomsim.pursuit import Timing
from geomsim.team import Evader, Team
from geomsim.trials.claims import PAPER_COSTS, Claim, judge
from geomsim.trials.engine import run_trials
from geomsim.trials.methods import default_methods
from geomsim.trials.results import Trials
from planners import AreaSpeedDegree, MotionModel, StationaryMotion

__all__ = ["Part", "Reproduction", "parts", "reproduce"]

_FEW = tuple(f"decoupled-{cost}-{depth}" for depth in (1, 5) for cost in PAPER_COSTS)


#: where the belief does not disperse, a lookahead into empty cells sees nothing, and chance decides between paths that
#: are all alike: every run of a team plans for long, so that there are fewer of them, and they are given up; seconds
_SHORT, _FEW_RUNS = 1200.0, 5


@dataclass(frozen=True, slots=True)
class Part:
    """One experiment.

    Attributes
    ----------
    key : str
        Its name in folders.
    title : str
        Its heading.
    about : str
        What is done, and why, in a sentence or two.
    plan : str
        A bundled plan.
    methods : tuple of str
        What is compared; the first is the reference.
    pursuers : int
        Size of the team.
    capture : str
        What counts as capture.
    evader : Evader
        Who is searched for.
    motion : MotionModel
        What the team believes of it.
    limit : float
        Time limit, seconds.
    team_runs : int
        Runs of a team whose planner draws random numbers.
    """

    key: str
    title: str
    about: str
    plan: str = "office"
    methods: tuple[str, ...] = _FEW
    pursuers: int = 2
    capture: str = "cell"
    evader: Evader = Evader()  # noqa: RUF009 a frozen value
    motion: MotionModel = AreaSpeedDegree(1.0)  # noqa: RUF009 a frozen value
    limit: float = 10_000.0
    team_runs: int = 20


@dataclass(frozen=True)
class Reproduction:
    """All experiments with their outcomes.

    Attributes
    ----------
    parts : tuple of Part
        In the order of the page.
    trials : mapping of str to Trials
        By the parts' keys.
    claims : tuple of Claim
        The paper's statements.
    """

    parts: tuple[Part, ...]
    trials: Mapping[str, Trials]
    claims: tuple[Claim, ...]


def parts() -> tuple[Part, ...]:
    """Return the experiments."""
    short = ("stationary", "random", *_FEW)
    return (
        Part(
            "figure-5",
            "Fig. 5: two pursuers in the office",
            "Two pursuers start side by side at the top, an evader uniformly in another cell; capture in the same "
            "cell. The methods of the figure, and the planners that came later.",
            methods=default_methods(),
        ),
        Part(
            "immobile",
            "An evader that stays where it is",
            "The identity as dispersion matrix; the pursuers have to inspect every room.",
            methods=_FEW,
            evader=Evader(model=Still()),
            motion=StationaryMotion(),
            limit=_SHORT,
            team_runs=_FEW_RUNS,
        ),
        *(
            Part(
                f"pursuers-{count}",
                f"{count} pursuers",
                "The paper reports experiments with up to five.",
                methods=("random", "decoupled-distance-over-probability-1", "decoupled-entropy-5"),
                pursuers=count,
            )
            for count in (3, 4, 5)
        ),
        Part(
            "no-dispersion",
            "Dispersion switched off",
            "The evader moves, but the pursuers believe that it does not: what does modelling its motion buy?",
            motion=StationaryMotion(),
            limit=_SHORT,
            team_runs=_FEW_RUNS,
        ),
        Part(
            "museum",
            "A museum with many cycles",
            "The paper's future work: robots cannot cut off all cycles.",
            plan="museum",
            methods=short,
        ),
        Part(
            "sight",
            "Fig. 5 with capture by line of sight",
            "The same pursuits in the continuous world, where a robot that looks through a door sees beyond its cell.",
            methods=default_methods(),
            capture="sight",
        ),
    )


def reproduce(
    folder: Path,
    *,
    trials: int = 1000,
    seed: int = 0,
    executor: Executor | None = None,
    workers: int | None = None,
    progress: Callable[[str, int, int], None] | None = None,
    only: tuple[str, ...] = (),
) -> Reproduction:
    """Run the experiments of Section V.

    Parameters
    ----------
    folder : Path
        Where results are kept, in one folder for each experiment; the same call goes on where it was interrupted.
    trials, seed, executor, workers
        As for :func:`geomsim.trials.run_trials`.
    progress : callable, optional
        As there; names are those of experiment and method.
    only : tuple of str
        Keys of the experiments to run; all if empty.
    """
    from discretize import convex_cells
    from maps import read_plan

    done: dict[str, Trials] = {}
    chosen = tuple(part for part in parts() if not only or part.key in only)
    for part in chosen:
        plan = read_plan(part.plan)
        team = Team(pursuers=part.pursuers)

        def tell(name: str, count: int, total: int, key: str = part.key) -> None:
            if progress is not None:
                progress(f"{key}: {name}", count, total)

        done[part.key] = run_trials(
            plan,
            part.methods,
            trials=trials,
            cells=convex_cells(plan, radius=max(team.radius, part.evader.radius)),
            team=team,
            evader=part.evader,
            seed=seed,
            capture=part.capture,
            motion=part.motion,
            timing=Timing(limit=part.limit),
            team_runs=part.team_runs,
            folder=folder / part.key,
            executor=executor,
            workers=workers,
            progress=tell,
        )
    return Reproduction(chosen, done, judge(done))
