"""A pursuit that stops whenever a robot must be told what to do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from geomsim.chase import Chase
from geomsim.episode import Episode, Status
from geomsim.pursuit import check_clocks, check_pursuit
from geomsim.scenario import Scenario, ScenarioError
from geomsim.teamwork import Teamwork
from planners import SearchProblem, SearchState

__all__ = ["CONTROLS", "Hunt"]

CONTROLS = {
    "checkpoint": "a robot at a checkpoint is told the next one; a step lasts until one of the robots is at its own",
    "velocity": "robots are told a velocity; a step lasts a belief step",
}


class Roamers(Teamwork):
    """A team that goes where its velocities take it, and counts on same-cell capture where it is."""

    _wanted: NDArray[np.float64]

    @property
    def cells(self) -> NDArray[np.int32]:
        """The cells in which the robots are, counted from 0, shape (R, P)."""
        return self._where.locate(self._world.positions).astype(np.int32).reshape(self._shape)

    @property
    def idle(self) -> NDArray[np.float64]:
        """Zeros, shape (R, P): a robot at a wall is not held up, it was told to go there."""
        return np.zeros(self._shape)

    def drive(self, velocities: NDArray[np.float64]) -> None:
        """Say how each robot is to go from now on, shape (P, 2), metres a second, at most its speed."""
        fast = np.hypot(*velocities.T) / np.array(self.team.speeds)
        self._wanted = velocities / np.maximum(fast, 1.0)[:, np.newaxis]

    def finish(self, dt: float) -> None:
        """Move the bodies."""
        self._move(self._wanted, dt)

    def learn(self, ranges: NDArray[np.float64] | None = None) -> None:
        """Take a belief step: dispersion, capture where the pursuers are (Eq. 3), then the measured ``ranges``."""
        captures, graph = self.problem.captures, self.problem.graph
        for run, crew in enumerate(self.crews):
            rows = [capture.row(graph, int(cell)) for capture, cell in zip(captures, self.cells[run], strict=True)]
            likelihoods = None if ranges is None else self._readings.likelihoods(self.positions[run], ranges)
            crew.learn(np.array(rows), self._contacts(run), likelihoods)


class Hunt:
    """A pursuit after a scenario, run piece by piece.

    Parameters
    ----------
    scenario : Scenario
        Everything but the seed; its planner decides nothing here, and one mind knows all that the robots know.
    control : {"checkpoint", "velocity"}
        What robots are told, see ``CONTROLS``.

    Attributes
    ----------
    cells : CellMap
        Where.
    team : Team
        Who.

    Raises
    ------
    GeomsimError
        If the scenario cannot be run, or robots plan each for itself, or are told velocities and believe in sight.
    """

    def __init__(self, scenario: Scenario, control: str) -> None:
        self.scenario, self.control = scenario, control
        self.team, self.evader, self.timing = scenario.team(), scenario.quarry(), scenario.timing()
        self.motion = scenario.belief_motion()
        if not self.team.communication.central:
            raise ScenarioError("An environment tells every robot all that is known: leave out the communication.")
        if control == "velocity" and (self.team.believes, self.team.checkpoints) != ("cell", "centroids"):
            raise ScenarioError("Robots that are told velocities count on same-cell capture, and need no checkpoints.")
        _, self.cells = scenario.place()
        check_pursuit(self.cells, self.team, self.evader, scenario.capture)
        check_clocks(self.cells, self.team, self.evader, self.timing)
        self.begin(0)

    def begin(self, seed: int) -> None:
        """Begin anew; ``seed`` says where the evader starts and goes, as in :func:`geomsim.run_episode`."""
        self.seed = seed
        crew = Roamers if self.control == "velocity" else Teamwork
        seeds, told = (seed, seed), self.scenario
        self._chase = Chase(self.cells, self.team, self.evader, seeds, told.capture, self.motion, self.timing, crew)
        self._chase.begin()
        self._k = 0
        if not self.over:
            self._open()

    @property
    def work(self) -> Teamwork:
        """The team."""
        return self._chase.work

    @property
    def problem(self) -> SearchProblem:
        """What a planner plans for."""
        return self.work.problem

    @property
    def time(self) -> float:
        """Seconds since the beginning."""
        return self._chase.log.times[-1]

    @property
    def captured(self) -> bool:
        """Whether every evader is captured."""
        return self._chase.is_over

    @property
    def over(self) -> bool:
        """Whether every evader is captured or time is up."""
        return self.captured or self._k >= self.timing.steps

    @property
    def waiting(self) -> NDArray[np.bool_]:
        """Who must be told where to go, shape (P,)."""
        mine: NDArray[np.bool_] = self.work.waiting[0]
        return mine

    def state(self, plans: Sequence[tuple[int, ...]]) -> SearchState:
        """Return what a policy may know; ``plans`` are what it announced."""
        time = self._k * self.timing.physics_step
        return SearchState(time, self.work.crews[0].belief, tuple(self.work.states(0)), tuple(plans))

    def choices(self, robot: int) -> tuple[int, ...]:
        """Return where a robot can be sent: the checkpoint that it is at or goes to, then the neighbours of that."""
        at = int(self.work.goals[0, robot])
        return (at, *self.work.routes.neighbours[at])

    def send(self, goals: Mapping[int, int]) -> None:
        """Send robots that wait to checkpoints, counted from 0; run on until one waits, or it is over."""
        if self.over:
            return
        at = self._k * self.timing.physics_step
        for robot in np.flatnonzero(self.waiting).tolist():
            self.work.send(0, robot, at, (goals[robot],))
        while not self.over:
            self._close()
            if self.over or self.waiting.any():
                return

    def drive(self, velocities: NDArray[np.float64]) -> None:
        """Let the robots go with velocities, shape (P, 2), metres a second, for a belief step, or until it is over."""
        if not isinstance(self.work, Roamers):
            raise ScenarioError("Robots that are told checkpoints take no velocities.")
        self.work.drive(velocities)
        for _ in range(self.timing.steps_per_belief):
            if not self.over:
                self._close()

    def episode(self) -> Episode:
        """Return the record so far."""
        outcome = self._chase.outcome(Status.TIME_LIMIT if self.over else Status.INTERRUPTED)
        told = self.scenario.model_copy(update={"seed": self.seed})
        return self._chase.log.episode(told.as_dict(), self.cells.plan, self.cells, outcome)

    def told(self) -> dict[str, float | int]:
        """Return what is no observation: ``time`` since the beginning, and ``captured_by``, -1 for nobody."""
        captures = self._chase.captures
        return {"time": self.time, "captured_by": captures[-1].pursuer if self.captured else -1}

    def sights(self) -> NDArray[np.bool_]:
        """Which checkpoints of cells each robot sees, shape (P, N)."""
        world, work = self._chase.quarry.world, self.work
        seen = np.zeros((self.team.pursuers, len(self.cells)), dtype=np.bool_)
        for i, (eye, heading) in enumerate(zip(work.positions[0], work.headings[0].tolist(), strict=True)):
            for cell in np.flatnonzero(self.cells.components >= 0).tolist():
                seen[i, cell] = self.team.sensors[i].sees(world, eye, heading, self.cells.checkpoints[cell])
        return seen

    def _open(self) -> None:
        self._chase.quarry.robots = self.work.positions[0]
        self.work.advance(self.timing.physics_step)

    def _close(self) -> None:
        """Finish a physics step that all robots know their way for, and begin the next."""
        self.work.finish(self.timing.physics_step)
        self._chase.settle(self._k)
        self._k += 1
        if not self.over:
            self._open()
