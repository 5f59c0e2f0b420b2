"""The floor plan itself."""

import numpy as np
import pytest
import shapely

from maps import FloorPlan

SQUARE = shapely.box(0, 0, 3, 3)
RING = SQUARE.difference(shapely.box(1, 1, 2, 2))


@pytest.mark.parametrize(
    ("space", "walls"),
    [(SQUARE, 4), (RING, 8), (shapely.MultiPolygon([RING, shapely.box(5, 0, 6, 1)]), 12)],
)
def test_walls_are_every_edge_of_every_ring(space, walls):
    plan = FloorPlan("plan", space)
    assert plan.walls.shape == (walls, 2, 2)
    assert np.hypot(*(plan.walls[:, 1] - plan.walls[:, 0]).T).sum() == pytest.approx(space.length)
