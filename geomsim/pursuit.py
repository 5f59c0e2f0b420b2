"""The episode loop: Algorithm 1 of Hollinger, Kehagias and Singh, in a continuous world."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from discretize import CellMap
from geomsim.episode import Episode, Outcome, Status
from geomsim.quarry import Quarry
from geomsim.seeds import Streams
from geomsim.team import Evader, Team, place_evader, place_team
from geomsim.teamwork import Teamwork
from maps import FloorPlan, GeomsimError, nearest
from planners import AreaSpeedDegree, CaptureModel, MotionModel, SameCell, SearchGraph

__all__ = [
    "CAPTURE_RULES",
    "HELD_UP",
    "Pursuit",
    "Timing",
    "believed_capture",
    "check_clocks",
    "check_pursuit",
    "run_episode",
]

CAPTURE_RULES = {
    "sight": "a pursuer has a free line of sight to the evader, within its range and field of view",
    "cell": "a pursuer is in the evader's cell (the paper's assumption)",
}

#: positions that a record may hold, of all bodies at all physics steps: about a gigabyte while it is made
MOST_POSITIONS = 20_000_000

#: belief steps that a pursuer may need for the longest way between two checkpoints: planners look at each of them
MOST_BELIEF_STEPS = 10_000

#: a body that is held up for so long is reported, seconds
HELD_UP = 10.0


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
    """Run one pursuit until the evader is captured or time is up.

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
        What counts as capture, see ``CAPTURE_RULES``. The belief counts on same-cell capture either way (Section V).
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
    pursuit = Pursuit(plan, cells, team, evader, seeds, capture, motion or AreaSpeedDegree(evader.speed), timing)
    outcome = pursuit.run(progress)
    if scenario is None:
        from geomsim.scenario import describe

        scenario = describe(plan, cells, team, evader, seed, capture, motion, timing)
    return pursuit.log.episode(scenario, plan, cells, outcome)


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
    for who, speed, radius in (("pursuer", team.speed, team.radius), ("evader", evader.speed, evader.radius)):
        if speed * timing.physics_step > radius:
            raise GeomsimError(
                f"The {who} of radius {radius:g} m would move {speed * timing.physics_step:g} m, more than that, in "
                f"a physics step of {timing.physics_step:g} s and might miss a wall: make the step shorter, the body "
                "slower or larger."
            )
    bodies = team.pursuers + 1
    positions = timing.limit / timing.physics_step * bodies
    if positions > MOST_POSITIONS:
        raise GeomsimError(
            f"A pursuit of {timing.limit:g} s in steps of {timing.physics_step:g} s with {bodies} bodies may come to "
            f"{positions:.3g} recorded positions, but {MOST_POSITIONS:,} are the most: make the time limit shorter or "
            "the physics step longer."
        )


def _check_hops(graph: SearchGraph, team: Team, timing: Timing) -> None:
    """Refuse belief steps so short, or pursuers so slow, that planning for the next cell would take for ever."""
    steps = float(graph.length.max(initial=0.0)) / team.speed / timing.belief_step
    if steps > MOST_BELIEF_STEPS:
        raise GeomsimError(
            f"A pursuer of {team.speed:g} m/s needs up to {steps:.3g} belief steps of {timing.belief_step:g} s from "
            f"one cell to the next, but {MOST_BELIEF_STEPS:,} are the most: make the belief step longer."
        )


@dataclass(slots=True)
class _Log:
    """What has happened so far."""

    times: list[float] = field(default_factory=list)
    positions: list[NDArray[np.float64]] = field(default_factory=list)
    headings: list[NDArray[np.float64]] = field(default_factory=list)
    occupied: list[list[int]] = field(default_factory=list)
    belief_times: list[float] = field(default_factory=list)
    beliefs: list[NDArray[np.float64]] = field(default_factory=list)
    decisions: list[tuple[float, int, tuple[int, ...]]] = field(default_factory=list)

    def episode(self, scenario: dict[str, Any], plan: FloorPlan, cells: CellMap, outcome: Outcome) -> Episode:
        """Make the record; the evader is the last of the bodies. Ctrl-C may have left some lists one entry longer."""
        n, b = len(self.times), len(self.beliefs)
        positions, occupied = np.array(self.positions[:n]), np.array(self.occupied[:n], dtype=np.int32)
        return Episode(
            scenario=scenario,
            plan=plan,
            cells=cells,
            times=np.array(self.times),
            pursuers=positions[:, :-1],
            headings=np.array(self.headings[:n]),
            pursuer_cells=occupied[:, :-1],
            evader=positions[:, -1],
            evader_cells=occupied[:, -1],
            belief_times=np.array(self.belief_times[:b]),
            beliefs=np.array(self.beliefs),
            decision_times=np.array([time for time, _, _ in self.decisions]),
            decision_pursuers=np.array([who for _, who, _ in self.decisions], dtype=np.int32),
            decision_paths=tuple(np.array(path, dtype=np.int32) for _, _, path in self.decisions),
            outcome=outcome,
        )


class Pursuit:
    """A running episode: the team at work, and the evader."""

    def __init__(
        self,
        plan: FloorPlan,
        cells: CellMap,
        team: Team,
        evader: Evader,
        seeds: tuple[int, int],
        capture: str,
        motion: MotionModel,
        timing: Timing,
        crew: type[Teamwork] = Teamwork,
    ) -> None:
        theirs, ours = Streams(seeds[0]), Streams(seeds[1])
        starts = place_team(cells, team)
        hideout = place_evader(cells, evader, starts, theirs.placing)
        self.team, self.capture, self.timing = team, capture, timing
        believed = believed_capture(team, timing)
        self.work = crew(cells, team, starts, motion, believed, timing.belief_step, [ours.deciding])
        self.quarry = Quarry(plan.walls, self.work.routes, evader, [hideout], [theirs.moving])
        self.patience = theirs.noticing.exponential(size=team.pursuers)
        self.looked = np.zeros(team.pursuers)
        self.held_up: set[int] = set()
        self.log = _Log()
        self._note(0.0)
        self._believe(0.0)

    def run(self, progress: Callable[[float, float], None] | None) -> Outcome:
        """Step until capture, the time limit or Ctrl-C."""
        steps, dt = self.timing.steps, self.timing.physics_step
        status, captor = Status.TIME_LIMIT, None
        try:
            captor = self.captor()
            for k in range(steps):
                if captor is not None:
                    break
                before = self.work.positions[0]
                self.work.step(k * dt, dt)
                captor = self.settle(k, before)
                if progress is not None and (k + 1) % self.timing.steps_per_belief == 0:
                    progress((k + 1) * dt, float(self.work.beliefs[0, 0]))
        except KeyboardInterrupt:
            status = Status.INTERRUPTED
        return self.outcome(Status.CAPTURED if captor is not None else status, captor)

    def settle(self, k: int, before: NDArray[np.float64]) -> int | None:
        """Let the evader move in physics step ``k``, in which the team has moved already; return who captures it.

        ``before`` holds where the robots were when the step began, shape (R, 2): what an evader sees that reacts.
        """
        self.quarry.robots = before
        self.quarry.step(self.timing.physics_step)
        time = round((k + 1) * self.timing.physics_step, 6)  # 0.3, not 0.30000000000000004
        self._note(time)
        if (k + 1) % self.timing.steps_per_belief == 0:
            self.work.learn()
            self._believe(time)
        return self.captor()

    def _note(self, time: float) -> None:
        self.log.headings.append(self.work.headings[0])
        self.log.positions.append(np.concatenate([self.work.positions[0], self.quarry.positions]))
        self.log.occupied.append([*self.work.cells[0].tolist(), *self.quarry.cells.tolist()])
        self.log.times.append(time)
        idle = np.concatenate([self.work.idle[0], self.quarry.idle])
        self.held_up.update(np.flatnonzero(idle >= HELD_UP).tolist())

    def _believe(self, time: float) -> None:
        self.log.belief_times.append(time)
        self.log.beliefs.append(self.work.beliefs[0])

    def captor(self) -> int | None:
        """Let the robots look once for a physics step; return who captures, counted from 0."""
        # evaders are kept in single precision where thousands are, and a robot must see the same in both cases
        target = self.quarry.positions[0].astype(np.float32).astype(np.float64)
        hidden = int(self.quarry.cells[0])
        for i, (eye, cell) in enumerate(zip(self.work.positions[0], self.work.cells[0].tolist(), strict=True)):
            if self.capture == "cell":
                looks = cell == hidden
            else:
                looks = self.team.sensor.sees(self.quarry.world, eye, float(self.work.headings[0, i]), target)
            if looks:
                self.looked[i] += self.team.sensor.attention * self.timing.physics_step
                if self.looked[i] >= self.patience[i]:
                    return i
        return None

    def outcome(self, status: Status, captor: int | None) -> Outcome:
        """Tell how it ended, or stands."""
        captured, last = status is Status.CAPTURED, len(self.log.times) - 1
        x, y = self.log.positions[last][-1].tolist()
        names = [f"Pursuer {i + 1}" for i in range(self.team.pursuers)] + ["The evader"]
        notes = tuple(f"{names[k]} was held up at a wall for {HELD_UP:g} s or more." for k in sorted(self.held_up))
        self.log.decisions = [(choice.time, choice.pursuer, choice.path) for choice in self.work.choices]
        return Outcome(
            status=status,
            time=self.log.times[last],
            pursuer=captor,
            position=(x, y) if captured else None,
            cell=self.log.occupied[last][-1] if captured else None,
            predicted=float(self.log.beliefs[-1][0]),
            notes=notes,
        )


def believed_capture(team: Team, timing: Timing) -> CaptureModel:
    """Return what a team believes to catch: its own cell, as likely in a belief step as its sensor notices in one."""
    return SameCell(-math.expm1(-team.sensor.attention * timing.belief_step))
