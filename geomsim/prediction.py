"""Exact predictions of a scenario: of an edge list's, or a floor plan's in the cell model or by sight."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from geomsim.believing import believed_problem
from geomsim.scenario import Scenario, read_scenario
from geomsim.team import place_team
from geomsim.watching import looks_every
from maps import GeomsimError, PlanError
from maps.texts import load_json
from planners import (
    Prediction,
    SearchGraph,
    TooLargeError,
    lower_bounds,
    predict,
    read_edge_list,
    unit_problem,
)

__all__ = ["ScenarioPrediction", "predict_scenario"]


@dataclass(frozen=True, slots=True)
class ScenarioPrediction:
    """What a team will achieve.

    Attributes
    ----------
    name : str
        Of the plan or graph.
    predictions : tuple of Prediction
        One for each start.
    bounds : tuple of float or None
        For each start what no team can beat; None where there are too many joint positions to tell.
    first : int
        The number that people give to the first cell: 1, or 0 in an edge list.
    unit : str
        Of the times: "s", or "steps" in an edge list.
    capture : {"cell", "sight"}
        What counts as capture.
    belief : {"cells", "places", "particles"}
        What it is computed by: the cell model, or the team's run in the world and a belief over places or particles.
    step : float
        From one value of a survival curve to the next, in that unit.
    scenario : dict
        What it depends on.
    """

    name: str
    predictions: tuple[Prediction, ...]
    bounds: tuple[float, ...] | None
    first: int
    unit: str
    capture: str
    belief: str
    step: float
    scenario: dict[str, Any]


def predict_scenario(path: Path | None, keys: dict[str, Any], *, everywhere: bool = False) -> ScenarioPrediction:
    """Predict a scenario.

    It is that of the cell model unless capture by sight is asked for.

    Parameters
    ----------
    path : Path or None
        A scenario file.
    keys : dict
        Keys of a scenario that override the file's; ``plan`` may name an edge list.
    everywhere : bool
        Whether to let the whole team start in each cell in turn, instead of in its start cells.

    Raises
    ------
    GeomsimError
        If the scenario cannot be read or predicted.
    """
    scenario = read_scenario(path, keys)
    asked = scenario.capture if "capture" in scenario.model_fields_set else "cell"
    capture = "sight" if "sight" in (asked, scenario.belief_capture) else "cell"
    if scenario.range_noise is not None:
        raise GeomsimError("What ranges robots will measure cannot be predicted: leave out range_noise.")
    if asked == "sight" and not is_edge_list(scenario.plan):
        return _by_sight(scenario, everywhere=everywhere)
    if is_edge_list(scenario.plan):
        if capture == "sight":
            raise GeomsimError(f"{scenario.plan} is an edge list, without walls: capture by sight needs a floor plan.")
        graph = read_edge_list(scenario.plan)
        if scenario.planner == "random":  # in unit time a wandering pursuer chooses as the evader does
            scenario = scenario.model_copy(update={"options": {"wait": True} | scenario.options})
        problem, first, name = unit_problem(graph, scenario.pursuers), 0, Path(scenario.plan).stem
        starts = _common(graph, scenario.pursuers) if everywhere else [_vertices(scenario, graph)]
    else:
        plan, cells = scenario.place()
        team = replace(scenario.team(), believes=capture)
        _, problem = believed_problem(cells, team, scenario.belief_motion(), scenario.belief_step)
        first, name = 1, plan.name
        graph = problem.graph
        common = [start for start in _common(graph, scenario.pursuers) if start[0] < len(cells)]
        starts = common if everywhere else [place_team(cells, team)]
    chance, reachable = np.random.default_rng(scenario.seed), first == 1
    predictions = predict(problem, scenario.method_of_planning(), starts, chance, reachable=reachable)
    try:
        bounds = lower_bounds(problem, starts, reachable=reachable)
    except TooLargeError:
        bounds = None
    unit = "steps" if first == 0 else "s"
    # of a plan's checkpoints only cells have numbers that people know
    numbered = len(graph) if first == 0 else len(cells)
    predictions = tuple(
        replace(p, paths=tuple(tuple(stop for stop in path if stop < numbered) for path in p.paths))
        for p in predictions
    )
    step = 1.0 if first == 0 else scenario.belief_step
    return ScenarioPrediction(name, predictions, bounds, first, unit, capture, "cells", step, scenario.as_dict())


def _by_sight(scenario: Scenario, *, everywhere: bool) -> ScenarioPrediction:
    from geomsim.sightprediction import predict_sight

    plan, cells = scenario.place()
    team, timing, motion = scenario.team(), scenario.timing(), scenario.belief_motion()
    starts = _common(SearchGraph.from_cells(cells), scenario.pursuers) if everywhere else [place_team(cells, team)]
    belief = "particles" if scenario.belief == "particles" else "places"
    planning = replace(team, believes=scenario.belief_capture) if belief == "particles" else team
    predictions = tuple(
        predict_sight(
            cells, planning, start, scenario.quarry(), motion, timing, scenario.seed, particles=belief == "particles"
        )
        for start in starts
    )
    _, problem = believed_problem(cells, replace(team, believes="places"), motion, timing.belief_step)
    bounds = lower_bounds(problem, starts, reachable=True)
    step = timing.physics_step * looks_every(timing.physics_step)
    return ScenarioPrediction(plan.name, predictions, bounds, 1, "s", "sight", belief, step, scenario.as_dict())


def is_edge_list(plan: str) -> bool:
    """Whether a plan is a JSON file that says it has vertices and edges."""
    path = Path(plan)
    if path.suffix != ".json" or not path.is_file():
        return False
    try:
        told = load_json(path, plan)
    except PlanError:
        return False
    return isinstance(told, dict) and "edges" in told


def _common(graph: SearchGraph, pursuers: int) -> list[tuple[int, ...]]:
    return [(int(cell),) * pursuers for cell in np.flatnonzero(graph.component == 0)]


def _vertices(scenario: Scenario, graph: SearchGraph) -> tuple[int, ...]:
    numbers = scenario.start or (0,)
    if len(numbers) not in (1, scenario.pursuers):
        raise GeomsimError(
            f"{len(numbers)} start vertices are given for {scenario.pursuers} pursuers: give one, or one each."
        )
    for number in numbers:
        if not 0 <= number < len(graph):
            raise GeomsimError(f"There is no vertex {number}: those of {scenario.plan} go from 0 to {len(graph) - 1}.")
    return tuple(numbers[k % len(numbers)] for k in range(scenario.pursuers))
