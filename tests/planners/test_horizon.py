import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planners import (
    AreaSpeedDegree,
    BestResponse,
    BranchAndBound,
    PlannerError,
    PursuerState,
    SameCell,
    SearchProblem,
    SearchState,
    Sequential,
    uniform_belief,
)
from planners.branching import JointSearch
from planners.horizon import respond
from planners.simulation import SearchModel


def all_plans(model, pursuer, cell, steps):
    """Every sequence of moves that lasts for the horizon."""
    moves = model.moves[pursuer]
    if steps <= 0:
        return [()]
    options = range(moves.start[cell], moves.start[cell + 1])
    return [
        (m, *rest) for m in options for rest in all_plans(model, pursuer, int(moves.target[m]), steps - moves.steps[m])
    ]


def discounted(model, belief, moves, done, plans, horizon, discount):
    """The value by its definition: sum of discount^t p0(t)."""
    left = model.foresee(belief, moves, done, plans, horizon).sum(axis=1)
    return sum(discount**t * (left[0] - left[t]) for t in range(1, horizon + 1))


@settings(max_examples=40)
@given(
    data=st.data(),
    speeds=st.sampled_from([(3.0,), (3.0, 3.0), (3.0, 2.0)]),
    horizon=st.integers(1, 4),
    detection=st.sampled_from([1.0, 0.6]),
)
def test_branch_and_bound_is_the_best_of_all_joint_plans(graphs, data, speeds, horizon, detection):
    graph = data.draw(graphs(5))
    model = SearchModel(SearchProblem(graph, AreaSpeedDegree(), SameCell(detection), speeds))
    rng = np.random.default_rng(data.draw(st.integers(0, 99)))
    belief = rng.dirichlet(np.ones(len(graph) + 1))[1:]
    cells = rng.integers(len(graph), size=len(speeds))
    moves, done = [model.move(int(c), int(c)) for c in cells], [1] * len(speeds)
    ways = graph.neighbours(int(cells[0]))
    if len(ways) and data.draw(st.booleans()):
        moves[0], done[0] = model.move(int(cells[0]), int(ways[0])), 0
    search = JointSearch(model, horizon=horizon, discount=0.9)
    found = search.run(belief, moves, done, [()] * len(speeds))
    rests = [horizon - int(t.steps[m]) + d for t, m, d in zip(model.moves, moves, done, strict=True)]
    targets = [int(t.target[m]) for t, m in zip(model.moves, moves, strict=True)]
    options = [all_plans(model, i, c, r) for i, (c, r) in enumerate(zip(targets, rests, strict=True))]
    best = max(discounted(model, belief, moves, done, p, horizon, 0.9) for p in itertools.product(*options))
    assert found.value == pytest.approx(best, rel=1e-9, abs=1e-12)
    assert found.gap == pytest.approx(0.0, abs=1e-9)
    achieved = discounted(model, belief, moves, done, search.fill(moves, found.moves), horizon, 0.9)
    assert achieved == pytest.approx(found.value, rel=1e-9, abs=1e-12)
    # Ended at once, it still proves a bound.
    early = search.run(belief, moves, done, [()] * len(speeds), nodes=1)
    assert early.value <= best + 1e-12
    assert early.bound >= best - 1e-9
    # Best responses cannot be better, nor worse than sequential allocation.
    sequential, answered = (respond(search, belief, moves, done, (), rounds=n) for n in (0, 5))
    low, high = (search.value(belief, moves, done, p) for p in (sequential, answered))
    assert best / 2 - 1e-12 <= low <= high + 1e-12 <= best + 1e-9


def test_a_response_is_the_best_one_and_what_was_announced_competes(house):
    model = SearchModel(SearchProblem(house, AreaSpeedDegree(), SameCell(), (1.0, 1.0)))
    belief = uniform_belief(house, exclude=[3])[1:]
    moves, done = [model.move(3, 3)] * 2, [1, 1]
    search = JointSearch(model, horizon=6, discount=1.0)
    best = search.run(belief, moves, done, [(), ()])
    again = respond(search, belief, moves, done, best.moves, rounds=3)
    assert search.value(belief, moves, done, again) == pytest.approx(best.value)


def test_the_certificate_is_kept(house):
    problem = SearchProblem(house, AreaSpeedDegree(), SameCell(), (1.0, 1.0))
    policy = BranchAndBound(horizon=5).solve(problem, np.random.default_rng(0))
    assert policy.certificate is None
    state = SearchState(0.0, uniform_belief(house), (PursuerState(0), PursuerState(0)), ((), ()))
    policy.decide(state)
    assert policy.certificate.gap == 0.0
    assert policy.certificate.value <= policy.certificate.bound + 1e-12
    assert policy.certificate.nodes > 0


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Sequential(horizon=0), "horizon must be at least 1; got 0"),
        (lambda: BestResponse(rounds=0), "rounds must be at least 1; got 0"),
        (lambda: BranchAndBound(seconds=-1.0), r"seconds must be at least 0; got -1\.0"),
        (lambda: BranchAndBound(discount=float("nan")), "discount must be at least 0; got nan"),
    ],
)
def test_bad_parameters_are_named(make, message):
    with pytest.raises(PlannerError, match=message):
        make()
