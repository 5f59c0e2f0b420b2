"""The search problem that a team believes to be in: where it goes, what it catches, how the evader moves."""

from __future__ import annotations

import math

from discretize import CellMap
from geomsim.sensing import Sensor
from geomsim.team import Team
from maps import GeomsimError
from planners import (
    CaptureModel,
    LineOfSight,
    MotionInParts,
    MotionModel,
    OwnCell,
    Roads,
    SameCell,
    SearchGraph,
    SearchProblem,
    SightMap,
    StateSpace,
    StationaryMotion,
)
from planners.places import Places, StandingStill, Strolling, sight_of_places

__all__ = ["believed_problem", "strolling"]


def believed_problem(
    cells: CellMap, team: Team, motion: MotionModel, belief_step: float
) -> tuple[Roads, SearchProblem]:
    """Return the roads that a team goes on, and the problem that it plans for.

    Parameters
    ----------
    cells : CellMap
        Where.
    team : Team
        Who.
    motion : MotionModel
        How the evader is believed to move between cells.
    belief_step : float
        Seconds.

    Raises
    ------
    GeomsimError
        If there is no such problem for what the team believes.
    """
    if team.believes == "particles":
        raise GeomsimError(
            "Robots do not plan on a belief of particles, which serves predictions by sight; let it be places."
        )
    roads = Roads.of(cells, team.checkpoints)
    if team.believes == "cell" and team.checkpoints == "centroids":
        own = tuple(SameCell(_noticed(sensor, belief_step)) for sensor in team.sensors)
        return roads, SearchProblem(roads.graph, motion, own, team.speeds, belief_step)
    if team.believes == "places":
        return roads, _on_places(cells, roads, team, motion, belief_step)
    space = StateSpace.of_cells(len(cells))
    captures: tuple[CaptureModel, ...]
    if team.believes == "sight":
        sights = SightMap.of(cells, roads, max(sensor.range for sensor in team.sensors))
        space = sights.space
        captures = tuple(
            LineOfSight(sights, sensor.range, sensor.field_of_view, _noticed(sensor, belief_step))
            for sensor in team.sensors
        )
    else:
        kinds = {sensor: OwnCell(roads, space, _noticed(sensor, belief_step)) for sensor in team.sensors}
        captures = tuple(kinds[sensor] for sensor in team.sensors)
    split = MotionInParts(motion, SearchGraph.from_cells(cells), space)
    return roads, SearchProblem(roads.graph, split, captures, team.speeds, belief_step, space)


def _on_places(cells: CellMap, roads: Roads, team: Team, motion: MotionModel, belief_step: float) -> SearchProblem:
    """Return the problem whose states are places on the routes between the centroids of cells."""
    moves = strolling(cells, motion, belief_step)
    places = moves.places
    reach = max(sensor.range for sensor in team.sensors)
    sights = sight_of_places(cells, roads, places, max(team.speeds) * belief_step, reach)
    captures = tuple(
        LineOfSight(sights, sensor.range, sensor.field_of_view, _noticed(sensor, belief_step))
        for sensor in team.sensors
    )
    return SearchProblem(roads.graph, moves, captures, team.speeds, belief_step, places.space)


def strolling(cells: CellMap, motion: MotionModel, belief_step: float) -> Strolling | StandingStill:
    """Return the motion over places of an evader as fast as one that another model speaks of.

    Parameters
    ----------
    cells : CellMap
        Where.
    motion : MotionModel
        One with a speed, or ``StationaryMotion``.
    belief_step : float
        Seconds.

    Raises
    ------
    GeomsimError
        If the model has no speed.
    """
    if isinstance(motion, StationaryMotion):
        return StandingStill(Places.of(Roads.of(cells), belief_step))
    speed = getattr(motion, "speed", None)
    if speed is None:
        raise GeomsimError(
            f"A belief over places needs the evader's speed, of which {type(motion).__name__} knows nothing: let the "
            "belief's motion be area-speed-degree, dwell-time or stationary."
        )
    return Strolling(Places.of(Roads.of(cells), speed * belief_step), speed)


def _noticed(sensor: Sensor, belief_step: float) -> float:
    """Return the probability of noticing within a belief step, an evader in view."""
    return -math.expm1(-sensor.attention * belief_step)
