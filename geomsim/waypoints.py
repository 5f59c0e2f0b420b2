"""What a team is to do, as places with times: for a record, or for a team that has not met anybody yet."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import yaml

from discretize import CellMap
from geomsim.episode import Episode
from geomsim.pursuit import Timing, check_clocks, check_pursuit
from geomsim.seeds import Streams
from geomsim.team import Evader, Team, place_team
from geomsim.teamwork import Teamwork
from geomsim.walking import Route, Routes
from maps import GeomsimError
from planners import AreaSpeedDegree, MotionModel

__all__ = ["Waypoint", "nav2_text", "plan_waypoints", "record_waypoints", "waypoints_text"]


@dataclass(frozen=True, slots=True)
class Waypoint:
    """A place that a robot is to be at.

    Attributes
    ----------
    robot : int
        Who, counted from 0.
    time : float
        When, seconds from the start.
    x, y : float
        Where, metres on the plan.
    heading : float
        Where it then goes, or, if it stays, where it came from; radians, counterclockwise from the x axis.
    cell : int
        The cell that it is in, counted from 0.
    checkpoint : bool
        Whether this is a cell's checkpoint, at which the robot decides; otherwise a bend of the way to one.
    """

    robot: int
    time: float
    x: float
    y: float
    heading: float
    cell: int
    checkpoint: bool


def plan_waypoints(
    cells: CellMap,
    team: Team | None = None,
    *,
    duration: float = 300.0,
    seed: int = 0,
    motion: MotionModel | None = None,
    timing: Timing | None = None,
) -> tuple[tuple[Waypoint, ...], ...]:
    """Let a team search an empty building, and return where each robot goes as long as nobody is captured.

    Until capture robots learn nothing that depends on the evader, so this is what they do in every pursuit with this
    seed.

    Parameters
    ----------
    cells : CellMap
        Where.
    team : Team, optional
        Who.
    duration : float
        For how long, seconds.
    seed : int
        Where the planner's chance comes from, as in :func:`geomsim.run_episode`.
    motion : MotionModel, optional
        What the robots believe of the evader's motion; by default area, degree and a speed of 1 m/s.
    timing : Timing, optional
        Clocks; the limit does not count.

    Returns
    -------
    tuple of tuple of Waypoint
        One row for each robot.

    Raises
    ------
    GeomsimError
        If the team cannot be placed, or a body is too large for the routes of ``cells``.
    """
    team, told = team or Team(), timing or Timing()
    clocks = Timing(duration, told.belief_step, told.physics_step)
    like_us = Evader(speed=team.speeds[0], radius=team.radius)
    check_pursuit(cells, team, like_us, "cell")
    check_clocks(cells, team, like_us, clocks)
    _check_checkpoints(team.checkpoints)
    starts, dt = place_team(cells, team), clocks.physics_step
    believed = motion or AreaSpeedDegree(1.0)
    work = Teamwork(cells, team, starts, believed, clocks.belief_step, [Streams(seed).deciding])
    for k in range(clocks.steps):
        work.step(k * dt, dt)
        if (k + 1) % clocks.steps_per_belief == 0:
            work.learn()
    decisions = [(choice.time, choice.pursuer, choice.path[0]) for choice in work.choices]
    return _follow(work.routes, starts, decisions, team.speeds, clocks)


def record_waypoints(episode: Episode) -> tuple[tuple[Waypoint, ...], ...]:
    """Return where the robots of a recorded pursuit were sent, up to its end; one row for each robot."""
    told = episode.scenario
    _check_checkpoints(told.get("checkpoints", "centroids"))
    decided = zip(episode.decision_times, episode.decision_pursuers, episode.decision_paths, strict=True)
    decisions = [(float(time), int(who), int(path[0])) for time, who, path in decided]
    starts = episode.pursuer_cells[0].tolist()
    end = max(episode.outcome.time, told["physics_step"])
    timing = Timing(end, told["belief_step"], told["physics_step"])
    speeds = told["speed"] if isinstance(told["speed"], list | tuple) else [told["speed"]] * len(starts)
    return _follow(Routes(episode.cells), starts, decisions, speeds, timing)


def waypoints_text(rows: Iterable[Sequence[Waypoint]]) -> str:
    """Return waypoints as CSV, robots and cells with their numbers from 1; metres, seconds, radians."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["robot", "time", "x", "y", "heading", "cell", "kind"])
    for row in rows:
        for w in row:
            kind = "checkpoint" if w.checkpoint else "way"
            numbers = [f"{value:.3f}" for value in (w.time, w.x, w.y, w.heading)]
            table.writerow([w.robot + 1, *numbers, w.cell + 1, kind])
    return text.getvalue()


def nav2_text(row: Sequence[Waypoint], *, checkpoints_only: bool = True) -> str:
    """Return one robot's waypoints in the YAML that the Nav2 panel of RViz loads for the waypoint follower.

    ``waypoints`` maps a name to a ``pose``, x, y and z in the frame of the map, and an ``orientation``, a quaternion
    w, x, y, z (nav2_rviz_plugins, nav2_panel.cpp). Nav2 has no use for times and looks at no other key; ``time`` and
    ``cell`` are there for people and other programs. A stay is one waypoint, at which the robot is to wait.

    Parameters
    ----------
    row : sequence of Waypoint
        In order.
    checkpoints_only : bool
        Whether to leave out the bends of the way, which Nav2's own planner finds better with what it sees.
    """
    kept: list[Waypoint] = []
    for w in row:
        stays = bool(kept) and (kept[-1].x, kept[-1].y) == (w.x, w.y)
        if not stays and (w.checkpoint or not checkpoints_only):
            kept.append(w)
    poses = {
        f"waypoint{k}": {
            "pose": [round(w.x, 4), round(w.y, 4), 0.0],
            "orientation": [round(math.cos(w.heading / 2), 6), 0.0, 0.0, round(math.sin(w.heading / 2), 6)],
            "time": round(w.time, 3),
            "cell": w.cell + 1,
        }
        for k, w in enumerate(kept)
    }
    return yaml.safe_dump({"waypoints": poses}, sort_keys=False, default_flow_style=None)


def _follow(
    routes: Routes,
    starts: Sequence[int],
    decisions: Iterable[tuple[float, int, int]],
    speeds: Sequence[float],
    timing: Timing,
) -> tuple[tuple[Waypoint, ...], ...]:
    """Turn decisions (time, robot, next cell), in order of time, into waypoints up to the time limit."""
    here, heading, free = list(starts), [0.0] * len(starts), [timing.physics_step] * len(starts)
    rows: list[list[Waypoint]] = [[] for _ in starts]
    for time, who, to in decisions:
        at, speed = here[who], speeds[who]
        stay = to == at
        route = routes.stay(at, speed * timing.belief_step) if stay else routes.between(at, to)
        # a robot decides a step before it comes to the checkpoint; later only if it was held up on its way
        begin = free[who] if time < free[who] + timing.physics_step else time + timing.physics_step
        times = begin + route.marks / speed
        headings = _headings(route, heading[who])
        first = 0 if not rows[who] else 1  # the end of one route is the beginning of the next
        if rows[who]:
            last = rows[who].pop()
            rows[who].append(Waypoint(who, last.time, last.x, last.y, headings[0], last.cell, last.checkpoint))
        last_point = len(route.points) - 1
        for k in range(first, last_point + 1):
            x, y = route.points[k].tolist()
            cell = route.cell(float(route.marks[k]))
            rows[who].append(Waypoint(who, float(times[k]), x, y, headings[k], cell, k in (0, last_point)))
        here[who], heading[who], free[who] = to, headings[-1], begin + route.length / speed
    return tuple(tuple(w for w in row if w.time <= timing.limit + 1e-9) for row in rows)


def _check_checkpoints(kind: str) -> None:
    if kind != "centroids":
        raise GeomsimError(f"Waypoints are made of teams that decide at centroids, not at {kind}.")


def _headings(route: Route, before: float) -> list[float]:
    """Return the heading after each point of a route: of the piece that begins there, at its end of the last one."""
    headings = []
    for dx, dy in np.diff(route.points, axis=0).tolist():
        if dx or dy:
            before = math.atan2(dy, dx)
        headings.append(before)
    return [*headings, before]
