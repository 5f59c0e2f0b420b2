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
from geomsim.team import Evader, Team, place_evader, place_team
from geomsim.walking import Routes, Walker
from geomsim.world import World
from maps import FloorPlan, GeomsimError, nearest
from planners import (
    AreaSpeedDegree,
    MotionModel,
    Policy,
    PursuerState,
    SameCell,
    SearchGraph,
    SearchProblem,
    SearchState,
    advance,
    uniform_belief,
)

__all__ = ["CAPTURE_RULES", "Timing", "run_episode"]

CAPTURE_RULES = {
    "sight": "a pursuer has a free line of sight to the evader, within its range and field of view",
    "cell": "a pursuer is in the evader's cell (the paper's assumption)",
}

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
        if ratio < 1 or abs(ratio - round(ratio)) > 1e-6:
            raise GeomsimError(
                f"The belief step, {self.belief_step:g} s, must be a multiple of the physics step, "
                f"{self.physics_step:g} s."
            )

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
    capture : {"sight", "cell"}
        What counts as capture, see ``CAPTURE_RULES``.
    motion : MotionModel, optional
        What the pursuers believe of the evader's motion; by default area, speed and degree (Section V).
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
    if capture not in CAPTURE_RULES:
        raise GeomsimError(f"There is no capture rule {capture!r}: {nearest(capture, CAPTURE_RULES)}")
    for who, radius in (("pursuer", team.radius), ("evader", evader.radius)):
        if radius > cells.radius + 1e-9:
            raise GeomsimError(
                f"The {who}'s radius, {radius:g} m, is larger than the {cells.radius:g} m that the cells were made for."
            )
    pursuit = _Pursuit(plan, cells, team, evader, seed, capture, motion or AreaSpeedDegree(), timing)
    outcome = pursuit.run(progress)
    if scenario is None:
        from geomsim.scenario import describe

        scenario = describe(plan, cells, team, evader, seed, capture, motion, timing)
    return pursuit.log.episode(scenario, plan, cells, outcome)


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


class _Pursuit:
    """The state of a running episode: the bodies, the belief and the plans."""

    def __init__(
        self,
        plan: FloorPlan,
        cells: CellMap,
        team: Team,
        evader: Evader,
        seed: int,
        capture: str,
        motion: MotionModel,
        timing: Timing,
    ) -> None:
        placing, self.chance, deciding = (np.random.default_rng(s) for s in np.random.SeedSequence(seed).spawn(3))
        starts = place_team(cells, team)
        quarry = place_evader(cells, evader, starts, placing)
        self.team, self.evader, self.capture, self.timing = team, evader, capture, timing
        self.routes = Routes(cells)
        self.walkers = [Walker(team.speed, self.routes.stay(cell, 0.0)) for cell in starts]
        self.hunted = Walker(evader.speed, self.routes.stay(quarry, 0.0))
        bodies = [*self.walkers, self.hunted]
        at = np.array([walker.route.points[0] for walker in bodies])
        self.world = World(plan.walls, at, np.array([team.radius] * team.pursuers + [evader.radius]))
        graph = SearchGraph.from_cells(cells)
        self.transition = motion.matrix(graph, timing.belief_step)
        self.sight = SameCell()
        speeds = (team.speed,) * team.pursuers
        problem = SearchProblem(graph, motion, self.sight, speeds, timing.belief_step)
        self.policy: Policy = team.planner.solve(problem, deciding)
        self.graph = graph
        self.belief = uniform_belief(graph, exclude=starts, component=int(graph.component[starts[0]]))
        self.plans: list[tuple[int, ...]] = [()] * team.pursuers
        self.headings = np.zeros(team.pursuers)
        self.held_up: set[int] = set()
        self.log = _Log()

    def run(self, progress: Callable[[float, float], None] | None) -> Outcome:
        """Step until capture, the time limit or Ctrl-C."""
        steps = math.ceil(self.timing.limit / self.timing.physics_step - 1e-9)
        status, captor = Status.TIME_LIMIT, None
        self._note(0.0)
        self._believe(0.0)
        try:
            captor = self._captor()
            for k in range(steps):
                if captor is not None:
                    break
                self._move(k * self.timing.physics_step)
                time = (k + 1) * self.timing.physics_step
                self._note(time)
                if (k + 1) % self.timing.steps_per_belief == 0:
                    self._learn()
                    self._believe(time)
                    if progress is not None:
                        progress(time, float(self.belief[0]))
                captor = self._captor()
        except KeyboardInterrupt:
            status = Status.INTERRUPTED
        return self._outcome(Status.CAPTURED if captor is not None else status, captor)

    def _note(self, time: float) -> None:
        moving = np.hypot(*self.world.velocities[:-1].T) > 1e-3
        course = np.arctan2(self.world.velocities[:-1, 1], self.world.velocities[:-1, 0])
        self.headings = np.where(moving, course, self.headings)
        self.log.headings.append(self.headings)
        self.log.positions.append(self.world.positions)
        self.log.occupied.append([walker.cell for walker in (*self.walkers, self.hunted)])
        self.log.times.append(time)

    def _learn(self) -> None:
        rows = [self.sight.row(self.graph, walker.cell) for walker in self.walkers]
        self.belief = advance(self.belief, self.transition, rows)

    def _believe(self, time: float) -> None:
        self.log.belief_times.append(time)
        self.log.beliefs.append(self.belief)

    def _captor(self) -> int | None:
        target = self.world.positions[-1]
        for i, walker in enumerate(self.walkers):
            if self.capture == "cell":
                caught = walker.cell == self.hunted.cell
            else:
                heading = float(self.headings[i])
                caught = self.team.sensor.sees(self.world, self.world.positions[i], heading, target)
            if caught:
                return i
        return None

    def _move(self, time: float) -> None:
        dt = self.timing.physics_step
        bodies = [*self.walkers, self.hunted]
        at, velocity = self.world.positions, self.world.velocities
        for k, walker in enumerate(bodies):
            walker.advance(at[k], velocity[k], dt)
            if walker.idle >= HELD_UP:
                self.held_up.add(k)
        while any(walker.done for walker in self.walkers):
            self._decide(time)
        while self.hunted.done:
            self.hunted.take(self.evader.model.next_route(self.routes, self.hunted.route.cells[1], self.chance))
        wanted = np.array([walker.wanted(at[k], velocity[k], dt) for k, walker in enumerate(bodies)])
        self.world.step(wanted, dt)

    def _decide(self, time: float) -> None:
        pursuers = tuple(
            PursuerState(walker.route.cells[1])
            if walker.done
            else PursuerState(walker.route.cell(walker.aim), walker.route.cells[1], walker.time_left)
            for walker in self.walkers
        )
        state = SearchState(time, self.belief, pursuers, tuple(self.plans))
        decisions = self.policy.decide(state)
        for i, (walker, decision) in enumerate(zip(self.walkers, decisions, strict=True)):
            if not walker.done:
                continue
            here = walker.route.cells[1]
            if decision is None or not decision.path or decision.path[0] not in (here, *self.routes.neighbours[here]):
                raise GeomsimError(
                    f"The policy of {type(self.team.planner).__name__} sent pursuer {i + 1} from cell {here + 1} to "
                    "no neighbour of it; run planners.check_policy on it."
                )
            self.plans[i] = tuple(decision.path)
            self.log.decisions.append((time, i, self.plans[i]))
            to = decision.path[0]
            stay = self.team.speed * self.timing.belief_step
            walker.take(self.routes.stay(here, stay) if to == here else self.routes.between(here, to))

    def _outcome(self, status: Status, captor: int | None) -> Outcome:
        captured, last = status is Status.CAPTURED, len(self.log.times) - 1
        x, y = self.log.positions[last][-1].tolist()
        names = [f"Pursuer {i + 1}" for i in range(self.team.pursuers)] + ["The evader"]
        notes = tuple(f"{names[k]} was held up at a wall for {HELD_UP:g} s or more." for k in sorted(self.held_up))
        return Outcome(
            status=status,
            time=self.log.times[last],
            pursuer=captor,
            position=(x, y) if captured else None,
            cell=self.log.occupied[last][-1] if captured else None,
            predicted=float(self.log.beliefs[-1][0]),
            notes=notes,
        )
