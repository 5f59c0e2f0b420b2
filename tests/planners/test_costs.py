import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planners import COSTS, CostError, Hops, find_cost


def one_hop(before=(0.5, 0.25), after=(0.25, 0.25), chance=0.25, distance=3.0):
    return Hops(np.array([before]), np.array([after]), np.array([chance]), np.array([distance]))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("probability", 0.75),  # Eq. 4: 1 - 1/4
        ("distance-over-probability", 12.0),  # Eq. 5: 3 / (1/4)
        ("target-probability", 1.0),  # Eq. 6 with p = [1/2, 1/4, 1/4]: 1/2 + 1/4 + 1/4
        ("entropy", 1.5 * np.log(2)),  # Eq. 7 with the same p
    ],
)
def test_worked_examples(name, value):
    np.testing.assert_allclose(find_cost(name)(one_hop()), [value])


@pytest.mark.parametrize("name", COSTS)
@given(seed=st.integers(0, 2**32 - 1), hops=st.integers(1, 6), states=st.integers(1, 8))
def test_costs_are_finite_not_negative_and_independent_of_the_batch(name, seed, hops, states):
    rng = np.random.default_rng(seed)
    before, after = (rng.dirichlet(np.full(states + 1, 0.1), size=hops)[:, 1:] for _ in range(2))
    after[0] = 0.0
    batch = Hops(before, after, before[:, 0], rng.uniform(0.1, 9.0, hops))
    values = COSTS[name](batch)
    assert values.shape == (hops,)
    assert np.isfinite(values).all()
    assert (values >= 0).all()
    for k in range(hops):
        alone = COSTS[name](Hops(*(part[[k]] for part in (before, after, batch.chance, batch.distance))))
        np.testing.assert_allclose(alone, values[[k]])


def test_certain_capture_costs_nothing_by_the_costs_that_see_the_whole_belief():
    done = one_hop(after=(0.0, 0.0))
    assert COSTS["entropy"](done) == 0
    assert COSTS["target-probability"](done) == 0


def test_an_unknown_cost_is_named_with_the_nearest_one():
    with pytest.raises(CostError, match="no cost heuristic 'entropie'; did you mean 'entropy'"):
        find_cost("entropie")
