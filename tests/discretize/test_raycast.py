"""Lines of sight by the million."""

import numpy as np
import pytest

from discretize import CellMap, WallGrid
from discretize.raycast import seen_among, seen_from, seen_pairs


@pytest.mark.parametrize("reach", [np.inf, 4.0])
def test_all_pairs_are_those_of_single_rays(house: CellMap, reach: float) -> None:
    grid = WallGrid.of(house.plan.walls)
    rng = np.random.default_rng(3)
    x0, y0, x1, y1 = house.plan.bounds
    eyes, targets = (rng.uniform((x0, y0), (x1, y1), (n, 2)) for n in (90, 70))
    a, b = np.repeat(eyes, len(targets), axis=0), np.tile(targets, (len(eyes), 1))
    expected = (seen_pairs(grid, a, b) & (np.hypot(*(b - a).T) <= reach)).reshape(90, 70)
    indptr, indices = seen_among(grid, eyes, targets, reach)
    found = np.zeros_like(expected)
    found[np.repeat(np.arange(90), np.diff(indptr)), indices] = True
    assert np.array_equal(found, expected)
    assert np.array_equal(seen_from(grid, eyes[7], targets, reach), expected[7])


def test_what_is_nowhere_is_not_seen(house: CellMap) -> None:
    grid = WallGrid.of(house.plan.walls)
    points = np.array([house.checkpoints[0], [np.nan, np.nan]])
    indptr, indices = seen_among(grid, points, points)
    assert indptr.tolist() == [0, 1, 1]
    assert indices.tolist() == [0]


def test_no_eyes(house: CellMap) -> None:
    indptr, indices = seen_among(WallGrid.of(house.plan.walls), np.empty((0, 2)), house.checkpoints)
    assert indptr.tolist() == [0]
    assert len(indices) == 0
