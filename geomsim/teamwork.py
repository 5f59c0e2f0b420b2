"""Teams at work: bodies, beliefs and decisions of one or several runs of the same team.

Until capture no robot learns anything that depends on the evader's place beyond "not seen", which the belief holds
already. So a run of a team needs no evader.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from discretize import CellMap
from geomsim.believing import believed_problem
from geomsim.crew import Crew
from geomsim.measuring import RangeReadings
from geomsim.team import Team
from geomsim.walking import Routes, Walkers
from geomsim.world import World
from maps import GeomsimError
from planners import CaptureModel, LineOfSight, MotionModel, PursuerState, SearchProblem

if TYPE_CHECKING:
    from planners.motion import Sparse

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
        Cells to visit, counted from 0, the next one first; of checkpoints only those that are cells.
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
    motion : MotionModel
        How the team believes the evader to move from cell to cell.
    belief_step : float
        Time between two calls of :meth:`learn`, seconds.
    deciding : sequence of Generator
        The planner's chance in each run.
    evaders : int
        How many are searched for.

    Attributes
    ----------
    headings : ndarray, shape (R, P)
        Directions of travel, radians, counterclockwise from the x axis; a robot that stands keeps its last one.
    crews : list of Crew
        What the robots of each run know.
    choices : list of Choice
        What has been decided so far.
    """

    def __init__(
        self,
        cells: CellMap,
        team: Team,
        starts: Sequence[int],
        motion: MotionModel,
        belief_step: float,
        deciding: Sequence[np.random.Generator],
        evaders: int = 1,
    ) -> None:
        self.team, self._where = team, cells
        roads, self._problem = believed_problem(cells, team, motion, belief_step)
        self.routes = Routes(roads)
        self.runs, self._shape = len(deciding), (len(deciding), team.pursuers)
        begin = [self.routes.stay(cell, 0.0) for cell in starts] * self.runs
        size = len(begin)
        speeds = np.tile(team.speeds, self.runs)
        self._walkers = Walkers(speeds, begin)
        self._world = World(
            cells.plan.walls, np.array([route.points[0] for route in begin]), np.full(size, team.radius)
        )
        self.headings = np.zeros(self._shape)
        self._stays = speeds * belief_step
        self._looks = _Looks(self._problem.captures, self.routes, speeds)
        self._readings = RangeReadings.of(cells, self._problem, team.range_noise or 0.0)
        belief = self._problem.first_belief(starts, int(roads.graph.component[starts[0]]))
        self.crews = [
            Crew(
                self._problem,
                team.planner,
                belief,
                starts,
                chance,
                central=team.communication.central,
                evaders=evaders,
            )
            for chance in deciding
        ]
        self.choices: list[Choice] = []

    @property
    def problem(self) -> SearchProblem:
        """What the team plans for."""
        return self._problem

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
        """The checkpoints at which they are or will be next, shape (R, P)."""
        return self._walkers.ends.reshape(self._shape)

    @property
    def idle(self) -> NDArray[np.float64]:
        """Seconds for which each has been held up, shape (R, P)."""
        return self._walkers.idle.reshape(self._shape)

    @property
    def beliefs(self) -> NDArray[np.float64]:
        """Probability of capture and of each cell, by all looks of each run, shape (R, N + 1)."""
        return np.array([self._problem.states.gather(crew.belief) for crew in self.crews])

    def own_beliefs(self, run: int) -> NDArray[np.float64]:
        """Return the same by what each robot of a run knows, shape (P, N + 1); (0, N + 1) where one plans for all."""
        states = self._problem.states
        own = [states.gather(belief) for belief in self.crews[run].own_beliefs]
        return np.array(own).reshape(len(own), states.cells + 1)

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
        self._looks.lag = 2.0 * dt
        self._move(self._walkers.wanted(dt), dt)

    def _move(self, wanted: NDArray[np.float64], dt: float) -> None:
        self._world.step(wanted, dt)
        vx, vy = self._world.velocities.T
        course = np.where(np.hypot(vx, vy) > 1e-3, np.arctan2(vy, vx), self.headings.reshape(-1))
        self.headings = course.reshape(self._shape)

    def learn(self, ranges: NDArray[np.float64] | None = None) -> None:
        """Take a belief step: dispersion, then capture where the pursuers are (Eq. 3), then what they measured.

        Parameters
        ----------
        ranges : ndarray, shape (P, E), optional
            Distance of each evader from each pursuer of the only run, as measured, metres; NaN where none was.
        """
        for run, crew in enumerate(self.crews):
            mine = range(run * self.team.pursuers, (run + 1) * self.team.pursuers)
            rows = np.array([self._looks.row(i, k, self._walkers) for i, k in enumerate(mine)])
            likelihoods = None if ranges is None else self._readings.likelihoods(self.positions[run], ranges)
            crew.learn(rows, self._contacts(run), likelihoods)

    def _contacts(self, run: int) -> NDArray[np.bool_]:
        return self.team.communication.contacts(self._world, self.positions[run])

    def states(self, run: int) -> list[PursuerState]:
        """Return where the pursuers of a run are on their ways."""
        walkers, first = self._walkers, run * self.team.pursuers
        done, aimed, left = walkers.done, walkers.aimed_stops, walkers.time_left
        return [
            PursuerState(int(walkers.ends[k]))
            if done[k]
            else PursuerState(int(aimed[k]), int(walkers.ends[k]), float(left[k]))
            for k in range(first, first + self.team.pursuers)
        ]

    def send(self, run: int, pursuer: int, time: float, path: Sequence[int]) -> None:
        """Send a pursuer that waits at a checkpoint to a neighbouring one, or let it stay for a belief step.

        Parameters
        ----------
        run, pursuer : int
            Who, counted from 0.
        time : float
            Seconds.
        path : sequence of int
            Checkpoints to visit, counted from 0, the next one first; its own to stay.

        Raises
        ------
        GeomsimError
            If the path does not begin with a neighbour of the pursuer's checkpoint or that itself.
        """
        k = run * self.team.pursuers + pursuer
        here = int(self._walkers.ends[k])
        if not path or path[0] not in (here, *self.routes.neighbours[here]):
            raise GeomsimError(
                f"The policy of {type(self.team.planner).__name__} sent pursuer {pursuer + 1} from cell {here + 1} to "
                "no neighbour of it; run planners.check_policy on it."
            )
        cells = self._problem.states.cells
        self.choices.append(Choice(time, run, pursuer, tuple(stop for stop in path if stop < cells)))
        to = path[0]
        if to == here:
            self._walkers.take(k, self.routes.stay(here, float(self._stays[k])))
        else:
            self._looks.arrival[k] = self.routes.roads.graph.edge(here, to)
            self._walkers.take(k, self.routes.between(here, to))

    def _decide(self, run: int, time: float) -> None:
        waiting = self.waiting[run].tolist()
        decisions = self.crews[run].decide(time, self.states(run), waiting, self._contacts(run))
        for pursuer in np.flatnonzero(waiting).tolist():
            decision = decisions[pursuer]
            self.send(run, pursuer, time, () if decision is None else decision.path)


class _Looks:
    """What robots see from where they are, as the belief counts it.

    ``arrival[k]`` is the way on which walker ``k`` goes or by which it came, -1 before its first one; ``lag`` how many
    seconds its body is behind its aim.
    """

    def __init__(self, captures: Sequence[CaptureModel], routes: Routes, speeds: NDArray[np.float64]) -> None:
        self._captures, self._graph, self._speeds = captures, routes.roads.graph, speeds
        self._rows: dict[tuple[int, int], NDArray[np.float64]] = {}
        self._tables: dict[int, Sparse] = {}
        self.arrival = np.full(len(speeds), -1)
        self.lag = 0.0

    def row(self, pursuer: int, k: int, walkers: Walkers) -> NDArray[np.float64]:
        """Return the detection probability of each state, shape (S,), for walker ``k``, a pursuer of its team."""
        capture = self._captures[pursuer]
        if not isinstance(capture, LineOfSight):
            key = (pursuer, int(walkers.cells[k]))
            if key not in self._rows:
                self._rows[key] = capture.row(self._graph, key[1])
            return self._rows[key]
        view = int(walkers.ends[k])
        if self.arrival[k] >= 0:
            edge = int(self.arrival[k])
            standing = walkers.begins[k] == walkers.ends[k]
            gone = np.inf if standing else max(0.0, walkers.aim[k] - self.lag * self._speeds[k])
            way = min(gone, float(self._graph.length[edge]))
            view = int(capture.viewpoints(self._graph, edge, np.array([way]))[0])
        key = (pursuer, view)
        if key not in self._rows:
            if pursuer not in self._tables:
                self._tables[pursuer] = capture.table(self._graph)
            self._rows[key] = self._tables[pursuer][[view]].toarray()[0]
        return self._rows[key]
