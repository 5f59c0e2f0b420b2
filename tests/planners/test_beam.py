import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planners import (
    AreaSpeedDegree,
    Beam,
    PlannerError,
    SameCell,
    SearchGraph,
    SearchProblem,
    UniformMotion,
    predict,
    uniform_belief,
    unit_problem,
)
from planners.beam import BeamSearch
from planners.simulation import SearchModel


def uncaught(model, belief, moves, done, plans, steps):
    return model.foresee(belief, moves, done, plans, steps).sum(axis=1)


@settings(max_examples=25, deadline=None)
@given(data=st.data(), pursuers=st.integers(1, 2), horizon=st.integers(1, 4))
def test_a_beam_that_is_wide_enough_finds_the_best_plan(graphs, data, pursuers, horizon):
    graph = SearchGraph.from_edges(*edges_of(data.draw(graphs(5))))
    model = SearchModel(unit_problem(graph, pursuers))
    belief = np.random.default_rng(data.draw(st.integers(0, 99))).dirichlet(np.ones(len(graph) + 1))[1:]
    cells = data.draw(st.lists(st.integers(0, len(graph) - 1), min_size=pursuers, max_size=pursuers))
    moves = [model.move(c, c) for c in cells]
    search = BeamSearch(model, width=10**6, alike=10**6, horizon=horizon, residue=0.0)
    plan = search.run(belief, moves, [1] * pursuers)
    found = uncaught(model, belief, moves, [1] * pursuers, plan.moves, horizon)
    assert len(found) == horizon + 1

    def walks(cell, n):
        options = [cell, *graph.neighbours(cell).tolist()]
        return [(cell,)] if n == 0 else [(cell, *rest) for o in options for rest in walks(o, n - 1)]

    def judged(curve, rate):
        return curve[1:].sum() + rate * curve[-1]

    fall = np.log(belief.sum() / found[-1]) if found[-1] > 0 else np.inf
    rate = (plan.cost - found[1:].sum()) / found[-1] if found[-1] > 0 else 0.0
    assert rate >= 0
    assert fall >= 0
    for paths in itertools.product(*(walks(c, horizon) for c in cells)):
        chosen = [[model.move(a, b) for a, b in itertools.pairwise(path)] for path in paths]
        other = uncaught(model, belief, moves, [1] * pursuers, chosen, horizon)
        assert judged(found, rate) <= judged(other, rate) + 1e-9


def edges_of(graph):
    tail = np.repeat(np.arange(len(graph)), graph.degree)
    return len(graph), [(int(a), int(b)) for a, b in zip(tail, graph.indices, strict=True) if a < b]


@pytest.mark.parametrize("speeds", [(1.0,), (1.0, 1.0), (0.6, 1.7, 1.0)])
def test_the_cost_of_a_plan_is_what_it_achieves(metric_house, speeds):
    problem = SearchProblem(metric_house, AreaSpeedDegree(), SameCell(0.9), speeds)
    model = SearchModel(problem)
    belief = uniform_belief(metric_house, exclude=[0])[1:]
    moves, done = [model.move(0, 0)] * len(speeds), [1] * len(speeds)
    horizon = 60
    plan = BeamSearch(model, width=40, alike=2, horizon=horizon, residue=0.0).run(belief, moves, done)
    curve = uncaught(model, belief, moves, done, plan.moves, horizon)
    rate = horizon / np.log(curve[0] / curve[-1])
    assert plan.cost == pytest.approx(curve[1:].sum() + rate * curve[-1], rel=1e-6)


def test_what_was_announced_is_kept_if_nothing_better_is_found(metric_house):
    model = SearchModel(SearchProblem(metric_house, AreaSpeedDegree(), SameCell(), (1.0, 1.0)))
    belief = uniform_belief(metric_house, exclude=[0])[1:]
    moves, done = [model.move(0, 0)] * 2, [1, 1]
    good = BeamSearch(model, width=300, alike=3, horizon=60, residue=0.0).run(belief, moves, done)
    narrow = BeamSearch(model, width=1, alike=1, horizon=50, residue=0.0)

    def achieved(plan):
        return uncaught(model, belief, moves, done, plan.moves, 50)[1:].sum()

    assert achieved(narrow.run(belief, moves, done, good.moves)) == pytest.approx(achieved(good))
    assert achieved(narrow.run(belief, moves, done)) > achieved(good)


def test_searching_again_does_no_harm(house):
    problem = unit_problem(house, 2)
    once, often = (
        predict(problem, Beam(width=5, patience=patience), [(0, 0)], np.random.default_rng(0))[0].expected_time
        for patience in (100, 1)
    )
    assert often <= once + 1e-9


def test_more_robots_are_never_slower(metric_house):
    times = []
    for team in (1, 2, 3):
        problem = SearchProblem(metric_house, UniformMotion(), SameCell(), (1.0,) * team)
        (result,) = predict(problem, Beam(), [(0,) * team], np.random.default_rng(0))
        times.append(result.expected_time)
    assert times == sorted(times, reverse=True)


@pytest.mark.parametrize("name", ["width", "horizon", "patience", "alike"])
def test_bad_parameters_are_named(name):
    with pytest.raises(PlannerError, match=f"{name} must be at least 1; got 0"):
        Beam(**{name: 0})
