"""What a comparison depends on, and what one trial comes to."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize import CellMap
from geomsim.pursuit import Timing
from geomsim.seeds import Streams, trial_seeds
from geomsim.team import Evader, Team, place_evader, place_team
from geomsim.trials.methods import Method
from planners import MotionModel

__all__ = ["Experiment", "Row"]


@dataclass(frozen=True, slots=True)
class Row:
    """The outcome of one trial of one method.

    Attributes
    ----------
    method : str
        Its name.
    trial : int
        Counted from 0; the same number means the same evader for every method.
    seed : int
        Of the evader.
    team_seed : int
        Of the team's run; ``run_episode(..., seed=seed, team_seed=team_seed)`` repeats the trial. For a planner that
        draws no random numbers any would do.
    start : int
        Number of the cell in which the evader starts, from 1; of several the first.
    captured : bool
        Whether it was captured within the time limit; of several, whether all were.
    time : float
        When it, or the last of several, was captured, or the time limit; seconds.
    pursuer : int or None
        Number of the robot that did so, from 1.
    cell : int or None
        Number of the cell in which it was captured, from 1.
    x, y : float or None
        Where it was captured, metres.
    """

    method: str
    trial: int
    seed: int
    team_seed: int
    start: int
    captured: bool
    time: float
    pursuer: int | None = None
    cell: int | None = None
    x: float | None = None
    y: float | None = None


@dataclass(frozen=True)
class Experiment:
    """Many trials of several methods against the same evaders.

    Attributes
    ----------
    cells : CellMap
        Where.
    methods : tuple of Method
        What is compared.
    team : Team
        Who; its planner is that of each method in turn.
    evader : Evader
        Who is searched for.
    capture : {"sight", "cell"}
        What counts as capture.
    motion : MotionModel
        What the team believes of the evader's motion.
    timing : Timing
        Clocks.
    trials : int
        Number of evaders.
    team_runs : int
        Runs of a team whose planner draws random numbers, spread evenly over the trials: trial ``k`` meets run
        ``k % team_runs``.
    seed : int
        Everything random comes from it.
    """

    cells: CellMap
    methods: tuple[Method, ...]
    team: Team
    evader: Evader
    capture: str
    motion: MotionModel
    timing: Timing
    trials: int
    team_runs: int
    seed: int

    @cached_property
    def seeds(self) -> list[int]:
        """Seed of each trial."""
        return trial_seeds(self.seed, self.trials)

    @cached_property
    def starts(self) -> tuple[int, ...]:
        """The cell in which each pursuer starts, counted from 0."""
        return place_team(self.cells, self.team)

    @cached_property
    def hideouts(self) -> list[int]:
        """The cell in which the evader of each trial starts, counted from 0."""
        return [place_evader(self.cells, self.evader, self.starts, Streams(seed).placing) for seed in self.seeds]

    def team_for(self, method: int) -> Team:
        """Return the team with the planner of a method, and its belief."""
        chosen = self.methods[method]
        believes = "places" if chosen.belief == "places" else self.team.believes
        return replace(self.team, planner=chosen.planner, believes=believes)

    def patience(self, trials: NDArray[np.intp]) -> NDArray[np.float64]:
        """Attention at which each robot notices the evader of each of some trials, shape (K, P)."""
        draws = [Streams(self.seeds[k]).noticing.exponential(size=self.team.pursuers) for k in trials.tolist()]
        return np.array(draws).reshape(len(trials), self.team.pursuers)

    def row(self, method: int, trial: int, step: int, **found: Any) -> Row:
        """Make the outcome of a trial that ended at a physics step."""
        return Row(
            method=self.methods[method].name,
            trial=trial,
            seed=self.seeds[trial],
            team_seed=self.seeds[trial % self.team_runs],
            start=self.hideouts[trial] + 1,
            time=round(step * self.timing.physics_step, 6),
            **found,
        )

    def about(self) -> dict[str, Any]:
        """Tell what the results depend on, in plain values."""
        from geomsim.scenario import describe

        told = describe(
            self.cells.plan,
            self.cells,
            self.team,
            self.evader,
            self.seed,
            self.capture,
            self.motion,
            self.timing,
        )
        told = {key: value for key, value in told.items() if key not in ("planner", "cost", "depth")}
        geometry = shapely.to_wkb(shapely.GeometryCollection([self.cells.plan.space, *self.cells.cells]))
        return {
            **told,
            "start": [cell + 1 for cell in self.starts],
            "geometry": hashlib.sha256(geometry).hexdigest()[:16],
            "methods": [method.name for method in self.methods],
            "planners": [_told(method.planner) for method in self.methods],
            "trials": self.trials,
            "team_runs": self.team_runs,
        }


def _told(planner: object) -> str:
    """Tell a planner with its parameters if it has a text of its own, else by its class: no address of memory."""
    kind = type(planner)
    return repr(planner) if kind.__repr__ is not object.__repr__ else f"{kind.__module__}.{kind.__qualname__}"
