import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planners import (
    COSTS,
    AreaSpeedDegree,
    CostError,
    Coupled,
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
from planners.lookahead import LARGEST, grow_tree


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


def test_walks_are_counted(house):
    for cell in range(len(house)):
        assert house.count_walks(4)[cell] == len(walks(house, cell, 4))
    np.testing.assert_array_equal(SearchGraph.from_edges(3, [(1, 2)]).count_walks(7), [0, 1, 1])


def test_a_depth_of_too_many_paths_is_refused_with_the_largest_that_would_do(house):
    problem = SearchProblem(house, UniformMotion(), SameCell(), (1.0,))
    with pytest.raises(
        PlannerError, match=r"depth 50 has up to 4\.1e\+20 paths .* the largest depth that would do is"
    ) as caught:
        Decoupled(depth=50).solve(problem, np.random.default_rng(0))
    largest = int(str(caught.value).rstrip(".").split()[-1])
    counts = [house.count_walks(d).max() for d in (largest, largest + 1)]
    assert counts[0] * 9 <= LARGEST < counts[1] * 9
    Decoupled(depth=largest).solve(problem, np.random.default_rng(0))


def test_long_paths_of_which_there_are_few_are_searched():
    problem = SearchProblem(SearchGraph.from_edges(2, [(0, 1)]), UniformMotion(), SameCell(), (1.0,))
    state = SearchState(0.0, uniform_belief(problem.graph, exclude=[0]), (PursuerState(0),), ((),))
    for planner in (Decoupled(depth=100), Coupled(depth=100)):
        (decision,) = planner.solve(problem, np.random.default_rng(0)).decide(state)
        assert decision.path == (1, 0) * 50


def test_coupled_paths_are_counted_before_they_are_made(house):
    problem = SearchProblem(house, UniformMotion(), SameCell(), (1.0, 1.0))
    state = SearchState(0.0, uniform_belief(house, exclude=[0]), (PursuerState(0),) * 2, ((), ()))
    with pytest.raises(PlannerError, match=r"depth 60 has \S+e\+\d+ joint paths"):
        Coupled(depth=60).solve(problem, np.random.default_rng(0)).decide(state)


@settings(max_examples=20, deadline=None)
@given(data=st.data())
def test_what_the_others_leave_unseen_is_that_of_all_of_them(graphs, data):
    """Each pursuer plans with those before it as they have decided, and with those after it as they are."""
    graph = data.draw(graphs(7).filter(lambda g: g.degree.any()))
    rng = np.random.default_rng(data.draw(st.integers(0, 999)))
    problem = SearchProblem(graph, UniformMotion(), SameCell(0.7), (1.0, 0.7, 1.6, 0.4, 1.0), time_step=0.6)

    def pursuer():
        cell = int(rng.choice(np.flatnonzero(graph.degree)))
        target = int(rng.choice(graph.neighbours(cell)))
        return PursuerState(cell) if rng.random() < 0.6 else PursuerState(cell, target, 1.3)

    team = tuple(pursuer() for _ in problem.speeds)
    state = SearchState(0.0, rng.dirichlet(np.ones(len(graph) + 1)), team, ((),) * len(team))
    policy = Decoupled(depth=2).solve(problem, rng)
    decisions, now = policy.decide(state), list(team)
    for i, decision in enumerate(decisions):
        if decision is None:
            continue
        others = [policy.model.timeline(k, other) for k, other in enumerate(now) if k != i]
        unseen = policy.model.unseen(others)
        tree = grow_tree(policy.model, i, team[i].cell, state.belief[1:], unseen, policy.cost, 2)
        np.testing.assert_allclose(decision.cost, tree.costs[-1].min(), rtol=1e-9)
        move = policy.model.move(team[i].cell, decision.path[0])
        steps = float(policy.model.moves[i].steps[move])
        now[i] = PursuerState(team[i].cell, decision.path[0], steps * problem.time_step)


def test_a_thousand_pursuers_decide_in_time_that_grows_with_their_number(house, monkeypatch):
    looked = []
    model = type(Decoupled().solve(SearchProblem(house, UniformMotion(), SameCell(), (1.0,)), None).model)
    timeline = model.timeline
    monkeypatch.setattr(model, "timeline", lambda *given: looked.append(1) or timeline(*given))
    problem = SearchProblem(house, UniformMotion(), SameCell(), (1.0,) * 1000)
    state = SearchState(0.0, uniform_belief(house, exclude=[0]), (PursuerState(0),) * 1000, ((),) * 1000)
    decisions = Decoupled(depth=1).solve(problem, np.random.default_rng(0)).decide(state)
    assert len(decisions) == 1000
    assert len(looked) <= 2000
