"""Two golden images, without text: four rooms and a hall with belief, sight, trail and way ahead.

``python tests/drawing/test_golden.py`` draws them anew; look at them before they are committed.
"""

from pathlib import Path

import cv2
import numpy as np
import pytest

from discretize import CellMap
from geomsim.drawing.figures import Figures
from geomsim.drawing.floor import Floor
from geomsim.drawing.raster import Image, Raster, blank
from geomsim.drawing.theme import find_theme
from geomsim.drawing.viewport import Box
from geomsim.drawing.visibility import Walls

FOLDER = Path(__file__).parent / "golden"
SIZE = (320, 240)


def drawn(cells: CellMap, theme: str) -> Image:
    colours = find_theme(theme)
    image = blank(*SIZE, colours.page)
    surface = Raster(image)
    floor = Floor(cells, Box(0, 0, *SIZE), colours, 1.0)
    floor.paint(surface, colours.ramp[np.linspace(0, 255, len(cells)).astype(int)])
    painted = image.copy()
    figures = Figures(floor.view, colours, 1.0, team=2)
    path = np.vstack([cells.portals[0].legs[0], cells.portals[0].legs[1]])
    figures.sight(surface, 0, Walls(cells.plan).seen_from(path[0] + 0.01, 3.0, -0.5, 2.0))
    figures.sight(surface, 1, Walls(cells.plan).seen_from(cells.checkpoints[3]))
    floor.restore_walls(image, painted)
    figures.trail(surface, 0, path)
    figures.route(surface, 1, cells.checkpoints[[3, 4, 2]])
    return image


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_the_picture_is_the_golden_one(cells: CellMap, theme: str) -> None:
    golden = cv2.imread(str(FOLDER / f"rooms-{theme}.png"))
    assert golden is not None
    difference = cv2.absdiff(drawn(cells, theme), golden).max(axis=2)
    # Releases of OpenCV may blend edges otherwise by a little; a line elsewhere changes hundreds of pixels by a lot.
    assert np.mean(difference > 24) < 0.002
    assert difference.mean() < 0.5


if __name__ == "__main__":
    from conftest import four_rooms

    for name in ("light", "dark"):
        cv2.imwrite(str(FOLDER / f"rooms-{name}.png"), drawn(four_rooms(), name))
