from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planners import (
    AreaSpeedDegree,
    MotionError,
    SearchGraph,
    StationaryMotion,
    UniformMotion,
    check_transition,
)

MODELS = [UniformMotion(), AreaSpeedDegree(), AreaSpeedDegree(speed=0.3), StationaryMotion()]

# Section IV-B of the paper, as printed.
PRINTED = """
1 0 0 0 0 0 0 0 0 0
0 1/3 0 0 1/3 0 0 0 1/3 0
0 0 1/3 0 0 0 0 0 1/3 1/3
0 0 0 1/2 1/2 0 0 0 0 0
0 1/6 0 1/6 1/6 1/6 1/6 0 0 1/6
0 0 0 0 1/3 1/3 0 1/3 0 0
0 0 0 0 1/3 0 1/3 1/3 0 0
0 0 0 0 0 1/3 1/3 1/3 0 0
0 1/3 1/3 0 0 0 0 0 1/3 0
0 0 1/3 0 1/3 0 0 0 0 1/3
"""


def test_uniform_motion_on_the_house_is_the_printed_matrix(house):
    printed = np.array([[float(Fraction(x)) for x in row.split()] for row in PRINTED.strip().splitlines()])
    np.testing.assert_array_equal(UniformMotion().matrix(house, 1.0).toarray(), printed)


@pytest.mark.parametrize("model", MODELS, ids=repr)
@given(data=st.data(), step=st.floats(1e-3, 1e3))
def test_every_model_gives_a_dispersion_matrix_on_every_graph(graphs, model, data, step):
    graph = data.draw(graphs(15))
    check_transition(model.matrix(graph, step), graph)


@given(data=st.data())
def test_the_matrix_of_stationary_motion_is_the_identity(graphs, data):
    graph = data.draw(graphs(9))
    np.testing.assert_array_equal(StationaryMotion().matrix(graph, 1.0).toarray(), np.eye(len(graph) + 1))


def test_area_speed_degree_by_hand():
    # Three cells in a row; the middle one of 16 square metres takes 4 s / 2 = 2 s to cross at 2 m/s.
    graph = SearchGraph._build([(0, 1), (1, 2)], np.ones((2, 2)), np.array([1.0, 16.0, 4.0]), np.zeros(3, dtype=int))
    row = AreaSpeedDegree(speed=2.0).matrix(graph, 1.0).toarray()[2]
    stay = np.exp(-0.5)
    np.testing.assert_allclose(row, [0.0, (1 - stay) / 2, stay, (1 - stay) / 2])


def test_larger_cells_hold_longer_and_faster_evaders_leave_sooner(metric_house):
    slow, fast = (AreaSpeedDegree(v).matrix(metric_house, 1.0).diagonal()[1:] for v in (0.5, 2.0))
    assert (fast < slow).all()
    assert (np.diff(slow[np.argsort(metric_house.area)]) > 0).all()


@pytest.mark.parametrize("speed", [0.0, -1.0, float("nan"), float("inf")])
def test_a_speed_that_is_none_is_named(speed):
    with pytest.raises(MotionError, match=f"above 0; got {speed}"):
        AreaSpeedDegree(speed)


def spoil(matrix, i, j, value):
    matrix[i, j] = value
    return matrix


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda m: m[:9, :9], r"must be 10 x 10 .*; got 9 x 9"),
        (lambda m: spoil(m, 3, 4, 0.6), "Row 3 of the transition matrix sums to 1.1, not to 1"),
        (lambda m: spoil(m, 3, 4, -0.5), "from state 3 to state 4 is -0.5"),
        (lambda m: spoil(m, 3, 4, np.nan), "from state 3 to state 4 is nan"),
        (lambda m: spoil(spoil(m, 3, 4, 0.0), 3, 9, 0.5), "from cell 3 to cell 9, which are not neighbours"),
        (lambda m: spoil(spoil(m, 3, 4, 0.0), 3, 0, 0.5), "from state 3 to state 0 enters or leaves the capture"),
    ],
)
def test_a_wrong_matrix_is_named(house, change, message):
    matrix = UniformMotion().matrix(house, 1.0).toarray()
    check_transition(matrix, house)
    with pytest.raises(MotionError, match=message):
        check_transition(change(matrix), house)
