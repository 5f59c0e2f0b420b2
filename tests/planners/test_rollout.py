import numpy as np
import pytest

from planners import AreaSpeedDegree, Decoupled, Rollout, SameCell, SearchProblem, predict, unit_problem


@pytest.mark.parametrize("patience", [1, 5])
@pytest.mark.parametrize("metric", [False, True])
def test_a_rollout_is_never_worse_than_its_bases(house, metric_house, metric, patience):
    if metric:
        problem = SearchProblem(metric_house, AreaSpeedDegree(), SameCell(), (1.0, 0.8))
    else:
        problem = unit_problem(house, 2)
    bases = (Decoupled("entropy", 1), Decoupled("probability", 1), Decoupled("target-probability", 2))
    for start in [(0, 0), (3, 6)]:
        # The rollout gives its bases generators of their own; with the same ones, what each would do alone is known.
        alone = []
        for base, rng in zip(
            bases, np.random.default_rng(np.random.default_rng(4).integers(2**63)).spawn(3), strict=True
        ):
            alone.append(predict(problem, Fixed(base, rng), [start], np.random.default_rng(4))[0].expected_time)
        (result,) = predict(problem, Rollout(bases, patience=patience), [start], np.random.default_rng(4))
        assert result.expected_time <= min(alone) * (1 + 1e-5)


class Fixed:
    """A planner that ignores the generator that it is given."""

    def __init__(self, planner, rng):
        self.planner, self.rng = planner, rng

    def solve(self, problem, _):
        return self.planner.solve(problem, self.rng)
