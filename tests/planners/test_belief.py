import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planners import (
    AreaSpeedDegree,
    CaptureError,
    GraphError,
    SameCell,
    SearchGraph,
    StationaryMotion,
    UniformMotion,
    advance,
    point_belief,
    uniform_belief,
)


def capture_matrix(row):
    """The matrix C of Section IV-B, written out."""
    matrix = np.diag(np.concatenate([[1.0], 1.0 - row]))
    matrix[1:, 0] = row
    return matrix


def test_capture_by_hand(house):
    # The evader is in cell 1 or 4; it disperses as printed, and a pursuer in cell 1 sees what is there then.
    belief = np.zeros(10)
    belief[[1, 4]] = 0.5
    after = advance(belief, UniformMotion().matrix(house, 1.0), [SameCell().row(house, 0)])
    expected = [1 / 4, 0, 0, 1 / 12, 1 / 4, 1 / 12, 1 / 12, 0, 1 / 6, 1 / 12]
    np.testing.assert_allclose(after, expected, atol=1e-15)


@given(data=st.data(), detection=st.floats(0.05, 1.0), robots=st.integers(0, 3), batch=st.integers(1, 3))
def test_a_step_is_equation_3_and_keeps_probability(graphs, data, detection, robots, batch):
    graph = data.draw(graphs(12))
    rng = np.random.default_rng(data.draw(st.integers(0, 999)))
    beliefs = rng.dirichlet(np.ones(len(graph) + 1), size=batch)
    kept = beliefs.copy()
    rows = [SameCell(detection).row(graph, int(c)) for c in rng.integers(len(graph), size=robots)]
    transition = AreaSpeedDegree().matrix(graph, 0.7)
    product = transition.toarray()
    for row in rows:
        product = product @ capture_matrix(row)
    after = advance(beliefs, transition, rows)
    np.testing.assert_allclose(after, beliefs @ product, atol=1e-14)
    np.testing.assert_allclose(after.sum(axis=1), 1.0, atol=1e-12)
    assert (after >= 0).all()
    assert (after[:, 0] >= beliefs[:, 0] - 1e-15).all()
    np.testing.assert_array_equal(beliefs, kept)
    np.testing.assert_allclose(advance(beliefs[0], transition, rows), after[0], atol=1e-15)


def test_each_belief_of_a_batch_may_have_its_own_pursuers(house):
    transition = UniformMotion().matrix(house, 1.0)
    beliefs = np.stack([uniform_belief(house), point_belief(house, 3)])
    rows = np.array([[SameCell().row(house, c)] for c in (0, 4)])
    after = advance(beliefs, transition, rows)
    for k in range(2):
        np.testing.assert_allclose(after[k], advance(beliefs[k], transition, rows[k]))


def test_a_still_evader_is_never_seen_elsewhere(house):
    belief = point_belief(house, 6)
    for cell in (0, 1, 2, 3):
        belief = advance(belief, StationaryMotion().matrix(house, 1.0), [SameCell().row(house, cell)])
    np.testing.assert_array_equal(belief, point_belief(house, 6))


def test_uniform_belief_leaves_out_what_is_asked():
    graph = SearchGraph.from_edges(5, [(0, 1), (1, 2), (3, 4)])
    np.testing.assert_allclose(uniform_belief(graph, exclude=[1]), [0, 1 / 4, 0, 1 / 4, 1 / 4, 1 / 4])
    np.testing.assert_allclose(uniform_belief(graph, exclude=[1, 1], component=0), [0, 1 / 2, 0, 1 / 2, 0, 0])


def test_a_cell_that_no_robot_can_enter_holds_no_evader():
    graph = SearchGraph._build([(0, 1)], np.ones((1, 2)), np.ones(3), np.array([0, 0, -1]))
    np.testing.assert_allclose(uniform_belief(graph), [0, 1 / 2, 1 / 2, 0])


def test_bad_cells_are_named(house):
    with pytest.raises(GraphError, match="no cell 10; cells are numbered from 1 to 9"):
        point_belief(house, 9)
    with pytest.raises(GraphError, match="no cell 0"):
        uniform_belief(house, exclude=[-1])
    with pytest.raises(GraphError, match="No cell is left"):
        uniform_belief(house, exclude=range(9))


@pytest.mark.parametrize("detection", [0.0, -0.1, 1.1, float("nan")])
def test_a_detection_probability_outside_its_range_is_named(detection):
    with pytest.raises(CaptureError, match=f"got {detection}"):
        SameCell(detection)


def test_a_pursuer_is_in_the_cell_it_leaves_up_to_the_portal():
    graph = SearchGraph._build([(0, 1)], np.array([[2.0, 1.0]]), np.ones(2), np.zeros(2, dtype=int))
    way = np.array([0.0, 1.0, 1.99, 2.0, 3.0])
    np.testing.assert_array_equal(SameCell().viewpoints(graph, graph.edge(0, 1), way), [0, 0, 0, 1, 1])
    np.testing.assert_array_equal(SameCell().viewpoints(graph, graph.edge(1, 0), way), [1, 0, 0, 0, 0])


def test_the_capture_table_holds_the_rows(house):
    model = SameCell(0.8)
    np.testing.assert_array_equal(model.table(house).toarray(), [model.row(house, c) for c in range(9)])
