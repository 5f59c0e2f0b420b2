"""Two robots that start in one place part ways, also where everything around them is symmetrical."""

import numpy as np
import pytest

from planners import (
    PLANNERS,
    PursuerState,
    SameCell,
    SearchGraph,
    SearchProblem,
    SearchState,
    UniformMotion,
    uniform_belief,
)

GRAPHS = {
    "ring": SearchGraph.from_edges(8, [(k, (k + 1) % 8) for k in range(8)]),
    "three arms": SearchGraph.from_edges(7, [(0, 1), (1, 2), (0, 3), (3, 4), (0, 5), (5, 6)]),
}
SEARCHING = [name for name in PLANNERS if name not in ("random", "stationary")]


def first_moves(name: str, graph: SearchGraph, seed: int) -> tuple[int, ...]:
    problem = SearchProblem(graph, UniformMotion(), SameCell(), (1.0, 1.0))
    policy = PLANNERS[name].make().solve(problem, np.random.default_rng(seed))
    here = (PursuerState(0), PursuerState(0))
    decisions = policy.decide(SearchState(0.0, uniform_belief(graph, exclude=[0]), here, ((), ())))
    return tuple(decision.path[0] for decision in decisions)


@pytest.mark.parametrize("graph", GRAPHS.values(), ids=GRAPHS)
@pytest.mark.parametrize("name", SEARCHING)
def test_two_robots_in_one_place_part_ways(name: str, graph: SearchGraph) -> None:
    for seed in range(4):
        first, second = first_moves(name, graph, seed)
        assert first != second
        assert first_moves(name, graph, seed) == (first, second)


@pytest.mark.parametrize("name", ["decoupled", "coupled", "rollout"])
def test_chance_decides_between_mirror_images(name: str) -> None:
    assert len({first_moves(name, GRAPHS["ring"], seed) for seed in range(20)}) == 2
