"""Graphs and problems that the planner tests share."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from hypothesis import strategies as st

from planners import SearchGraph

# How long an example takes says nothing on a machine that others use too.

HOUSE = [(1, 4), (1, 8), (2, 8), (2, 9), (3, 4), (4, 5), (4, 6), (4, 9), (5, 7), (6, 7)]


def with_ways(pairs: Sequence[tuple[int, int]], cells: int, rng: np.random.Generator) -> SearchGraph:
    component = SearchGraph.from_edges(cells, pairs).component
    legs = rng.uniform(0.3, 4.0, (len(pairs), 2))
    return SearchGraph._build(pairs, legs, rng.uniform(2.0, 60.0, cells), component)


@pytest.fixture(scope="session")
def house() -> SearchGraph:
    """The cell graph of the paper's Fig. 2, as the printed dispersion matrix implies it."""
    return SearchGraph.from_edges(9, [(a - 1, b - 1) for a, b in HOUSE])


@pytest.fixture(scope="session")
def metric_house() -> SearchGraph:
    """The same with ways and areas."""
    return with_ways([(a - 1, b - 1) for a, b in HOUSE], 9, np.random.default_rng(5))


@pytest.fixture(scope="session")
def graphs() -> Callable[[int], st.SearchStrategy[SearchGraph]]:
    """Strategies for any graph up to a number of cells, connected or not, with random ways and areas."""

    @st.composite
    def strategy(draw: st.DrawFn, cells: int) -> SearchGraph:
        n = draw(st.integers(1, cells))
        pairs = [(i, j) for i in range(n) for j in range(i + 1, n)]
        edges = draw(st.lists(st.sampled_from(pairs), unique=True, max_size=2 * n)) if pairs else []
        return with_ways(edges, n, np.random.default_rng(draw(st.integers(0, 2**32 - 1))))

    return strategy
