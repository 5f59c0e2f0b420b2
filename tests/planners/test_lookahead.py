import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planners import (
    COSTS,
    AreaSpeedDegree,
    CostError,
    Decoupled,
    Hops,
    PlannerError,
    PursuerState,
    SameCell,
    SearchGraph,
    SearchProblem,
    SearchState,
    UniformMotion,
    find_cost,
    uniform_belief,
)


def walks(graph, cell, depth):
    """All walks of a length, one after another, as Algorithm 1 has it."""
    if depth == 0:
        return [()]
    return [(n, *rest) for n in graph.neighbours(cell).tolist() for rest in walks(graph, n, depth - 1)]


def naive_cost(problem, state, pursuer, path, cost):
    """Eq. 8 for one path, with full capture matrices, one belief step after another."""
    graph, step = problem.graph, problem.time_step
    transition = problem.motion.matrix(graph, step).toarray()

    def capture(cell):
        matrix = np.diag(np.concatenate([[1.0], 1.0 - problem.capture.row(graph, cell)]))
        matrix[1:, 0] = problem.capture.row(graph, cell)
        return matrix

    def hop_cells(cell, target, speed):
        edge = graph.edge(cell, target)
        n = max(1, round(graph.length[edge] / speed / step))
        return [target if k / n * graph.length[edge] >= graph.leave[edge] - 1e-9 else cell for k in range(1, n + 1)]

    others = []
    for k, other in enumerate(state.pursuers):
        if k == pursuer:
            continue
        if other.target is None:
            others.append([other.cell])
        elif other.target == other.cell:
            others.append([other.cell] * 99)
        else:
            cells = hop_cells(other.cell, other.target, problem.speeds[k])
            others.append(cells[max(0, len(cells) - max(1, round(other.time_left / step))) :])
    total, clock, belief, cell = 0.0, 0, state.belief, state.pursuers[pursuer].cell
    for target in path:
        before = belief
        for own in hop_cells(cell, target, problem.speeds[pursuer]):
            belief = belief @ transition @ capture(own)
            for other in others:
                belief = belief @ capture(other[min(clock, len(other) - 1)])
            clock += 1
        chance = before[1:] @ problem.capture.row(graph, target)
        length = graph.length[graph.edge(cell, target)]
        total += cost(Hops(before[None, 1:], belief[None, 1:], np.array([chance]), np.array([length])))[0]
        cell = target
    return total


@pytest.mark.parametrize("name", COSTS)
@settings(max_examples=20, deadline=None)
@given(data=st.data(), depth=st.integers(1, 3), detection=st.sampled_from([1.0, 0.6]))
def test_the_path_is_the_best_of_all_by_a_literal_algorithm_1(graphs, name, data, depth, detection):
    graph = data.draw(graphs(7).filter(lambda g: g.degree.any()))
    rng = np.random.default_rng(data.draw(st.integers(0, 999)))
    speeds = (1.0, 0.7, 1.6)
    problem = SearchProblem(graph, AreaSpeedDegree(), SameCell(detection), speeds, time_step=0.8)
    cell, standing, start = (int(c) for c in rng.choice(np.flatnonzero(graph.degree), size=3))
    target = int(rng.choice(graph.neighbours(start)))
    team = (PursuerState(cell), PursuerState(start, target, 1.3), PursuerState(standing, standing, 0.9))
    state = SearchState(0.0, rng.dirichlet(np.ones(len(graph) + 1)), team, ((), (), ()))
    decision, *rest = Decoupled(name, depth).solve(problem, rng).decide(state)
    assert rest == [None, None]
    cost = find_cost(name)
    by_path = {path: naive_cost(problem, state, 0, path, cost) for path in walks(graph, cell, depth)}
    np.testing.assert_allclose(decision.cost, min(by_path.values()), rtol=1e-9)
    np.testing.assert_allclose(by_path[decision.path], decision.cost, rtol=1e-9)


def test_many_states_are_searched_by_sparse_products_with_the_same_result(monkeypatch, metric_house):
    problem = SearchProblem(metric_house, AreaSpeedDegree(), SameCell(), (1.0, 1.0))
    state = SearchState(0.0, uniform_belief(metric_house), (PursuerState(0), PursuerState(4)), ((), ()))
    dense = Decoupled(depth=4).solve(problem, np.random.default_rng(0)).decide(state)
    monkeypatch.setattr("planners.simulation.DENSE_STATES", 0)
    sparse = Decoupled(depth=4).solve(problem, np.random.default_rng(0)).decide(state)
    assert [d.path for d in sparse] == [d.path for d in dense]
    np.testing.assert_allclose([d.cost for d in sparse], [d.cost for d in dense], rtol=1e-12)


def star(leaves):
    return SearchGraph.from_edges(leaves + 1, [(0, k) for k in range(1, leaves + 1)])


@pytest.mark.parametrize("cost", COSTS)
@pytest.mark.parametrize("seed", range(5))
def test_two_robots_in_one_place_part_ways(cost, seed):
    graph = star(4)
    problem = SearchProblem(graph, UniformMotion(), SameCell(), (1.0, 1.0))
    state = SearchState(0.0, uniform_belief(graph, exclude=[0]), (PursuerState(0),) * 2, ((), ()))
    first, second = Decoupled(cost, 1).solve(problem, np.random.default_rng(seed)).decide(state)
    assert first.path != second.path


def test_ties_fall_to_every_side():
    problem = SearchProblem(star(3), UniformMotion(), SameCell(), (1.0,))
    state = SearchState(0.0, uniform_belief(problem.graph, exclude=[0]), (PursuerState(0),), ((),))
    policy = Decoupled(depth=1).solve(problem, np.random.default_rng(0))
    assert {policy.decide(state)[0].path for _ in range(50)} == {(1,), (2,), (3,)}


def test_a_robot_shut_in_stays():
    graph = SearchGraph.from_edges(3, [(1, 2)])
    problem = SearchProblem(graph, UniformMotion(), SameCell(), (1.0,))
    state = SearchState(0.0, uniform_belief(graph), (PursuerState(0),), ((),))
    (decision,) = Decoupled().solve(problem, np.random.default_rng(0)).decide(state)
    assert decision.path == (0,)


def test_bad_parameters_are_named():
    with pytest.raises(PlannerError, match="at least 1; got 0"):
        Decoupled(depth=0)
    with pytest.raises(CostError, match="no cost heuristic 'x'"):
        Decoupled(cost="x")
