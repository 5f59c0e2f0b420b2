"""A pursuit that stops whenever a robot must be told what to do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from geomsim.episode import Episode, Status
from geomsim.pursuit import Pursuit, believed_capture, check_clocks, check_pursuit
from geomsim.scenario import Scenario, ScenarioError
from geomsim.teamwork import Teamwork
from planners import SearchGraph, SearchProblem, SearchState

__all__ = ["CONTROLS", "Chase"]

CONTROLS = {
    "checkpoint": "a robot at a checkpoint is told the next one; a step lasts until one of the robots is at its own",
    "velocity": "robots are told a velocity; a step lasts a belief step",
}


class Roamers(Teamwork):
    """A team that goes where its velocities take it."""

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
        """Say how each robot is to go from now on, shape (P, 2), metres a second, at most the team's speed."""
        fast = np.hypot(*velocities.T) / self.team.speed
        self._wanted = velocities / np.maximum(fast, 1.0)[:, np.newaxis]

    def finish(self, dt: float) -> None:
        """Move the bodies."""
        self._move(self._wanted, dt)


class Chase:
    """A pursuit after a scenario, run piece by piece.

    Parameters
    ----------
    scenario : Scenario
        Everything but the seed; its planner decides nothing here.
    control : {"checkpoint", "velocity"}
        What robots are told, see ``CONTROLS``.

    Attributes
    ----------
    cells : CellMap
        Where.
    captor : int or None
        Who has captured the evader, counted from 0.
    """

    def __init__(self, scenario: Scenario, control: str) -> None:
        self.scenario, self.control = scenario, control
        self.team, self.evader, self.timing = scenario.team(), scenario.quarry(), scenario.timing()
        self.motion = scenario.belief_motion()
        _, self.cells = scenario.place()
        check_pursuit(self.cells, self.team, self.evader, scenario.capture)
        check_clocks(self.cells, self.team, self.evader, self.timing)
        graph, capture = SearchGraph.from_cells(self.cells), believed_capture(self.team, self.timing)
        speeds = (self.team.speed,) * self.team.pursuers
        self.problem = SearchProblem(graph, self.motion, capture, speeds, self.timing.belief_step)
        self.begin(0)

    def begin(self, seed: int) -> None:
        """Begin anew; ``seed`` says where the evader starts and goes, as in :func:`geomsim.run_episode`."""
        self.seed = seed
        crew = Roamers if self.control == "velocity" else Teamwork
        told = self.scenario
        self._pursuit = Pursuit(
            self.cells.plan,
            self.cells,
            self.team,
            self.evader,
            (seed, seed),
            told.capture,
            self.motion,
            self.timing,
            crew,
        )
        self.captor = self._pursuit.captor()
        self._k = 0
        self._open()

    @property
    def work(self) -> Teamwork:
        """The team."""
        return self._pursuit.work

    @property
    def time(self) -> float:
        """Seconds since the beginning."""
        return self._pursuit.log.times[-1]

    @property
    def over(self) -> bool:
        """Whether the evader is captured or time is up."""
        return self.captor is not None or self._k >= self.timing.steps

    @property
    def waiting(self) -> NDArray[np.bool_]:
        """Who must be told where to go, shape (P,)."""
        mine: NDArray[np.bool_] = self.work.waiting[0]
        return mine

    @property
    def state(self) -> SearchState:
        """What a policy may know."""
        return self.work.state(0, self._k * self.timing.physics_step)

    def choices(self, robot: int) -> tuple[int, ...]:
        """Return where a robot can be sent: the cell that it is in or on its way to, then the neighbours of that."""
        cell = int(self.work.goals[0, robot])
        return (cell, *self.work.routes.neighbours[cell])

    def send(self, goals: Mapping[int, int]) -> None:
        """Send robots that wait to cells of their choice, counted from 0; run on until one waits, or it is over."""
        at = self._k * self.timing.physics_step
        for robot in np.flatnonzero(self.waiting).tolist():
            if not self.over:
                self.work.send(0, robot, at, (goals[robot],))
        while not self.over:
            self._close()
            if self.over or self.waiting.any():
                return

    def drive(self, velocities: Sequence[NDArray[np.float64]] | NDArray[np.float64]) -> None:
        """Let the robots go with velocities, shape (P, 2), metres a second, for a belief step, or until it is over."""
        if not isinstance(self.work, Roamers):
            raise ScenarioError("Robots that are told checkpoints take no velocities.")
        self.work.drive(np.asarray(velocities, dtype=np.float64))
        for _ in range(self.timing.steps_per_belief):
            if not self.over:
                self._close()

    def episode(self) -> Episode:
        """Return the record so far."""
        status = Status.CAPTURED if self.captor is not None else Status.TIME_LIMIT if self.over else Status.INTERRUPTED
        outcome = self._pursuit.outcome(status, self.captor)
        told = self.scenario.model_copy(update={"seed": self.seed})
        return self._pursuit.log.episode(told.as_dict(), self.cells.plan, self.cells, outcome)

    def told(self) -> dict[str, float | int]:
        """Return what is no observation: ``time`` since the beginning, ``captured_by`` whom, -1 for nobody."""
        return {"time": self.time, "captured_by": -1 if self.captor is None else self.captor}

    def sights(self) -> NDArray[np.bool_]:
        """Which checkpoints each robot sees, shape (P, N)."""
        world, sensor, work = self._pursuit.quarry.world, self.team.sensor, self.work
        seen = np.zeros((self.team.pursuers, len(self.cells)), dtype=np.bool_)
        for i, (eye, heading) in enumerate(zip(work.positions[0], work.headings[0].tolist(), strict=True)):
            for cell in np.flatnonzero(self.cells.components >= 0).tolist():
                seen[i, cell] = sensor.sees(world, eye, heading, self.cells.checkpoints[cell])
        return seen

    def _open(self) -> None:
        self._before = self.work.positions[0]
        self.work.advance(self.timing.physics_step)

    def _close(self) -> None:
        """Finish a physics step that all robots know their way for, and begin the next."""
        self.work.finish(self.timing.physics_step)
        self.captor = self._pursuit.settle(self._k, self._before)
        self._k += 1
        if not self.over:
            self._open()
