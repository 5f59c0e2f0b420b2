"""The replay: what its record holds, and the page in a real browser without a network."""

import base64
import dataclasses
import gzip
import json
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from geomsim.drawing.visibility import Walls
from geomsim.episode import Episode, Outcome, Status
from geomsim.replay import write_replay
from geomsim.replay.page import replay_page
from geomsim.video import write_video
from maps import GeomsimError

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


def record_of(page: str) -> dict[str, Any]:
    found = re.search(r'id="record">([^<]*)<', page)
    assert found
    return json.loads(gzip.decompress(base64.b64decode(found[1])))


def test_the_record_holds_the_episode(episode: Episode) -> None:
    record = record_of(replay_page(episode))
    moves = np.cumsum(record["moves"], axis=0) / 100
    assert np.abs(moves[:, :4].reshape(-1, 2, 2) - episode.pursuers).max() < 0.006
    assert np.abs(moves[:, 4:] - episode.evader).max() < 0.006
    assert np.allclose(np.cumsum(record["times"]) / 1000, episode.times, atol=1e-3)
    roots = np.cumsum(record["chances"], axis=0) / 10_000
    assert np.allclose(roots[:, 0] ** 2, episode.beliefs[:, 0], atol=2e-4)
    share = episode.beliefs[:, 1:] / (1 - episode.beliefs[:, :1])
    assert np.allclose(roots[:, 1:] ** 2, share, atol=2e-4)


def test_the_same_episode_gives_the_same_page(episode: Episode) -> None:
    assert replay_page(episode) == replay_page(episode)


def test_the_page_asks_for_nothing(episode: Episode) -> None:
    page = replay_page(episode)
    assert "default-src 'none'" in page
    assert not re.search(r"(src|href)\s*=\s*[\"'](?!data:)", page)
    assert "<!--" not in page.replace("<!doctype", "")
    assert not re.search(r"https?://", page)


def test_names_cannot_break_out_of_the_page(episode: Episode) -> None:
    plan = dataclasses.replace(episode.plan, name="</script><b>&")
    page = replay_page(dataclasses.replace(episode, plan=plan))
    assert "</script><b>" not in page
    assert record_of(page)["name"] == "</script><b>&"


def ten_minutes(episode: Episode) -> Episode:
    """Sixty cells, three robots and a belief that moves, for 600 s."""
    rng = np.random.default_rng(5)
    cells = episode.cells
    many = dataclasses.replace(
        cells,
        cells=cells.cells * 12,
        checkpoints=np.tile(cells.checkpoints, (12, 1)),
        names=cells.names * 12,
    )
    times = np.arange(0, 600.05, 0.1)
    turns = np.cumsum(rng.normal(0, 0.2, (len(times), 4)), axis=0)
    bodies = 5 + 4 * np.stack([np.sin(turns), np.cos(0.7 * turns)], axis=-1)
    share = rng.dirichlet(np.full(60, 0.5), size=601)
    # Neighbouring beliefs resemble one another, as those of a pursuit do.
    share = np.stack([share[max(0, k - 30) : k + 1].mean(axis=0) for k in range(601)])
    caught = np.linspace(0, 0.95, 601)[:, None]
    count = 360
    return dataclasses.replace(
        episode,
        cells=many,
        times=times,
        pursuers=bodies[:, :3],
        headings=turns[:, :3],
        pursuer_cells=np.zeros((len(times), 3), np.int32),
        evaders=bodies[:, 3:],
        evaders_cells=np.zeros((len(times), 1), np.int32),
        belief_times=np.arange(601.0),
        beliefs=np.hstack([caught, (1 - caught) * share]),
        decision_times=np.sort(rng.uniform(0, 600, count)),
        decision_pursuers=rng.integers(0, 3, count).astype(np.int32),
        decision_paths=tuple(np.array([4, k % 4, 4, (k + 1) % 4, 4], np.int32) for k in range(count)),
        outcome=Outcome(Status.TIME_LIMIT, 600.0, None, None, None, 0.95),
    )


def test_ten_minutes_of_sixty_cells_stay_under_a_megabyte(episode: Episode, tmp_path: Path) -> None:
    path = write_replay(ten_minutes(episode), tmp_path / "long.html")
    assert path.stat().st_size < 1_000_000


@pytest.mark.parametrize("name", ["a.htm1", "a"])
def test_a_wrong_name_is_a_sentence(episode: Episode, tmp_path: Path, name: str) -> None:
    with pytest.raises(GeomsimError, match=r"\.html"):
        write_replay(episode, tmp_path / name)


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    playwright = pytest.importorskip("playwright.sync_api")
    if CHROMIUM is None:
        pytest.skip("no Chromium here")
    with playwright.sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield chromium
        chromium.close()


@dataclasses.dataclass
class Opened:
    page: Any
    errors: list[str]
    requests: list[str]

    def pixels(self, element: str = "#floor") -> bytes:
        return bytes(self.page.locator(element).screenshot())

    def until(self, condition: str) -> None:
        """Wait; the page's own policy forbids Playwright's way of waiting for a condition."""
        for _ in range(200):
            if self.page.evaluate(condition):
                return
            self.page.wait_for_timeout(50)
        pytest.fail(f"It never came to this: {condition}")

    def time(self) -> float:
        return float(self.page.evaluate("player.time"))


@pytest.fixture
def opened(browser: Any, episode: Episode, tmp_path: Path) -> Iterator[Opened]:
    path = write_replay(episode, tmp_path / "replay.html")
    context = browser.new_context(viewport={"width": 1000, "height": 760}, offline=True)
    page = context.new_page()
    told = Opened(page, [], [])
    page.on("console", lambda message: told.errors.append(message.text))
    page.on("pageerror", lambda error: told.errors.append(str(error)))
    page.on("request", lambda request: told.requests.append(request.url))
    page.goto(path.as_uri())
    page.wait_for_selector("html[data-ready]")
    yield told
    assert told.errors == []
    assert told.requests == [path.as_uri()]
    context.close()


def test_it_plays_and_pauses(opened: Opened) -> None:
    before = opened.pixels()
    opened.page.click("#play")
    opened.until("player.time > 1")
    opened.page.click("#play")
    paused = opened.time()
    assert paused > 1
    assert opened.pixels() != before
    opened.page.wait_for_timeout(200)
    assert opened.time() == paused
    assert "Chance of capture" in opened.page.inner_text("#told")


def test_it_plays_to_the_capture_and_stops(opened: Opened) -> None:
    opened.page.select_option("#speed", "50")
    opened.page.click("#play")
    opened.until("player.time === player.episode.end && !player.playing")
    assert "Captured by robot 2 in cell 5" in opened.page.inner_text("#told")


def test_it_scrubs_and_steps(opened: Opened) -> None:
    start = opened.pixels()
    opened.page.fill("#scrub", "6")
    assert opened.time() == pytest.approx(6.0)
    middle = opened.pixels()
    assert middle != start
    opened.page.click("#ahead")
    assert opened.time() == pytest.approx(6.1)
    opened.page.click("#back")
    assert opened.pixels() == middle
    assert opened.page.get_attribute("#scrub", "aria-valuetext") == "6.0 s"


@pytest.mark.parametrize(
    ("key", "time"), [("ArrowRight", 0.1), ("Shift+ArrowRight", 1.0), ("End", 12.0), ("Home", 0.0)]
)
def test_keys_move_through_time(opened: Opened, key: str, time: float) -> None:
    opened.page.keyboard.press(key)
    assert opened.time() == pytest.approx(time, abs=1e-6)


def test_space_plays_wherever_the_focus_is(opened: Opened) -> None:
    for focus in ("#floor", "#scrub", "#play"):
        opened.page.focus(focus)
        opened.page.keyboard.press("Space")
        assert opened.page.evaluate("player.playing"), focus
        opened.page.keyboard.press("Space")
        assert not opened.page.evaluate("player.playing"), focus


@pytest.mark.parametrize("layer", ["belief", "sight", "plans", "trails", "evader", "numbers"])
def test_each_layer_can_be_switched(opened: Opened, layer: str) -> None:
    opened.page.fill("#scrub", "4")
    before = opened.pixels()
    opened.page.click(f"[data-layer={layer}]")
    after = opened.pixels()
    assert after != before
    opened.page.click(f"[data-layer={layer}]")
    assert opened.pixels() == before


def test_a_cell_tells_its_chance(opened: Opened, episode: Episode) -> None:
    x, y = opened.page.evaluate("player.scene.pixel([100, 500]).map((v) => v / devicePixelRatio)")
    box = opened.page.locator("#floor").bounding_box()
    opened.page.mouse.move(box["x"] + x, box["y"] + y)
    share = episode.beliefs[0, 1] / (1 - episode.beliefs[0, 0])
    assert opened.page.inner_text("#tip") == f"cell 1: {100 * share:.0f} % if not captured"
    opened.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] + 60)
    assert opened.page.locator("#tip").is_hidden()


def test_a_touch_tells_it_too(browser: Any, episode: Episode, tmp_path: Path) -> None:
    path = write_replay(episode, tmp_path / "replay.html")
    context = browser.new_context(viewport={"width": 390, "height": 780}, has_touch=True, is_mobile=True)
    page = context.new_page()
    page.goto(path.as_uri())
    page.wait_for_selector("html[data-ready]")
    x, y = page.evaluate("player.scene.pixel([100, 500]).map((v) => v / devicePixelRatio)")
    box = page.locator("#floor").bounding_box()
    page.touchscreen.tap(box["x"] + x, box["y"] + y)
    page.wait_for_selector("#tip:not([hidden])")
    assert page.inner_text("#tip").startswith("cell 1:")
    context.close()


def test_the_table_lists_the_most_probable_cells(opened: Opened) -> None:
    opened.page.keyboard.press("End")
    opened.page.click("#table summary")
    opened.page.wait_for_selector("#table tbody tr")
    assert opened.page.inner_text("#table tbody tr:first-child td:first-child") == "1"


def test_light_and_dark(opened: Opened) -> None:
    before = opened.pixels()
    opened.page.keyboard.press("d")
    assert opened.page.get_attribute("html", "data-theme") == "dark"
    assert opened.pixels() != before


def test_it_fits_a_phone(opened: Opened) -> None:
    opened.page.set_viewport_size({"width": 360, "height": 700})
    opened.until("document.getElementById('floor').clientWidth < 360")
    assert opened.page.evaluate("document.documentElement.scrollWidth") <= 360
    assert opened.page.locator("#play").bounding_box()["height"] >= 34


@pytest.mark.parametrize(
    ("reach", "heading", "field"), [(np.inf, 0.0, 2 * np.pi), (3.0, 0.0, 2 * np.pi), (6.0, 2.5, 2.0)]
)
def test_the_page_sees_what_the_frames_see(
    opened: Opened, episode: Episode, reach: float, heading: float, field: float
) -> None:
    walls = Walls(episode.plan)
    for eye in episode.pursuers[::20].reshape(-1, 2):
        here = shapely.Polygon(walls.seen_from(eye, reach, heading, field)).buffer(0)
        limit = "Infinity" if np.isinf(reach) else 100 * reach
        call = f"player.scene.walls.seenFrom([{100 * eye[0]}, {100 * eye[1]}], {limit}, {heading}, {field})"
        there = shapely.Polygon(np.array(opened.page.evaluate(call)) / 100).buffer(0)
        assert here.symmetric_difference(there).area < 1e-2


def test_the_video_plays_in_a_browser(browser: Any, episode: Episode, tmp_path: Path) -> None:
    write_video(episode, tmp_path / "a.mp4", size=(640, 360), speedup=8.0)
    (tmp_path / "page.html").write_text('<video id="v" src="a.mp4" muted width="640" height="360"></video>')
    page = browser.new_page()
    page.goto((tmp_path / "page.html").as_uri())
    page.wait_for_function("v.readyState >= 2")
    assert page.evaluate("[v.videoWidth, v.videoHeight]") == [640, 360]
    assert page.evaluate("v.duration") == pytest.approx(12 / 8 + 2, abs=0.1)
    before = page.locator("#v").screenshot()
    page.evaluate("v.play()")
    page.wait_for_function("v.currentTime > 0.5")
    assert page.locator("#v").screenshot() != before
    page.close()
