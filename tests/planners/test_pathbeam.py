"""Responses by beam search, against the best there are."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planners import AreaSpeedDegree, BestResponse, PlannerError, SameCell, SearchGraph, SearchProblem, check_policy
from planners.branching import JointSearch
from planners.horizon import respond
from planners.pathbeam import PathBeam
from planners.simulation import SearchModel


def problem(graph: SearchGraph, pursuers: int = 2, detection: float = 0.7) -> SearchProblem:
    return SearchProblem(graph, AreaSpeedDegree(1.0), SameCell(detection), (1.0,) * pursuers, 1.0)


def at(model: SearchModel, cells: list[int]) -> tuple[list[int], list[int]]:
    return [model.move(cell, cell) for cell in cells], [1] * len(cells)


def test_one_pursuers_answer_is_the_best_there_is(metric_house: SearchGraph) -> None:
    """With room for every path, of which few come to the same cell within three steps."""
    model = SearchModel(problem(metric_house, 1))
    belief = problem(metric_house, 1).first_belief([0])[1:]
    exact = JointSearch(model, horizon=14, discount=0.95)
    beam = PathBeam(model, horizon=14, discount=0.95, width=60)
    moves, done = at(model, [0])
    best = exact.run(belief, moves, done, [()]).value
    found = beam.respond(belief, moves, done, [()], rounds=3)
    assert exact.value(belief, moves, done, found) == pytest.approx(best, rel=0.02)
    assert exact.value(belief, moves, done, found) <= best * (1 + 1e-9)


@settings(max_examples=25)
@given(data=st.data())
def test_answers_never_make_a_plan_worse(
    graphs: Callable[[int], st.SearchStrategy[SearchGraph]], data: st.DataObject
) -> None:
    graph = data.draw(graphs(7))
    model = SearchModel(problem(graph))
    cells = [data.draw(st.integers(0, len(graph) - 1)) for _ in range(2)]
    moves, done = at(model, cells)
    belief = np.full(len(graph), 1 / len(graph))
    search = JointSearch(model, horizon=9, discount=1.0)
    beam = PathBeam(model, horizon=9, discount=1.0, width=3)
    found = beam.respond(belief, moves, done, [(), ()], rounds=0)
    better = beam.respond(belief, moves, done, found, rounds=5)
    values = [search.value(belief, moves, done, plan) for plan in (found, better)]
    assert 0 <= values[0] <= values[1] * (1 + 1e-9)


def test_the_team_is_nearly_as_good_as_with_exact_answers(metric_house: SearchGraph) -> None:
    model = SearchModel(problem(metric_house))
    belief = problem(metric_house).first_belief([0, 4])[1:]
    search = JointSearch(model, horizon=12, discount=1.0)
    moves, done = at(model, [0, 4])
    exact = search.value(belief, moves, done, respond(search, belief, moves, done, ((), ()), rounds=5))
    found = PathBeam(model, horizon=12, discount=1.0, width=8).respond(belief, moves, done, [(), ()], rounds=5)
    assert search.value(belief, moves, done, found) >= 0.97 * exact


def test_a_pursuer_under_way_ends_its_hop_first(metric_house: SearchGraph) -> None:
    model = SearchModel(problem(metric_house))
    go = model.move(0, int(metric_house.neighbours(0)[0]))
    beam = PathBeam(model, horizon=3, discount=1.0, width=4)
    belief = np.full(len(metric_house), 1 / len(metric_house))
    steps = int(model.moves[0].steps[go])
    assert steps > 3
    plans = beam.respond(belief, [go, model.move(4, 4)], [0, 1], [(), ()], rounds=2)
    assert len(plans[0]) == 0
    assert len(plans[1]) > 0


def test_it_keeps_the_rules_of_policies(metric_house: SearchGraph) -> None:
    check_policy(BestResponse(horizon=8, width=4), problem(metric_house, 3), np.random.default_rng(2))


def test_widths_that_cannot_be() -> None:
    with pytest.raises(PlannerError, match="width"):
        BestResponse(width=-1)
