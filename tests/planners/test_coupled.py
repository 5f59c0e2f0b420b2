import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planners import (
    COSTS,
    AreaSpeedDegree,
    Coupled,
    Decoupled,
    Hops,
    PlannerError,
    PursuerState,
    SameCell,
    SearchGraph,
    SearchProblem,
    SearchState,
    find_cost,
    uniform_belief,
    unit_problem,
)


def walks(graph, cell, depth):
    if depth == 0:
        return [()]
    return [(n, *rest) for n in graph.neighbours(cell).tolist() for rest in walks(graph, n, depth - 1)]


def naive_cost(problem, belief, cells, paths, cost):
    """Eq. 8 for one joint path, step by step with full matrices; who has arrived stands still."""
    graph = problem.graph
    P = problem.motion.matrix(graph, 1.0).toarray()
    schedules = []
    for cell, path, speed in zip(cells, paths, problem.speeds, strict=True):
        looks, arrivals, at = [], {}, cell
        for target in path:
            edge = graph.edge(at, target)
            n = max(1, round(graph.length[edge] / speed))
            way = [k / n * graph.length[edge] for k in range(1, n + 1)]
            looks += [target if w >= graph.leave[edge] - 1e-9 else at for w in way]
            arrivals[len(looks)] = (target, graph.length[edge])
            at = target
        schedules.append((looks, arrivals))
    before = [belief] * len(cells)
    total = 0.0
    for t in range(1, max(len(looks) for looks, _ in schedules) + 1):
        belief = belief @ P
        for looks, _ in schedules:
            row = problem.capture.row(graph, looks[min(t, len(looks)) - 1])
            belief = np.concatenate([[belief[0] + belief[1:] @ row], belief[1:] * (1 - row)])
        for i, (_, arrivals) in enumerate(schedules):
            if t in arrivals:
                target, length = arrivals[t]
                chance = before[i][1:] @ problem.capture.row(graph, target)
                total += cost(Hops(before[i][None, 1:], belief[None, 1:], np.array([chance]), np.array([length])))[0]
                before[i] = belief
    return total


@pytest.mark.parametrize("name", COSTS)
@settings(max_examples=10)
@given(data=st.data(), depth=st.integers(1, 2))
def test_the_joint_path_is_the_best_of_all(graphs, name, data, depth):
    graph = data.draw(graphs(5).filter(lambda g: g.degree.any()))
    rng = np.random.default_rng(data.draw(st.integers(0, 99)))
    problem = SearchProblem(graph, AreaSpeedDegree(), SameCell(0.8), (1.0, 0.7))
    cells = [int(c) for c in rng.choice(np.flatnonzero(graph.degree), size=2)]
    belief = rng.dirichlet(np.ones(len(graph) + 1))
    state = SearchState(0.0, belief, tuple(PursuerState(c) for c in cells), ((), ()))
    decisions = Coupled(name, depth).solve(problem, rng).decide(state)
    joint = list(itertools.product(*(walks(graph, c, depth) for c in cells)))
    costs = {paths: naive_cost(problem, belief, cells, paths, find_cost(name)) for paths in joint}
    assert decisions[0].cost == pytest.approx(min(costs.values()), rel=1e-9)
    assert costs[tuple(d.path for d in decisions)] == pytest.approx(decisions[0].cost, rel=1e-9)


def test_one_robot_alone_decides_as_decoupled(metric_house):
    problem = SearchProblem(metric_house, AreaSpeedDegree(), SameCell(), (1.0,))
    state = SearchState(0.0, uniform_belief(metric_house, exclude=[3]), (PursuerState(3),), ((),))
    coupled, decoupled = (
        planner.solve(problem, np.random.default_rng(0)).decide(state)[0]
        for planner in (Coupled(depth=3), Decoupled(depth=3))
    )
    assert coupled.path == decoupled.path
    assert coupled.cost == pytest.approx(decoupled.cost)


def test_too_many_joint_paths_are_refused():
    problem = unit_problem(SearchGraph.from_edges(40, [(0, k) for k in range(1, 40)]), 4)
    state = SearchState(0.0, uniform_belief(problem.graph), (PursuerState(0),) * 4, ((),) * 4)
    with pytest.raises(PlannerError, match=r"depth 1 has 2\.31e\+06 joint paths for 4 pursuers"):
        Coupled().solve(problem, np.random.default_rng(0)).decide(state)
