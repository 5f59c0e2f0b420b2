"""A state need not be a cell: every cell split into two states that the evader changes at random."""

import dataclasses

import numpy as np
import pytest
from scipy.sparse import block_array, csr_array, kron

from planners import (
    AreaSpeedDegree,
    Beam,
    BestResponse,
    BranchAndBound,
    Coupled,
    Decoupled,
    PursuerState,
    Rollout,
    SameCell,
    SearchProblem,
    SearchState,
    Sequential,
    uniform_belief,
)
from planners.simulation import SearchModel


@dataclasses.dataclass(frozen=True)
class Halves:
    """Motion and capture on two states a cell; state ``2 c + h`` is half ``h`` of cell ``c``."""

    motion: AreaSpeedDegree
    capture: SameCell

    def matrix(self, graph, time_step):
        cells = self.motion.matrix(graph, time_step)[1:, 1:]
        halves = kron(cells, np.full((2, 2), 0.5))
        return csr_array(block_array([[np.ones((1, 1)), None], [None, halves]]))

    def table(self, graph):
        return csr_array(kron(self.capture.table(graph), np.ones((1, 2))))

    def viewpoints(self, graph, edge, way):
        return self.capture.viewpoints(graph, edge, way)

    def row(self, graph, cell):
        return np.repeat(self.capture.row(graph, cell), 2)


@pytest.mark.parametrize(
    "planner",
    [
        Decoupled("target-probability", 3),
        Decoupled("probability", 2),
        Coupled("target-probability", 2),
        Rollout(bases=(Decoupled("target-probability", 2),), horizon=40),
        Beam(width=50, horizon=30),
        Sequential(horizon=8),
        BestResponse(horizon=8),
        BranchAndBound(horizon=6),
    ],
    ids=repr,
)
def test_planning_on_halves_of_cells_is_as_good_as_on_cells(metric_house, planner):
    motion, capture = AreaSpeedDegree(), SameCell(0.9)
    halves = Halves(motion, capture)
    team = (PursuerState(0), PursuerState(3, 4, 2.0))
    whole = uniform_belief(metric_house, exclude=[0, 3])
    belief = np.concatenate([whole[:1], np.repeat(whole[1:] / 2, 2)])
    problems = [
        SearchProblem(metric_house, motion, capture, (1.0, 0.8)),
        SearchProblem(metric_house, halves, halves, (1.0, 0.8)),
    ]
    left = []
    for problem, p in zip(problems, (whole, belief), strict=True):
        policy = planner.solve(problem, np.random.default_rng(0))
        decision = policy.decide(SearchState(0.0, p, team, ((), ())))[0]
        model = SearchModel(problems[0])
        moves = [model.move(0, 0), model.move(3, 4)]
        plan = [model.move(a, b) for a, b in zip((0, *decision.path), decision.path, strict=False)]
        wait = [model.move(4, 4)] * 60
        left.append(model.foresee(whole[1:], moves, [1, 0], [plan, wait], 8).sum(axis=1))
    np.testing.assert_allclose(left[0], left[1], rtol=1e-9)
