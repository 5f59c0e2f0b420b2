"""A team of real robots, guided step by step: told where they are and what they saw, it says where they go next.

The guide has a clock of its own. It begins at the first call and goes on only when the guide is told what time it is;
the computer's is never asked. Messages may come in any order:

- a *repeated* message, of the same robot and time, changes nothing, and neither does the same call made twice;
- a *late* message corrects the belief as if it had come in time, if it is not older than ``memory``; an older one
  counts only for what was seen. It never moves a robot back: of positions, the newest counts;
- of a robot whose message is *missing*, it is not taken for granted that it looked: the belief spreads as if that
  robot were not there, until a message comes. Its last order stands. After ``patience`` seconds without one it is in
  :attr:`Orders.silent`, and nothing it announced counts for the others' plans;
- a robot that has gone *astray*, in neither cell of its way and further than ``leeway`` from it, is sent to the
  checkpoint of the cell that it is in.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize import CellMap
from geomsim.believing import believed_problem
from geomsim.seeds import Streams
from geomsim.team import Team, place_team
from geomsim.walking import Routes
from maps import GeomsimError
from planners import (
    AreaSpeedDegree,
    LineOfSight,
    MotionModel,
    PursuerState,
    SearchState,
    advance,
)

__all__ = ["Guide", "GuideError", "Order", "Orders", "Report"]


class GuideError(GeomsimError):
    """A message that no robot of the team can have sent, or a policy that breaks its contract."""


@dataclass(frozen=True, slots=True)
class Report:
    """What a robot tells of one moment.

    Attributes
    ----------
    robot : int
        Who, counted from 0.
    time : float
        When that was, seconds on the clock that the guide is told.
    position : tuple of float
        Where it was, metres on the plan.
    seen : tuple of float or None
        Where it saw the evader, metres; None if it looked and saw nobody.
    """

    robot: int
    time: float
    position: tuple[float, float]
    seen: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class Order:
    """Where a robot is to go.

    Attributes
    ----------
    robot : int
        Who, counted from 0.
    cell : int
        The cell to whose checkpoint it goes, counted from 0; its own if it is to stay there. Of a team that decides at
        boundaries too, numbers beyond the cells are their checkpoints.
    path : tuple of int
        Those that it is meant to visit, that one first; a plan that may change.
    way : ndarray, shape (k, 2)
        A polyline from where it is to the checkpoint, free of walls, metres.
    given : float
        When the order was given, seconds on the robots' clock.
    due : float
        When the robot is expected at the checkpoint, or, of a stay, when that ends; on the same clock.
    """

    robot: int
    cell: int
    path: tuple[int, ...]
    way: NDArray[np.float64]
    given: float
    due: float


@dataclass(frozen=True, slots=True)
class Orders:
    """What the guide says at one moment.

    Attributes
    ----------
    time : float
        Seconds since its first call.
    orders : tuple of Order
        The order of each robot that stands now, new or old.
    new : tuple of int
        Whose order is new, robots counted from 0.
    silent : tuple of int
        Who has not been heard of for longer than the guide's patience.
    belief : ndarray, shape (N + 1,)
        Probability of capture so far (index 0) and of the evader's being in each cell.
    seen : Report or None
        The first message in which the evader was seen; from then on there are no new orders.
    """

    time: float
    orders: tuple[Order, ...]
    new: tuple[int, ...]
    silent: tuple[int, ...]
    belief: NDArray[np.float64]
    seen: Report | None


@dataclass(slots=True)
class _Robot:
    """What is known of one robot."""

    order: Order
    origin: int
    position: NDArray[np.float64]
    cell: int
    heard: float = -math.inf
    plan: tuple[int, ...] = ()
    times: set[float] = field(default_factory=set)

    @property
    def is_waiting(self) -> bool:
        """Whether its order is to stay."""
        return bool(np.array_equal(self.order.way[0], self.order.way[-1]))


class Guide:
    """Plans for a team in the world, one call at a time.

    Parameters
    ----------
    cells : CellMap
        The building.
    team : Team, optional
        As for :func:`geomsim.run_episode`; one planner plans for all, whoever hears whom. The belief begins without the
        cells in which the robots start.
    seed : int
        The planner's chance; the same messages and the same seed give the same orders.
    motion : MotionModel, optional
        What the team believes of the evader's motion; by default area, degree and a speed of 1 m/s.
    belief_step : float
        Time between two belief steps, seconds.
    arrival : float
        A robot this close to its checkpoint has come to it, metres.
    patience : float
        Seconds without a message after which a robot counts as silent.
    memory : float
        A message may be late by so many seconds to be counted in full.
    leeway : float
        How far a robot may be from its way in a cell through which that does not lead, metres.

    Raises
    ------
    GeomsimError
        If the team cannot be placed, or a duration or distance is not above 0 and finite.
    """

    def __init__(
        self,
        cells: CellMap,
        team: Team | None = None,
        *,
        seed: int = 0,
        motion: MotionModel | None = None,
        belief_step: float = 1.0,
        arrival: float = 0.25,
        patience: float = 5.0,
        memory: float = 60.0,
        leeway: float = 1.0,
    ) -> None:
        for name, value in (("arrival", arrival), ("patience", patience), ("memory", memory), ("leeway", leeway)):
            if not 0 < value < math.inf:
                raise GuideError(f"A guide's {name} must be above 0 and finite, but is {value:g}.")
        self.cells, self.team = cells, team or Team()
        self.belief_step, self.arrival = belief_step, arrival
        self.patience, self.memory, self.leeway = patience, memory, leeway
        starts = place_team(cells, self.team)
        roads, self._problem = believed_problem(cells, self.team, motion or AreaSpeedDegree(1.0), belief_step)
        self._graph, self._routes = roads.graph, Routes(roads)
        self._transition = self._problem.motion.matrix(self._graph, belief_step)
        self._rows: dict[tuple[int, int], NDArray[np.float64]] = {}
        self._policy = self.team.planner.solve(self._problem, Streams(seed).deciding)
        # the belief after each step, as far back as late messages may change it, and who looked from where in it
        self._beliefs = {0: self._problem.first_belief(starts, int(self._graph.component[starts[0]]))}
        self._looks: dict[int, dict[int, tuple[float, int]]] = {}
        self._robots = [self._placed(k, cell) for k, cell in enumerate(starts)]
        self._began: float | None = None
        self._now = 0.0
        self._seen: Report | None = None

    @property
    def belief(self) -> NDArray[np.float64]:
        """What the team believes now, shape (N + 1,); index 0 is the capture state."""
        return self._problem.states.gather(self._beliefs[max(self._beliefs)])

    def step(self, now: float, reports: Iterable[Report] = ()) -> Orders:
        """Take in messages, let time pass up to ``now``, and say what each robot is to do.

        Parameters
        ----------
        now : float
            Seconds on the robots' clock, whose zero may be anywhere. A time before that of the last call counts as
            the same.
        reports : iterable of Report
            What has come in since the last call, in any order; see the head of this module.

        Raises
        ------
        GuideError
            If a message is of no robot of the team, of the future, or holds numbers that are not finite. None of the
            messages of this call then counts.
        """
        if not math.isfinite(now):
            raise GuideError(f"The time must be finite, but is {now}.")
        came = sorted(reports, key=lambda report: report.time)
        begin = now if self._began is None else self._began
        latest = max(now - begin, self._now)
        for report in came:
            self._check(report, begin + latest)
        self._began, self._now = begin, latest
        changed = min((self._hear(report) for report in came), default=self._steps + 1)
        self._believe(changed)
        new = () if self._seen else self._decide()
        return Orders(
            time=self._now,
            orders=tuple(robot.order for robot in self._robots if robot.order.given > -math.inf),
            new=new,
            silent=tuple(k for k, robot in enumerate(self._robots) if self._is_silent(robot)),
            belief=self.belief,
            seen=self._seen,
        )

    @property
    def _steps(self) -> int:
        """Belief steps that are complete at this time."""
        return math.floor(self._now / self.belief_step + 1e-9)

    def _placed(self, k: int, cell: int) -> _Robot:
        here = self._routes.checkpoint(cell)
        return _Robot(Order(k, cell, (cell,), np.stack([here, here]), -math.inf, -math.inf), cell, here, cell)

    def _check(self, report: Report, latest: float) -> None:
        if not 0 <= report.robot < len(self._robots):
            raise GuideError(f"There is no robot {report.robot}; the team's are 0 to {len(self._robots) - 1}.")
        numbers = (report.time, *report.position, *(report.seen or ()))
        if not all(map(math.isfinite, numbers)):
            raise GuideError(f"A message of robot {report.robot} holds a number that is not finite: {report}.")
        if report.time > latest + 1e-9:
            raise GuideError(
                f"A message of robot {report.robot} is of {report.time - latest:g} s in the future: its clock and the "
                "guide's do not agree."
            )

    def _hear(self, report: Report) -> int:
        """Take in a message; return the first belief step that it changes."""
        robot, unchanged = self._robots[report.robot], self._steps + 1
        if report.time in robot.times:
            return unchanged
        robot.times.add(report.time)
        if report.seen is not None and self._seen is None:
            self._seen = report
        position = np.array(report.position, dtype=np.float64)
        cell = self._locate(position)
        if report.time > robot.heard:
            robot.heard, robot.position, robot.cell = report.time, position, cell
        assert self._began is not None  # set by the caller
        step = math.ceil((report.time - self._began) / self.belief_step - 1e-9)
        if step <= min(self._beliefs):
            return unchanged  # before the pursuit began, or forgotten
        looks = self._looks.setdefault(step, {})
        before = looks.get(report.robot)
        if before is not None and before[0] >= report.time:
            return unchanged
        view = self._view(report.robot, position, cell)
        looks[report.robot] = report.time, view
        return step if before is None or before[1] != view else unchanged

    def _believe(self, changed: int) -> None:
        """Take all belief steps up to now, anew from the first one that a message changed; forget what is too old."""
        for step in range(min(changed, max(self._beliefs) + 1), self._steps + 1):
            looks = {who: view for who, (_, view) in self._looks.get(step, {}).items()}
            rows = np.array([self._row(who, view) for who, view in sorted(looks.items())])
            rows = rows.reshape(len(looks), len(self._beliefs[step - 1]) - 1)
            self._beliefs[step] = advance(self._beliefs[step - 1], self._transition, rows)
        oldest = self._steps - math.ceil(self.memory / self.belief_step)
        for step in [step for step in self._beliefs if step < oldest]:
            del self._beliefs[step]
            self._looks.pop(step, None)
        for robot in self._robots:
            robot.times = {time for time in robot.times if time >= robot.heard - self.memory}

    def _decide(self) -> tuple[int, ...]:
        """Give orders to those that have come to their checkpoint, or that are lost."""
        lost = [k for k, robot in enumerate(self._robots) if self._is_lost(robot)]
        for k in lost:
            self._send_home(k)
        arrived = [k for k, robot in enumerate(self._robots) if self._has_come(robot)]
        if arrived:
            states = tuple(self._state(robot, stands=k in arrived) for k, robot in enumerate(self._robots))
            plans = tuple(() if self._is_silent(robot) else robot.plan for robot in self._robots)
            decisions = self._policy.decide(SearchState(self._now, self._beliefs[max(self._beliefs)], states, plans))
            for k in arrived:
                decision, cell = decisions[k], self._robots[k].order.cell
                if decision is None or not decision.path or not self._can_go(cell, decision.path[0]):
                    raise GuideError(
                        f"The policy of {type(self.team.planner).__name__} sent robot {k} from cell {cell + 1} to no "
                        "neighbour of it; run planners.check_policy on it."
                    )
                self._send(k, tuple(decision.path))
        return tuple(sorted({*lost, *arrived}))

    def _can_go(self, cell: int, to: int) -> bool:
        return to == cell or to in self._routes.neighbours[cell]

    def _has_come(self, robot: _Robot) -> bool:
        """Whether a robot of which there is news stands at its checkpoint, and a stay there is over."""
        order = robot.order
        if robot.heard < order.given or robot.heard == -math.inf:
            return False
        if robot.is_waiting and order.due > self._clock + 1e-9:
            return False
        return float(np.hypot(*(robot.position - self._routes.checkpoint(order.cell)))) <= self.arrival + 1e-9

    def _is_lost(self, robot: _Robot) -> bool:
        """Whether a robot has gone astray."""
        if robot.heard == -math.inf or robot.cell in (robot.origin, robot.order.cell):
            return False
        return bool(shapely.LineString(robot.order.way).distance(shapely.Point(robot.position)) > self.leeway)

    def _is_silent(self, robot: _Robot) -> bool:
        return self._clock - max(robot.heard, self._began or 0.0) > self.patience

    @property
    def _clock(self) -> float:
        """Return the time on the robots' clock."""
        return (self._began or 0.0) + self._now

    def _view(self, k: int, position: NDArray[np.float64], cell: int) -> int:
        """Return the viewpoint that a robot looks from, as its capture model counts them."""
        capture, robot = self._problem.captures[k], self._robots[k]
        if not isinstance(capture, LineOfSight):
            return cell
        if robot.origin == robot.order.cell:
            return robot.order.cell
        edge = self._graph.edge(robot.origin, robot.order.cell)
        way = float(self._graph.length[edge]) - _way_left(robot.order.way, position)
        return int(capture.viewpoints(self._graph, edge, np.array([max(0.0, way)]))[0])

    def _row(self, k: int, view: int) -> NDArray[np.float64]:
        """Return the detection probability of each state for a robot at a viewpoint, shape (S,)."""
        if (k, view) not in self._rows:
            capture = self._problem.captures[k]
            seen = capture.table(self._graph)[[view]].toarray()[0] if isinstance(capture, LineOfSight) else None
            self._rows[k, view] = capture.row(self._graph, view) if seen is None else seen
        return self._rows[k, view]

    def _send_home(self, k: int) -> None:
        """Send a robot to the checkpoint of the cell that it is in."""
        robot = self._robots[k]
        way = np.stack([robot.position, self._routes.checkpoint(robot.cell)])
        lasts = float(np.hypot(*(way[1] - way[0]))) / self.team.speeds[k]
        robot.order = Order(k, robot.cell, (robot.cell,), way, self._clock, self._clock + lasts)
        robot.origin, robot.plan = robot.cell, ()

    def _send(self, k: int, path: tuple[int, ...]) -> None:
        robot, cell = self._robots[k], self._robots[k].order.cell
        stays = path[0] == cell
        here = self._routes.checkpoint(cell)
        way = np.stack([here, here]) if stays else self._routes.between(cell, path[0]).points
        lasts = self.belief_step if stays else self._routes.between(cell, path[0]).length / self.team.speeds[k]
        robot.order = Order(k, path[0], path, way, self._clock, self._clock + lasts)
        robot.origin, robot.plan = cell, path[1:]

    def _state(self, robot: _Robot, *, stands: bool) -> PursuerState:
        """Tell the policy where a robot is."""
        order = robot.order
        if stands:
            return PursuerState(order.cell)
        left = _way_left(order.way, robot.position) / self.team.speeds[order.robot]
        if robot.is_waiting:
            left = max(left, order.due - self._clock)
        cell = robot.cell if robot.cell in (robot.origin, order.cell) else robot.origin
        return PursuerState(cell, order.cell, left)

    def _locate(self, position: NDArray[np.float64]) -> int:
        """Return the cell that a position is in; of one in a wall, the nearest cell that a robot can enter."""
        cell = int(self.cells.locate(position[np.newaxis])[0])
        enterable = self.cells.components >= 0
        if cell >= 0 and enterable[cell]:
            return cell
        gaps = shapely.distance(np.array(self.cells.cells, dtype=object), shapely.Point(position))
        return int(np.argmin(np.where(enterable, gaps, np.inf)))


def _way_left(way: NDArray[np.float64], position: NDArray[np.float64]) -> float:
    """Return how far it is along a polyline from the place nearest to a position to its end, metres."""
    line = shapely.LineString(way)
    return float(line.length - line.project(shapely.Point(position)))
