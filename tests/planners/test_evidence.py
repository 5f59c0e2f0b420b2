import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planners import (
    EvidenceError,
    SameCell,
    UniformMotion,
    advance,
    elsewhere,
    find_cost,
    measured_range,
    merge_evaders,
    observe,
    region_belief,
    reported_sighting,
)
from planners.costs import Hops


def test_a_measurement_by_hand():
    # Captured with 1/5; the rest 1/5, 2/5, 1/5. A report twice as likely from the last state as from the others.
    after = observe(np.array([0.2, 0.2, 0.4, 0.2]), [0.3, 0.3, 0.6])
    np.testing.assert_allclose(after, [0.2, 0.16, 0.32, 0.32])


@given(seed=st.integers(0, 999), states=st.integers(1, 9))
def test_measurements_keep_probability_and_order_does_not_matter(seed, states):
    rng = np.random.default_rng(seed)
    belief = rng.dirichlet(np.ones(states + 1))
    one, other = rng.uniform(0.01, 1.0, (2, states))
    np.testing.assert_allclose(observe(belief, one).sum(), 1.0)
    np.testing.assert_allclose(observe(observe(belief, one), other), observe(observe(belief, other), one))
    np.testing.assert_allclose(observe(belief, np.ones(states)), belief)


def test_a_range_draws_the_belief_to_that_distance():
    belief = np.array([0.0, 0.25, 0.25, 0.25, 0.25])
    after = observe(belief, measured_range([1.0, 5.0, 9.0, 50.0], measured=5.4, deviation=1.0))
    assert np.argmax(after) == 2
    ratio = after[3] / after[2]
    assert ratio == pytest.approx(np.exp(-(3.6**2 - 0.4**2) / 2))
    far = observe(belief, measured_range([1.0, 5.0, 9.0, 50.0], measured=500.0, deviation=1.0))
    assert far[4] == pytest.approx(1.0)


def test_a_false_alarm_is_believed_as_much_as_it_deserves():
    belief = np.array([0.0, 0.5, 0.5])
    after = observe(belief, reported_sighting(2, [1], hit=0.8, false=0.2))
    np.testing.assert_allclose(after, [0.0, 0.2, 0.8])
    np.testing.assert_allclose(observe(belief, elsewhere(2, [0])), [0.0, 0.0, 1.0])


def test_a_prior_on_a_region(house):
    prior = region_belief(house, [0, 1, 2], inside=0.6)
    np.testing.assert_allclose(prior[[1, 2, 3]], 0.2)
    np.testing.assert_allclose(prior[4:], 0.4 / 6)
    np.testing.assert_allclose(region_belief(house, [5])[6], 1.0)


def test_planning_for_several_evaders_sums_their_costs(house):
    rng = np.random.default_rng(0)
    beliefs = rng.dirichlet(np.ones(10), size=3)
    free = np.array([True, False, True])
    transition, rows = UniformMotion().matrix(house, 1.0), [SameCell().row(house, 3)]
    cost = find_cost("target-probability")

    def judged(belief):
        after = advance(belief, transition, rows)[None, 1:]
        return cost(Hops(belief[None, 1:], after, np.zeros(1), np.ones(1)))[0]

    together = judged(merge_evaders(beliefs, free))
    assert together == pytest.approx((judged(beliefs[0]) + judged(beliefs[2])) / 2)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: observe(np.array([0.0, 1.0]), [0.5, 0.5]), r"must have 1 entries, one a state; got shape \(2,\)"),
        (lambda: observe(np.array([0.0, 1.0]), [-1.0]), "nowhere below 0"),
        (lambda: observe(np.array([0.0, 1.0, 0.0]), [0.0, 1.0]), "impossible everywhere"),
        (lambda: measured_range([1.0], 1.0, 0.0), "above 0; got 0"),
        (lambda: reported_sighting(2, [2], 1.0, 0.0), "no state 3; states are numbered from 1 to 2"),
        (lambda: reported_sighting(2, [0], 1.5, 0.0), "between 0 and 1; got 1.5 and 0.0"),
        (lambda: merge_evaders(np.ones((1, 2)), [False]), "nobody left"),
    ],
)
def test_bad_evidence_is_named(make, message):
    with pytest.raises(EvidenceError, match=message):
        make()


def test_a_bad_prior_is_named(house):
    with pytest.raises(EvidenceError, match=r"between 0 and 1; got 1\.2"):
        region_belief(house, [0], inside=1.2)
