"""What must be true of the pixels of a frame; nothing here looks at text."""

import dataclasses

import numpy as np
import pytest

from discretize import CellMap
from geomsim.drawing import FrameDrawer, FrameStyle, draw_frame
from geomsim.drawing.colours import bgr, lightness
from geomsim.drawing.floor import Floor
from geomsim.drawing.moment import Timeline, shares
from geomsim.drawing.theme import THEMES, DrawingError
from geomsim.drawing.viewport import Box
from geomsim.episode import Episode

PLAIN = FrameStyle(sight=False, plans=False, trails=False)


def pixel_at(drawer: FrameDrawer, image: np.ndarray, point: tuple[float, float]) -> np.ndarray:
    x, y = np.rint(drawer.view.pixels(np.array(point))).astype(int)
    return image[y, x].astype(int)


def near(colour: np.ndarray, name: str) -> bool:
    return bool(np.abs(colour - bgr(name)).max() <= 8)


@pytest.mark.parametrize("size", [(1280, 720), (640, 480), (500, 900), (1920, 1080)])
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_walls_cells_robots_and_evader_are_where_they_are(episode: Episode, size: tuple[int, int], theme: str) -> None:
    drawer = FrameDrawer(episode, dataclasses.replace(PLAIN, size=size, theme=theme))
    image = drawer.draw(0.0)
    colours = THEMES[theme]
    assert image.shape == (size[1], size[0], 3)
    assert image.dtype == np.uint8
    assert near(pixel_at(drawer, image, (5.1, 4.0)), colours.wall)
    # Left of the number on the robot, and below the letter on the evader.
    beside = 7.5 * drawer.style.unit / drawer.view.scale
    robot, evader = episode.pursuers[0, 0], episode.evader[0]
    assert near(pixel_at(drawer, image, (robot[0] - beside, robot[1])), colours.robot(0))
    below = 8.2 * drawer.style.unit / drawer.view.scale
    assert near(pixel_at(drawer, image, (evader[0], evader[1] - below)), colours.evader)


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_a_probable_cell_is_shaded_more(episode: Episode, theme: str) -> None:
    drawer = FrameDrawer(episode, dataclasses.replace(PLAIN, theme=theme))
    image = drawer.draw(12.0)
    share = shares(episode.beliefs[-1])
    corners = [(0.5, 5.5), (9.7, 5.5), (0.5, -3.5), (9.7, -3.5), (0.5, 1.0)]
    light = lightness(np.array([pixel_at(drawer, image, c)[::-1] for c in corners]))
    order = np.argsort(share, kind="stable")
    steps = np.diff(light[order]) * (-1 if theme == "light" else 1)
    assert np.all(steps >= -0.01)
    assert steps.sum() > 0.2


def test_without_the_belief_layer_all_cells_look_alike(episode: Episode) -> None:
    drawer = FrameDrawer(episode, dataclasses.replace(PLAIN, belief=False))
    image = drawer.draw(12.0)
    assert np.array_equal(pixel_at(drawer, image, (0.5, 5.5)), pixel_at(drawer, image, (9.7, -3.5)))


@pytest.mark.parametrize("layer", ["sight", "plans", "trails", "belief", "numbers"])
def test_each_layer_changes_the_picture(episode: Episode, layer: str) -> None:
    full = draw_frame(episode, 4.0, FrameStyle(numbers=True))
    without = draw_frame(episode, 4.0, dataclasses.replace(FrameStyle(numbers=True), **{layer: False}))
    assert not np.array_equal(full, without)


def test_sight_reaches_what_can_be_seen_and_no_more(episode: Episode) -> None:
    with_sight, without = (draw_frame(episode, 0.0, dataclasses.replace(PLAIN, sight=s)) for s in (True, False))
    drawer = FrameDrawer(episode, PLAIN)
    changed = [
        not np.array_equal(pixel_at(drawer, with_sight, p), pixel_at(drawer, without, p))
        for p in ((0.5, 5.5), (2.5, 1.0), (9.7, 5.5), (9.7, 1.0))
    ]
    assert changed == [True, True, False, False]


def test_same_cell_capture_shows_the_cell(episode: Episode) -> None:
    told = dataclasses.replace(episode, scenario={"capture": "cell"})
    with_sight, without = (draw_frame(told, 0.0, dataclasses.replace(PLAIN, sight=s)) for s in (True, False))
    drawer = FrameDrawer(told, PLAIN)
    changed = [
        not np.array_equal(pixel_at(drawer, with_sight, p), pixel_at(drawer, without, p))
        for p in ((0.5, 5.5), (2.5, 1.0))
    ]
    assert changed == [True, False]


def test_a_hidden_evader_shows_when_captured(episode: Episode) -> None:
    hidden = dataclasses.replace(PLAIN, evader="hidden")
    colour = bgr(THEMES["light"].evader)

    def area(time: float, style: FrameStyle) -> int:
        return int((draw_frame(episode, time, style)[60:600] == colour).all(axis=2).sum())

    assert area(4.0, PLAIN) > 100
    assert area(4.0, hidden) == 0
    assert area(12.0, hidden) > 100


def test_the_curve_grows_and_the_capture_is_marked(episode: Episode) -> None:
    strip = slice(620, 700)
    theme = THEMES["light"]

    def columns(time: float, colour: str) -> int:
        return int((draw_frame(episode, time)[strip, :920] == bgr(colour)).all(axis=2).any(axis=0).sum())

    drawn = [columns(t, theme.curve) for t in (3.0, 6.0, 9.0)]
    assert drawn[0] > 50
    assert drawn[0] < drawn[1] < drawn[2]
    assert columns(11.9, theme.evader) == 0
    assert columns(12.0, theme.evader) > 0


def test_drawing_is_deterministic_in_any_order(episode: Episode) -> None:
    times = [0.0, 3.3, 7.1, 12.0]
    first, second = FrameDrawer(episode), FrameDrawer(episode)
    forwards = [first.draw(t) for t in times]
    backwards = [second.draw(t) for t in reversed(times)][::-1]
    for a, b in zip(forwards, backwards, strict=True):
        assert np.array_equal(a, b)


def test_a_frame_is_the_callers_own(episode: Episode) -> None:
    drawer = FrameDrawer(episode)
    first = drawer.draw(3.0)
    kept = first.copy()
    first[:] = 0
    assert np.array_equal(drawer.draw(3.0), kept)


@pytest.mark.parametrize(
    ("options", "word"),
    [
        ({"size": (100, 100)}, "100 x 100"),
        ({"theme": "drak"}, "'dark'"),
        ({"evader": "gone"}, "'gone'"),
    ],
)
def test_a_wrong_style_is_a_sentence(options: dict[str, object], word: str) -> None:
    with pytest.raises(DrawingError, match=word):
        FrameStyle(**options)


def test_the_way_ahead_starts_here_and_ends_at_the_goal(episode: Episode, cells: CellMap) -> None:
    timeline = Timeline(episode)
    for time in (0.0, 2.0, 6.0):
        moment = timeline.at(time)
        for r, goal in ((0, 1), (1, 3)):
            assert np.allclose(moment.routes[r][0], moment.pursuers[r])
            assert np.allclose(moment.routes[r][-1], cells.checkpoints[goal])
    lengths = [np.hypot(*np.diff(timeline.at(t).routes[0], axis=0).T).sum() for t in (0.0, 1.0, 2.0, 5.0)]
    assert np.allclose(-np.diff(lengths), [1.0, 1.0, 3.0], atol=0.1)


def test_positions_between_steps_are_between(episode: Episode) -> None:
    moment = Timeline(episode).at(1.05)
    assert np.allclose(moment.pursuers, (episode.pursuers[10] + episode.pursuers[11]) / 2)
    assert np.allclose(moment.trails[0][-1], moment.pursuers[0])


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_the_ramp_is_even_in_lightness(theme: str) -> None:
    steps = np.diff(lightness(THEMES[theme].ramp))
    assert np.all(np.sign(steps.sum()) * steps > -0.004)  # a step of eight-bit colour is 0.003
    coarse = np.diff(lightness(THEMES[theme].ramp[::16]))
    assert np.abs(coarse - coarse.mean()).max() < 0.1 * abs(coarse.mean()) + 0.003


def test_every_cell_has_its_pixels(cells: CellMap) -> None:
    floor = Floor(cells, Box(0, 0, 400, 400), THEMES["light"], 1.0)
    counts = np.bincount(floor.labels.ravel(), minlength=6)[1:]
    assert np.allclose(counts / counts.sum(), cells.areas / cells.areas.sum(), atol=0.02)


def test_robots_in_one_place_are_drawn_beside_each_other() -> None:
    from geomsim.drawing.figures import apart

    for count in (1, 2, 3, 8):
        moved = apart(np.zeros((count, 2)), 10.0)
        gaps = np.hypot(*(moved[:, None] - moved[None]).transpose(2, 0, 1)) + 99 * np.eye(count)
        assert gaps.min() > 9.0 or count == 1
        assert np.abs(moved).max() < 6.0 * count
    lonely = np.array([[0.0, 0.0], [30.0, 0.0]])
    assert apart(lonely, 10.0) == pytest.approx(lonely, abs=0.02)
