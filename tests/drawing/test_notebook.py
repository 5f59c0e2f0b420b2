"""What shows itself in a notebook."""

import dataclasses
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import cv2
import numpy as np
import pytest
import shapely

from discretize import CellMap
from geomsim.drawing import show_belief
from geomsim.drawing.colours import lightness
from geomsim.episode import Episode
from maps import GeomsimError, Repair


def paths(svg: str) -> list[ElementTree.Element]:
    return list(ElementTree.fromstring(svg))


def test_a_plan_shows_its_space_doors_and_repairs(cells: CellMap) -> None:
    door = shapely.LineString([(2, 2), (3, 2)])
    repairs = (Repair("dropped", "", shapely.Point(1, 1)), Repair("closed", "", shapely.box(0, 0, 1, 1)))
    drawn = paths(dataclasses.replace(cells.plan, doors=(door,), repairs=repairs)._repr_svg_())
    assert len(drawn) == 4
    assert [path.get("d", "").count("M") for path in drawn] == [len(shapely.get_rings(cells.plan.space)), 1, 1, 1]


def test_a_cell_map_shows_every_cell_and_portal(cells: CellMap) -> None:
    drawn = paths(cells._repr_svg_())
    assert len(drawn) == len(cells) + 2
    assert drawn[-1].get("d", "").count("M") == len(cells.portals)


def test_an_episode_shows_its_snapshots(episode: Episode) -> None:
    image = cv2.imdecode(np.frombuffer(episode._repr_png_(), np.uint8), cv2.IMREAD_COLOR)
    assert image.shape[1] == 1200


def test_a_belief_shows_where_the_evader_may_be(cells: CellMap, episode: Episode, tmp_path: Path) -> None:
    sure = np.array([0.5, 0.5, 0, 0, 0, 0])
    picture = show_belief(cells, sure)
    image = cv2.imdecode(np.frombuffer(picture._repr_png_(), np.uint8), cv2.IMREAD_COLOR)
    assert np.array_equal(image, picture.image)
    assert np.array_equal(cv2.imread(str(picture.save(tmp_path / "b.png"))), image)
    upper_left, upper_right = lightness(image[[100, 100], [200, 800]][:, ::-1])
    assert upper_left < upper_right - 0.3


def test_a_belief_of_another_map_is_a_sentence(cells: CellMap) -> None:
    with pytest.raises(GeomsimError, match="6 numbers"):
        show_belief(cells, np.ones(5) / 5)
