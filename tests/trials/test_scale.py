"""The bundled office is as large as the paper's: its stationary baseline takes as long."""

import numpy as np
import pytest

from discretize import CellMap
from planners import SearchGraph


def stationary_mean(cells: CellMap, robots: tuple[int, ...]) -> float:
    """Expected time until an evader at 1 m/s enters a robot's cell: exact, by the first hop from each checkpoint."""
    graph = SearchGraph.from_cells(cells)
    system, gone = np.eye(len(graph)), np.zeros(len(graph))
    for cell in set(range(len(graph))) - set(robots):
        edges = range(graph.indptr[cell], graph.indptr[cell + 1])
        for edge in edges:
            to = int(graph.indices[edge])
            if to in robots:
                gone[cell] += graph.leave[edge] / len(edges)
            else:
                gone[cell] += graph.length[edge] / len(edges)
                system[cell, to] -= 1 / len(edges)
    times = np.linalg.solve(system, gone)
    return float(np.delete(times, robots).mean())


def test_the_office_is_as_large_as_in_the_paper(office: CellMap) -> None:
    assert [cell - 1 for cell in office.plan.start] == [42, 43]
    assert stationary_mean(office, (42, 43)) == pytest.approx(749.319, rel=2e-3)
