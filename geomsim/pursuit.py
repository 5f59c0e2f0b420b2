"""Running a pursuit: what it takes, and what is refused before it begins."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from discretize import CellMap
from geomsim.chase import HELD_UP, Chase
from geomsim.episode import Episode
from geomsim.team import Evader, Team
from maps import FloorPlan, GeomsimError, nearest
from planners import AreaSpeedDegree, MotionModel, SearchGraph

__all__ = ["CAPTURE_RULES", "HELD_UP", "Timing", "check_clocks", "check_pursuit", "run_episode"]

CAPTURE_RULES = {
    "sight": "a pursuer has a free line of sight to the evader, within its range and field of view",
    "cell": "a pursuer is in the evader's cell (the paper's assumption)",
}

#: positions that a record may hold, of all bodies at all physics steps: about a gigabyte while it is made
MOST_POSITIONS = 20_000_000

#: belief steps that a pursuer may need for the longest way between two checkpoints: planners look at each of them
MOST_BELIEF_STEPS = 10_000


@dataclass(frozen=True, slots=True)
class Timing:
    """The clocks of a pursuit.

    Attributes
    ----------
    limit : float
        When to give up, seconds.
    belief_step : float
        Time between two belief steps, seconds; a multiple of the physics step.
    physics_step : float
        Seconds.
    """

    limit: float = 1800.0
    belief_step: float = 1.0
    physics_step: float = 0.1

    def __post_init__(self) -> None:
        for name in ("limit", "belief_step", "physics_step"):
            value = getattr(self, name)
            if not 0 < value < math.inf:
                raise GeomsimError(
                    f"The time {name.replace('_', ' ')} must be positive and finite, but is {value:g} s."
                )
        ratio = self.belief_step / self.physics_step
        if not 1 <= ratio < math.inf or abs(ratio - round(ratio)) > 1e-6:
            raise GeomsimError(
                f"The belief step, {self.belief_step:g} s, must be a multiple of the physics step, "
                f"{self.physics_step:g} s."
            )

    @property
    def steps(self) -> int:
        """Physics steps up to the limit."""
        return math.ceil(self.limit / self.physics_step - 1e-9)

    @property
    def steps_per_belief(self) -> int:
        """Physics steps in a belief step."""
        return round(self.belief_step / self.physics_step)


def run_episode(
    plan: FloorPlan,
    cells: CellMap,
    team: Team | None = None,
    evader: Evader | None = None,
    *,
    seed: int = 0,
    team_seed: int | None = None,
    capture: str = "sight",
    motion: MotionModel | None = None,
    timing: Timing | None = None,
    scenario: dict[str, Any] | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> Episode:
    """Run one pursuit until all evaders are captured or time is up.

    Every physics step the bodies move and each pursuer looks; every belief step ``p <- p P prod_i C_i`` (Eq. 3);
    pursuers that come to a checkpoint decide anew. Ctrl-C ends the pursuit and returns what there is of it.

    Parameters
    ----------
    plan : FloorPlan
        Where; the plan of ``cells``.
    cells : CellMap
        The plan cut into cells.
    team, evader : Team, Evader, optional
        Who; defaults are those of the classes.
    seed : int
        The same seed gives the same episode, bit for bit.
    team_seed : int, optional
        Where the planner's chance comes from, if not from ``seed``; the evader's always comes from ``seed``.
    capture : {"sight", "cell"}
        What counts as capture, see ``CAPTURE_RULES``. What the belief counts on is the team's, ``Team.believes``.
    motion : MotionModel, optional
        What the pursuers believe of the evader's motion; by default area, degree and its own speed (Section V).
    timing : Timing, optional
        Clocks.
    scenario : dict, optional
        Recorded in the episode as what it depends on; by default what can be told from the arguments.
    progress : callable, optional
        Called at every belief step with the time (s) and p0.

    Raises
    ------
    GeomsimError
        If the team cannot be placed, a body is too large for the routes of ``cells``, or a policy breaks its contract.
    """
    team, evader, timing = team or Team(), evader or Evader(), timing or Timing()
    if plan is not cells.plan and not plan.space.equals(cells.plan.space):
        raise GeomsimError(f"The cells were made of plan {cells.plan.name!r}, not of {plan.name!r}.")
    check_pursuit(cells, team, evader, capture)
    check_clocks(cells, team, evader, timing)
    seeds = seed, seed if team_seed is None else team_seed
    chase = Chase(cells, team, evader, seeds, capture, motion or AreaSpeedDegree(evader.speed), timing)
    outcome = chase.run(progress)
    if scenario is None:
        from geomsim.scenario import describe

        scenario = describe(plan, cells, team, evader, seed, capture, motion, timing)
    return chase.log.episode(scenario, plan, cells, outcome)


def check_pursuit(cells: CellMap, team: Team, evader: Evader, capture: str) -> None:
    """Raise GeomsimError if there is no such capture rule, or a body is too large for the routes of ``cells``."""
    if capture not in CAPTURE_RULES:
        raise GeomsimError(f"There is no capture rule {capture!r}: {nearest(capture, CAPTURE_RULES)}")
    for who, radius in (("pursuer", team.radius), ("evader", evader.radius)):
        if radius > cells.radius + 1e-9:
            raise GeomsimError(
                f"The {who}'s radius, {radius:g} m, is larger than the {cells.radius:g} m that the cells were made for."
            )


def check_clocks(cells: CellMap, team: Team, evader: Evader, timing: Timing) -> None:
    """Raise GeomsimError for clocks with which a body would miss walls, or a pursuit outgrow memory or patience."""
    _check_steps(team, evader, timing)
    _check_hops(SearchGraph.from_cells(cells), team, timing)


def _check_steps(team: Team, evader: Evader, timing: Timing) -> None:
    """Refuse clocks with which a body would miss walls, or a pursuit would outgrow memory or patience."""
    bodies = (("pursuer", max(team.speeds), team.radius), ("evader", evader.speed, evader.radius))
    for who, speed, radius in bodies:
        if speed * timing.physics_step > radius:
            raise GeomsimError(
                f"The {who} of radius {radius:g} m would move {speed * timing.physics_step:g} m, more than that, in "
                f"a physics step of {timing.physics_step:g} s and might miss a wall: make the step shorter, the body "
                "slower or larger."
            )
    count = team.pursuers + evader.count
    positions = timing.limit / timing.physics_step * count
    if positions > MOST_POSITIONS:
        raise GeomsimError(
            f"A pursuit of {timing.limit:g} s in steps of {timing.physics_step:g} s with {count} bodies may come to "
            f"{positions:.3g} recorded positions, but {MOST_POSITIONS:,} are the most: make the time limit shorter or "
            "the physics step longer."
        )


def _check_hops(graph: SearchGraph, team: Team, timing: Timing) -> None:
    """Refuse belief steps so short, or pursuers so slow, that planning for the next cell would take for ever."""
    slowest = min(team.speeds)
    steps = float(graph.length.max(initial=0.0)) / slowest / timing.belief_step
    if steps > MOST_BELIEF_STEPS:
        raise GeomsimError(
            f"A pursuer of {slowest:g} m/s needs up to {steps:.3g} belief steps of {timing.belief_step:g} s from "
            f"one cell to the next, but {MOST_BELIEF_STEPS:,} are the most: make the belief step longer."
        )
