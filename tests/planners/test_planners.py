import dataclasses
import time

import numpy as np
import pytest

from planners import (
    COSTS,
    PLANNERS,
    AreaSpeedDegree,
    ConformanceError,
    CostError,
    Coupled,
    Decision,
    Decoupled,
    Planner,
    PlannerError,
    PursuerState,
    Random,
    SameCell,
    SearchGraph,
    SearchProblem,
    SearchState,
    Stationary,
    StationaryMotion,
    UniformMotion,
    check_policy,
    make_planner,
    parse_method,
    uniform_belief,
    unit_problem,
)


def problems():
    house = [(0, 3), (0, 7), (1, 7), (1, 8), (2, 3), (3, 4), (3, 5), (3, 8), (4, 6), (5, 6)]
    unit = SearchGraph.from_edges(9, house)
    legs = np.random.default_rng(1).uniform(0.5, 4.0, (len(house), 2))
    metric = SearchGraph._build(house, legs, np.linspace(4.0, 40.0, 9), unit.component)
    split = SearchGraph.from_edges(6, [(0, 1), (1, 2), (3, 4)])
    yield pytest.param(SearchProblem(unit, UniformMotion(), SameCell(), (1.0, 1.0)), id="unit times")
    yield pytest.param(SearchProblem(metric, AreaSpeedDegree(), SameCell(0.7), (1.0, 0.5, 2.0)), id="metres")
    yield pytest.param(SearchProblem(metric, StationaryMotion(), SameCell(), (1.0,), 0.5), id="still evader")
    yield pytest.param(SearchProblem(split, UniformMotion(), SameCell(), (1.0, 1.0)), id="three components")


def planners():
    for name, entry in PLANNERS.items():
        limits = {"horizon": 12} if "horizon" in entry.parameters else {}
        yield pytest.param(entry.make(**limits), id=name)
        if "cost" in entry.parameters:
            yield from (pytest.param(entry.make(cost=cost), id=f"{name} {cost}") for cost in COSTS)
        if "depth" in entry.parameters:
            yield from (pytest.param(entry.make(depth=depth), id=f"{name} {depth}") for depth in (1, 3))


@pytest.mark.parametrize("problem", list(problems()))
@pytest.mark.parametrize("planner", list(planners()))
def test_every_planner_keeps_the_rules(planner, problem):
    check_policy(planner, problem, np.random.default_rng(3))


@dataclasses.dataclass
class Broken:
    """A planner made from a function of the state, the problem and a counter that outlives the policy."""

    decide_with: object
    calls: int = 0

    def solve(self, problem, _):
        outer = self

        class Policy:
            def decide(self, state):
                outer.calls += 1
                return outer.decide_with(state, problem.graph, outer.calls)

        return Policy()


def neighbours(state, graph, k):
    return [
        Decision((int(graph.neighbours(p.cell)[k % len(graph.neighbours(p.cell))]),)) if p.target is None else None
        for p in state.pursuers
    ]


def disturb(state, graph, calls):
    state.belief[0] = 0.0
    return neighbours(state, graph, 0)


@pytest.mark.parametrize(
    ("decide", "message"),
    [
        (lambda s, g, _: neighbours(s, g, 0)[:-1], "1 decisions for 2 pursuers"),
        (lambda s, *_: [None] * len(s.pursuers), "must decide for those at a checkpoint"),
        (lambda s, *_: [Decision(())] * len(s.pursuers), "empty path|must decide"),
        (lambda s, *_: [Decision(((p.cell + 4) % 9,)) for p in s.pursuers], "no neighbour"),
        (disturb, "changes the state"),
        (neighbours, "decides differently"),
    ],
)
def test_broken_rules_are_found(house, decide, message):
    problem = SearchProblem(house, UniformMotion(), SameCell(), (1.0, 1.0))
    with pytest.raises(ConformanceError, match=message):
        check_policy(Broken(decide), problem, np.random.default_rng(0), rounds=9)


def test_what_is_no_planner_is_refused(house):
    problem = SearchProblem(house, UniformMotion(), SameCell(), (1.0,))
    with pytest.raises(ConformanceError, match="has no method solve"):
        check_policy(object(), problem, np.random.default_rng(0))


@pytest.mark.parametrize("name", PLANNERS)
def test_every_planner_is_made_by_its_name_and_describes_itself(name):
    planner = make_planner(name, cost=None, depth=None)
    assert isinstance(planner, Planner)
    assert planner == PLANNERS[name].make()
    assert PLANNERS[name].summary
    assert PLANNERS[name].source


def test_parameters_reach_the_planner():
    planner = make_planner("decoupled", cost="target-probability", depth=2)
    assert (planner.cost, planner.depth) == ("target-probability", 2)
    assert make_planner("random") == Random()
    assert make_planner("stationary") == Stationary()


@pytest.mark.parametrize(
    ("name", "parameters", "error", "message"),
    [
        ("decupled", {}, PlannerError, "no planner 'decupled'; did you mean 'decoupled'"),
        ("stationary", {"depth": 3}, PlannerError, "'stationary' takes no parameter; got depth = 3"),
        ("decoupled", {"beam": 3}, PlannerError, "takes cost, depth and seconds; got beam = 3"),
        ("decoupled", {"depth": 0}, PlannerError, "at least 1; got 0"),
        ("decoupled", {"cost": "entropie"}, CostError, "did you mean 'entropy'"),
    ],
)
def test_bad_choices_are_named(name, parameters, error, message):
    with pytest.raises(error, match=message):
        make_planner(name, **parameters)


@pytest.mark.parametrize(
    ("method", "planner"),
    [
        ("stationary", Stationary()),
        ("decoupled", Decoupled()),
        ("decoupled-entropy-5", Decoupled("entropy", 5)),
        ("decoupled-target-probability", Decoupled("target-probability")),
        ("decoupled-3", Decoupled(depth=3)),
        ("coupled-distance-over-probability-1", Coupled("distance-over-probability", 1)),
        ("branch-and-bound", PLANNERS["branch-and-bound"].make()),
    ],
)
def test_a_method_is_made_from_one_name(method, planner):
    assert parse_method(method) == planner


@pytest.mark.parametrize(
    ("method", "error", "message"),
    [
        ("decoupel", PlannerError, "no method 'decoupel'; did you mean 'decoupled'"),
        ("decoupled-entropie-5", CostError, "no cost heuristic 'entropie'; did you mean 'entropy'"),
        ("decoupled-entropy-0", PlannerError, "at least 1; got 0"),
        ("stationary-entropy", PlannerError, "'stationary' takes no parameter; got cost = 'entropy'"),
    ],
)
def test_a_bad_method_is_named(method, error, message):
    with pytest.raises(error, match=message):
        parse_method(method)


@pytest.mark.parametrize("name", [name for name, entry in PLANNERS.items() if "seconds" in entry.parameters])
@pytest.mark.parametrize("problem", list(problems()))
def test_a_planner_without_time_still_decides_by_the_rules(name, problem):
    check_policy(make_planner(name, seconds=0.0), problem, np.random.default_rng(3))


def test_a_planner_ends_near_its_time():
    pairs = [(k, k + 1) for k in range(199)] + [(k, k + 20) for k in range(0, 180, 3)]
    problem = unit_problem(SearchGraph.from_edges(200, pairs), 3)
    state = SearchState(0.0, uniform_belief(problem.graph, exclude=[0]), (PursuerState(0),) * 3, ((),) * 3)
    for name, limits in [("decoupled", {"depth": 9}), ("beam", {"width": 3000}), ("rollout", {}), ("refined", {})]:
        policy = make_planner(name, seconds=0.05, **limits).solve(problem, np.random.default_rng(0))
        policy.decide(state)
        policy = make_planner(name, seconds=0.05, **limits).solve(problem, np.random.default_rng(0))
        begun = time.process_time()
        policy.decide(state)
        # Without a limit each of these takes seconds.
        assert time.process_time() - begun < 0.5
