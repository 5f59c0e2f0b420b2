import itertools
import json
from pathlib import Path

import numpy as np
import pytest

from planners import (
    AreaSpeedDegree,
    Beam,
    Decision,
    Decoupled,
    GraphError,
    Random,
    SameCell,
    SearchGraph,
    SearchProblem,
    Stationary,
    TooLargeError,
    UniformMotion,
    lower_bounds,
    point_belief,
    predict,
    read_edge_list,
    uniform_belief,
    unit_problem,
)

GRAPHS = Path(__file__).parents[3] / "shared" / "graphs"

published = pytest.mark.skipif(not GRAPHS.is_dir(), reason="the published graphs are not here")


def mean_time(predictions):
    return np.mean([p.expected_time for p in predictions])


def published_problem(name):
    graph = read_edge_list(GRAPHS / f"{name}.json")
    return unit_problem(graph, 2), [(cell, cell) for cell in range(len(graph))]


@published
@pytest.mark.parametrize(
    ("name", "planner", "steps"),
    [
        ("office-60", Stationary(), 296.24),
        ("museum-70", Stationary(), 404.77),
        pytest.param("office-60", Random(wait=True), 56.80, marks=pytest.mark.slow),
        pytest.param("museum-70", Random(wait=True), 92.61, marks=pytest.mark.slow),
    ],
)
def test_exact_figures_of_the_published_graphs(name, planner, steps):
    problem, starts = published_problem(name)
    assert mean_time(predict(problem, planner, starts, np.random.default_rng(0))) == pytest.approx(steps, rel=1e-4)


@pytest.mark.parametrize("planner", [Stationary(), Decoupled(depth=2), Beam(width=10)], ids=repr)
def test_two_rooms_by_hand(planner):
    # The evader stays or moves with probability 1/2 each; the pursuer cannot do better or worse than 1/2 a step if it
    # stands: E[T] = 1 + 1/2 + 1/4 + ... = 2. If it goes over, it misses an evader that crosses, and no sooner meets it.
    problem = unit_problem(SearchGraph.from_edges(2, [(0, 1)]), 1)
    (result,) = predict(problem, planner, [(0,)], np.random.default_rng(0))
    assert result.expected_time == pytest.approx(2.0, abs=1e-6)
    np.testing.assert_allclose(result.survival[:5], [1, 1 / 2, 1 / 4, 1 / 8, 1 / 16])


def dense_chain(problem, team_walks, belief):
    """Expected time of a wandering team by the full joint transition matrix."""
    n = len(problem.graph)
    P = problem.motion.matrix(problem.graph, problem.time_step).toarray()[1:, 1:]
    joint = np.eye(1)
    for walk in team_walks:
        joint = np.kron(joint, walk)
    joint = np.kron(joint, P)
    states = list(itertools.product(range(n), repeat=len(team_walks) + 1))
    free = np.array([s[-1] not in s[:-1] for s in states])
    times = np.linalg.solve(np.eye(len(states)) - joint * free[None, :], np.ones(len(states)))
    return lambda team: sum(belief[e + 1] * times[states.index((*team, e))] for e in range(n))


@pytest.mark.parametrize("wait", [True, False])
def test_a_wandering_team_is_the_joint_chain(house, wait):
    problem = unit_problem(house, 2)
    P = UniformMotion().matrix(house, 1.0).toarray()[1:, 1:]
    walk = P if wait else (P * (1 - np.eye(9))) / (P * (1 - np.eye(9))).sum(axis=1, keepdims=True)
    belief = uniform_belief(house, exclude=[3, 6])
    expected = dense_chain(problem, [walk, walk], belief)((3, 6))
    (result,) = predict(problem, Random(wait=wait), [(3, 6)], np.random.default_rng(0))
    assert result.expected_time == pytest.approx(expected, rel=1e-8)
    assert result.survival[0] == pytest.approx(1.0)
    assert (np.diff(result.survival) <= 1e-12).all()


def test_a_wandering_team_on_ways_of_different_length_agrees_with_simulation(metric_house):
    problem = SearchProblem(metric_house, AreaSpeedDegree(), SameCell(), (1.0,))
    (exact,) = predict(problem, Random(), [(0,)], np.random.default_rng(0))

    class Wanderer:
        """The same as a policy that draws; so it is run, not solved."""

        def solve(self, problem, rng):
            return Random().solve(problem, rng)

    runs = 100
    rng = np.random.default_rng(1)
    times = [predict(problem, Wanderer(), [(0,)], rng, residue=1e-3)[0].expected_time for _ in range(runs)]
    # Five standard errors: a false alarm once in a million seeds.
    assert abs(np.mean(times) - exact.expected_time) < 5 * np.std(times) / np.sqrt(runs)


@pytest.mark.parametrize("planner", [Stationary(), Random(wait=True), Decoupled(depth=3), Beam(width=20)], ids=repr)
def test_no_planner_beats_the_bound(house, planner):
    problem = unit_problem(house, 2)
    starts = [(0, 0), (3, 8), (6, 2)]
    for bound, result in zip(
        lower_bounds(problem, starts), predict(problem, planner, starts, np.random.default_rng(0)), strict=True
    ):
        assert 1.0 <= bound <= result.expected_time


@pytest.mark.parametrize("speeds", [(1.0,), (1.0, 0.5), (1.0, 1.0, 2.0)])
def test_the_bound_for_large_problems_is_a_bound(metric_house, speeds, monkeypatch):
    problem = SearchProblem(metric_house, AreaSpeedDegree(), SameCell(0.9), speeds)
    starts = [(0,) * len(speeds), (3, 8, 6)[: len(speeds)]]
    exact = lower_bounds(problem, starts) if len(speeds) < 3 else None
    monkeypatch.setattr("planners.evaluation.LARGEST_BOUND", 10)
    loose = lower_bounds(problem, starts)
    best = predict(problem, Beam(width=100), starts, np.random.default_rng(0))
    for k, result in enumerate(best):
        assert 1.0 <= loose[k] <= (result.expected_time if exact is None else exact[k] + 1e-6)
        if exact is not None:
            assert exact[k] <= result.expected_time
    if len(speeds) == 1:
        assert loose == pytest.approx(exact, rel=0.1)


def test_the_bound_of_a_chase_by_hand():
    # A path of three cells, pursuer in the middle, evader known to stay with 1/2 or come with 1/2: caught at once.
    problem = unit_problem(SearchGraph.from_edges(3, [(0, 1), (1, 2)]), 1)
    assert lower_bounds(problem, [(1,)]) == pytest.approx([1.0])
    # From the end the evader at the other end is one step off with 1/2, and then caught, or the pursuer is next to it.
    assert lower_bounds(problem, [(0,)], point_belief(problem.graph, 2)) == pytest.approx([1.5])


def test_the_plan_is_what_was_gone_and_decisions_are_kept(house):
    problem = unit_problem(house, 1)

    class Round:
        """Goes round the cycle 4-5-7-6."""

        def solve(self, *_):
            following = {3: 4, 4: 6, 6: 5, 5: 3}

            class Policy:
                def decide(self, state):
                    return [Decision((following[p.cell],)) for p in state.pursuers]

            return Policy()

    (result,) = predict(problem, Round(), [(3,)], np.random.default_rng(0))
    assert result.paths[0][:6] == (4, 6, 5, 3, 4, 6)
    free = uniform_belief(house, exclude=[3])[1:]
    P = UniformMotion().matrix(house, 1.0).toarray()[1:, 1:]
    for t, cell in enumerate(result.paths[0][:50]):
        free = free @ P
        free[cell] = 0.0
        assert result.survival[t + 1] == pytest.approx(free.sum())


@pytest.mark.parametrize(
    ("start", "message"),
    [
        ((0, 9), "names cell 10; cells are numbered from 1 to 9"),
        ((0, -1), "names cell 0"),
        ((0,), "names 1 cells; there are 2 pursuers"),
    ],
)
def test_bad_starts_are_named(house, start, message):
    with pytest.raises(GraphError, match=message):
        predict(unit_problem(house, 2), Stationary(), [start], np.random.default_rng(0))


def test_an_evader_on_the_other_side_is_named():
    problem = unit_problem(SearchGraph.from_edges(4, [(0, 1), (2, 3)]), 1)
    with pytest.raises(GraphError, match="may be in cell 3, which no pursuer can reach"):
        predict(problem, Decoupled(), [(0,)], np.random.default_rng(0))


def test_a_chain_that_is_too_large_is_refused():
    graph = SearchGraph.from_edges(300, [(k, k + 1) for k in range(299)])
    with pytest.raises(TooLargeError, match=r"2.7e\+07 joint positions"):
        predict(unit_problem(graph, 2), Random(), [(0, 0)], np.random.default_rng(0))


def test_an_edge_list_is_read(tmp_path):
    path = tmp_path / "g.json"
    path.write_text(json.dumps({"name": "triangle", "vertices": 3, "edges": [[0, 1], [1, 2], [2, 0]]}))
    graph = read_edge_list(path)
    assert len(graph) == 3
    np.testing.assert_array_equal(graph.degree, [2, 2, 2])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "not valid JSON"),
        ("[]", "must hold an object"),
        ('{"edges": []}', "'vertices' must be a whole number above 0; got None"),
        ('{"vertices": true, "edges": []}', "got True"),
        ('{"vertices": 2, "edges": 3}', "'edges' must be a list of pairs; got 3"),
        ('{"vertices": 2, "edges": [[0, 1], [0]]}', r"edges\[1\] must be a pair of whole numbers; got \[0\]"),
        ('{"vertices": 2, "edges": [[0, 0.5]]}', r"edges\[0\] must be"),
        ('{"vertices": 2, "edges": [[0, 2]]}', r"g.json: Edge \(0, 2\) names a vertex outside 0 to 1"),
        ('{"vertices": 2, "edges": [[0, 1], [1, 0]]}', "twice"),
        ('{"vertices": 2, "edges": [[1, 1]]}', "to itself"),
    ],
)
def test_a_bad_edge_list_is_named(tmp_path, text, message):
    path = tmp_path / "g.json"
    path.write_text(text)
    with pytest.raises(GraphError, match=message):
        read_edge_list(path)


def test_a_missing_edge_list_is_named(tmp_path):
    with pytest.raises(GraphError, match=r"none\.json: the file cannot be read"):
        read_edge_list(tmp_path / "none.json")


def test_an_edge_list_may_begin_with_a_byte_order_mark(tmp_path):
    path = tmp_path / "g.json"
    path.write_bytes(b"\xef\xbb\xbf" + b'{"vertices": 2, "edges": [[0, 1]]}')
    assert len(read_edge_list(path)) == 2
