"""Teams at work: bodies, beliefs and decisions of one or several runs of the same team.

Until capture no robot learns anything that depends on the evader's place beyond "not seen", which the belief holds
already. So a run of a team needs no evader.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from discretize import CellMap
from geomsim.team import Team
from geomsim.walking import Routes, Walkers
from geomsim.world import World
from maps import GeomsimError
from planners import (
    CaptureModel,
    MotionModel,
    Policy,
    PursuerState,
    SearchGraph,
    SearchProblem,
    SearchState,
    advance,
    uniform_belief,
)

__all__ = ["Choice", "Teamwork"]


@dataclass(frozen=True, slots=True)
class Choice:
    """A path that a pursuer chose.

    Attributes
    ----------
    time : float
        When, seconds.
    run : int
        In which run, counted from 0.
    pursuer : int
        Who, counted from 0.
    path : tuple of int
        Cells to visit, counted from 0, the next one first.
    """

    time: float
    run: int
    pursuer: int
    path: tuple[int, ...]


class Teamwork:
    """R runs of a team of P pursuers, all in step; how many there are changes nothing in any of them.

    Parameters
    ----------
    cells : CellMap
        Where.
    team : Team
        Who.
    starts : sequence of int
        The cell in which each pursuer starts, counted from 0.
    motion, capture : MotionModel, CaptureModel
        What the team believes.
    belief_step : float
        Time between two calls of :meth:`learn`, seconds.
    deciding : sequence of Generator
        The planner's chance in each run.

    Attributes
    ----------
    headings : ndarray, shape (R, P)
        Directions of travel, radians, counterclockwise from the x axis; a robot that stands keeps its last one.
    beliefs : ndarray, shape (R, N + 1)
        What each run believes.
    choices : list of Choice
        What has been decided so far.
    """

    def __init__(
        self,
        cells: CellMap,
        team: Team,
        starts: Sequence[int],
        motion: MotionModel,
        capture: CaptureModel,
        belief_step: float,
        deciding: Sequence[np.random.Generator],
    ) -> None:
        self.team, self.routes, self._where = team, Routes(cells), cells
        self.runs, self._shape = len(deciding), (len(deciding), team.pursuers)
        begin = [self.routes.stay(cell, 0.0) for cell in starts] * self.runs
        size = len(begin)
        self._walkers = Walkers(np.full(size, team.speed), begin)
        self._world = World(
            cells.plan.walls, np.array([route.points[0] for route in begin]), np.full(size, team.radius)
        )
        self.headings = np.zeros(self._shape)
        self._stay = team.speed * belief_step
        self._graph, self._capture = SearchGraph.from_cells(cells), capture
        self._transition = motion.matrix(self._graph, belief_step)
        speeds = (team.speed,) * team.pursuers
        problem = SearchProblem(self._graph, motion, capture, speeds, belief_step)
        self._policies: list[Policy] = [team.planner.solve(problem, rng) for rng in deciding]
        self._rows: dict[int, NDArray[np.float64]] = {}
        belief = uniform_belief(self._graph, exclude=starts, component=int(self._graph.component[starts[0]]))
        self.beliefs = np.tile(belief, (self.runs, 1))
        self._plans: list[list[tuple[int, ...]]] = [[()] * team.pursuers for _ in deciding]
        self.choices: list[Choice] = []

    @property
    def positions(self) -> NDArray[np.float64]:
        """Where the pursuers are, shape (R, P, 2), metres."""
        return self._world.positions.reshape(*self._shape, 2)

    @property
    def cells(self) -> NDArray[np.int32]:
        """The cells in which they are, counted from 0, shape (R, P)."""
        return self._walkers.cells.reshape(self._shape)

    @property
    def goals(self) -> NDArray[np.int32]:
        """The cells at whose checkpoints they are or will be next, shape (R, P)."""
        return self._walkers.ends.reshape(self._shape)

    @property
    def idle(self) -> NDArray[np.float64]:
        """Seconds for which each has been held up, shape (R, P)."""
        return self._walkers.idle.reshape(self._shape)

    def step(self, time: float, dt: float) -> None:
        """Go on from ``time`` by ``dt``, both in seconds; whoever comes to a checkpoint decides."""
        self.advance(dt)
        while self.waiting.any():
            for run in np.flatnonzero(self.waiting.any(axis=1)).tolist():
                self._decide(run, time)
        self.finish(dt)

    @property
    def waiting(self) -> NDArray[np.bool_]:
        """Who has come to a checkpoint and must be sent on before the step can be finished, shape (R, P)."""
        return self._walkers.done.reshape(self._shape)

    def advance(self, dt: float) -> None:
        """Begin a step of ``dt`` seconds: go on along the ways to the checkpoints."""
        self._walkers.advance(self._world.positions, self._world.velocities, dt)

    def finish(self, dt: float) -> None:
        """Finish the step: the bodies move."""
        self._move(self._walkers.wanted(dt), dt)

    def _move(self, wanted: NDArray[np.float64], dt: float) -> None:
        self._world.step(wanted, dt)
        vx, vy = self._world.velocities.T
        course = np.where(np.hypot(vx, vy) > 1e-3, np.arctan2(vy, vx), self.headings.reshape(-1))
        self.headings = course.reshape(self._shape)

    def learn(self) -> None:
        """Take a belief step: dispersion, then capture where the pursuers are (Eq. 3)."""
        rows = [[self._row(cell) for cell in run] for run in self.cells.tolist()]
        self.beliefs = advance(self.beliefs, self._transition, np.array(rows))

    def _row(self, cell: int) -> NDArray[np.float64]:
        if cell not in self._rows:
            self._rows[cell] = self._capture.row(self._graph, cell)
        return self._rows[cell]

    def state(self, run: int, time: float) -> SearchState:
        """Return what the policy of a run may know."""
        walkers, first = self._walkers, run * self.team.pursuers
        done, aimed, left = walkers.done, walkers.aimed_cells, walkers.time_left
        pursuers = tuple(
            PursuerState(int(walkers.ends[k]))
            if done[k]
            else PursuerState(int(aimed[k]), int(walkers.ends[k]), float(left[k]))
            for k in range(first, first + self.team.pursuers)
        )
        return SearchState(time, self.beliefs[run], pursuers, tuple(self._plans[run]))

    def send(self, run: int, pursuer: int, time: float, path: Sequence[int]) -> None:
        """Send a pursuer that waits at a checkpoint to a neighbouring cell, or let it stay for a belief step.

        Parameters
        ----------
        run, pursuer : int
            Who, counted from 0.
        time : float
            Seconds.
        path : sequence of int
            Cells to visit, counted from 0, the next one first; its own cell to stay.

        Raises
        ------
        GeomsimError
            If the path does not begin with a neighbour of the pursuer's cell or that cell.
        """
        k = run * self.team.pursuers + pursuer
        here = int(self._walkers.ends[k])
        if not path or path[0] not in (here, *self.routes.neighbours[here]):
            raise GeomsimError(
                f"The policy of {type(self.team.planner).__name__} sent pursuer {pursuer + 1} from cell {here + 1} to "
                "no neighbour of it; run planners.check_policy on it."
            )
        self.choices.append(Choice(time, run, pursuer, tuple(path)))
        self._plans[run][pursuer] = tuple(path[1:])  # the first hop is under way
        to = path[0]
        self._walkers.take(k, self.routes.stay(here, self._stay) if to == here else self.routes.between(here, to))

    def _decide(self, run: int, time: float) -> None:
        waiting = self.waiting[run]
        decisions = self._policies[run].decide(self.state(run, time))
        for pursuer in np.flatnonzero(waiting).tolist():
            decision = decisions[pursuer]
            self.send(run, pursuer, time, () if decision is None else decision.path)
