"""Videos, frames and contact sheets as files: what is in them, and what is left when writing fails."""

import dataclasses
from pathlib import Path

import av
import cv2
import numpy as np
import pytest
import shapely

from discretize import CellMap
from geomsim.drawing import FrameDrawer, FrameStyle, draw_cells, write_cells_picture, write_frames
from geomsim.drawing.colours import bgr
from geomsim.drawing.playback import Playback
from geomsim.drawing.theme import THEMES
from geomsim.episode import Episode
from geomsim.snapshots import draw_snapshots, snapshot_times, write_snapshots
from geomsim.video import write_video
from maps import GeomsimError, Repair

SMALL = (640, 360)


def decoded(path: Path) -> list[np.ndarray]:
    with av.open(str(path)) as video:
        return [frame.to_ndarray(format="bgr24", src_colorspace="ITU709") for frame in video.decode(video=0)]


def test_the_video_shows_the_frames_that_were_drawn(episode: Episode, tmp_path: Path) -> None:
    path = write_video(episode, tmp_path / "a.mp4", size=SMALL, fps=10, speedup=4.0)
    with av.open(str(path)) as video:
        stream = video.streams.video[0]
        assert stream.codec_context.name == "h264"
        assert stream.codec_context.pix_fmt == "yuv420p"
        assert (stream.width, stream.height) == SMALL
        assert stream.average_rate == 10
    images = decoded(path)
    playback = Playback.of(episode, 10, 4.0)
    assert len(images) == len(playback.times) == 30 + 21
    drawer = FrameDrawer(episode, FrameStyle(size=SMALL, note=playback.note))
    for k in (0, 14, -1):
        gap = np.abs(images[k].astype(int) - drawer.draw(float(playback.times[k])))
        assert gap.mean() < 3.0
        # Flat colours come through as they were: the colour matrix is the one that the file names.
        assert np.abs(images[k][8:16, 300:340].astype(int) - bgr(THEMES["light"].page)).max() <= 3


@pytest.mark.parametrize(("name", "codec", "gap"), [("a.webm", "vp9", 4.0), ("a.gif", "gif", 2.0)])
def test_other_formats_show_the_same(episode: Episode, tmp_path: Path, name: str, codec: str, gap: float) -> None:
    options = {"size": SMALL, "fps": 10, "speedup": 8.0}
    path = write_video(episode, tmp_path / name, **options)
    with av.open(str(path)) as video:
        assert video.streams.video[0].codec_context.name == codec
        images = [frame.to_ndarray(format="bgr24") for frame in video.decode(video=0)]
    playback = Playback.of(episode, 10, 8.0)
    drawer = FrameDrawer(episode, FrameStyle(size=SMALL, note=playback.note))
    assert len(images) == len(playback.times)
    for k in (0, 7, -1):
        assert np.abs(images[k].astype(int) - drawer.draw(float(playback.times[k]))).mean() < gap
    assert path.read_bytes() == write_video(episode, tmp_path / f"b{path.suffix}", **options).read_bytes()


def test_a_video_lasts_as_long_as_it_is_told(episode: Episode) -> None:
    playback = Playback.of(episode, 25, length=5.0)
    assert len(playback.times) / 25 == pytest.approx(5.0, abs=0.1)
    assert playback.speedup == pytest.approx(4.0)


def test_a_player_need_not_wait_for_the_whole_file(episode: Episode, tmp_path: Path) -> None:
    data = write_video(episode, tmp_path / "a.mp4", size=SMALL, speedup=20.0).read_bytes()
    assert 0 < data.index(b"moov") < data.index(b"mdat")


def test_the_same_episode_gives_the_same_bytes(episode: Episode, tmp_path: Path) -> None:
    options = {"size": SMALL, "fps": 10, "speedup": 8.0}
    a, b = (write_video(episode, tmp_path / name, **options).read_bytes() for name in ("a.mp4", "b.mp4"))
    assert a == b


@pytest.mark.parametrize("seconds", [1.0, 60.0, 600.0, 1800.0, 40000.0])
def test_a_long_pursuit_makes_no_long_video(episode: Episode, seconds: float) -> None:
    long = dataclasses.replace(episode, times=episode.times * (seconds / episode.times[-1]))
    playback = Playback.of(long)
    assert len(playback.times) / playback.fps < 60
    assert playback.times[0] == 0
    assert np.all(playback.times[-2 * playback.fps :] == playback.times[-1])
    assert playback.times[-1] == pytest.approx(seconds)


def test_progress_counts_to_the_end(episode: Episode, tmp_path: Path) -> None:
    told: list[tuple[float, float]] = []
    write_video(
        episode,
        tmp_path / "a.mp4",
        size=SMALL,
        fps=5,
        speedup=10,
        progress=lambda done, all_: told.append((done, all_)),
    )
    assert [done for done, _ in told] == list(range(1, len(told) + 1))
    assert {total for _, total in told} == {len(told)}


class Stop(BaseException):
    """Stands for Ctrl-C."""


@pytest.mark.parametrize("error", [Stop, OSError])
def test_an_interrupted_video_leaves_nothing(episode: Episode, tmp_path: Path, error: type[BaseException]) -> None:
    def stop(done: float, _: float) -> None:
        if done == 5:
            raise error("stop")

    with pytest.raises((Stop, GeomsimError)):
        write_video(episode, tmp_path / "a.mp4", size=SMALL, progress=stop)
    assert list(tmp_path.iterdir()) == []


def test_a_failed_video_leaves_the_old_one(episode: Episode, tmp_path: Path) -> None:
    old = tmp_path / "a.mp4"
    old.write_bytes(b"old")

    def stop(*_: float) -> None:
        raise Stop

    with pytest.raises(Stop):
        write_video(episode, old, size=SMALL, progress=stop)
    assert old.read_bytes() == b"old"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no full disk to write to")
def test_a_full_disk_is_a_sentence(episode: Episode, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = av.open

    def full(_: str, *args: object, **options: object) -> object:
        return real("/dev/full", *args, **options)

    monkeypatch.setattr("geomsim.video.av.open", full)
    with pytest.raises(GeomsimError, match=r"Cannot write .*a\.mp4"):
        write_video(episode, tmp_path / "a.mp4", size=SMALL, fps=5, speedup=2.0)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("write", [write_video, write_snapshots, write_frames], ids=["video", "snapshots", "frames"])
def test_a_folder_that_is_none_is_a_sentence(episode: Episode, tmp_path: Path, write: object) -> None:
    (tmp_path / "file").write_text("not a folder")
    name = {write_video: "a.mp4", write_snapshots: "a.png"}.get(write, "frames")
    with pytest.raises(GeomsimError, match="Cannot write"):
        write(episode, tmp_path / "file" / name)


@pytest.mark.parametrize(
    ("name", "options", "word"),
    [
        ("a.webp", {}, "'.webm'"),
        ("a.mp4", {"size": (641, 360)}, "641"),
        ("a.mp4", {"fps": 0}, "not 0"),
        ("a.mp4", {"speedup": -1.0}, "-1"),
        ("a.mp4", {"length": 2.0}, "2 s"),
        ("a.mp4", {"length": 9.0, "speedup": 2.0}, "not both"),
        ("a.mp4", {"theme": "blue"}, "'blue'"),
    ],
)
def test_a_wrong_option_is_a_sentence(
    episode: Episode, tmp_path: Path, name: str, options: dict[str, object], word: str
) -> None:
    with pytest.raises(GeomsimError, match=word):
        write_video(episode, tmp_path / name, **options)
    assert list(tmp_path.iterdir()) == []


def test_frames_are_numbered_files(episode: Episode, tmp_path: Path) -> None:
    style = FrameStyle(size=SMALL)
    folder = write_frames(episode, tmp_path / "frames", style=style, fps=2, speedup=4.0)
    files = sorted(folder.iterdir())
    assert [f.name for f in files] == [f"frame_{k:05d}.png" for k in range(7)]
    drawer = FrameDrawer(episode, style)
    assert np.array_equal(cv2.imread(str(files[-1])), drawer.draw(12.0))
    assert np.array_equal(cv2.imread(str(files[2])), drawer.draw(4.0))


def test_the_contact_sheet_has_a_panel_for_each_time(episode: Episode, tmp_path: Path) -> None:
    path = write_snapshots(episode, tmp_path / "s.png", times=[0.0, 6.0, 12.0], width=900)
    sheet = cv2.imread(str(path))
    assert np.array_equal(sheet, draw_snapshots(episode, times=[0.0, 6.0, 12.0], width=900))
    evader = (sheet == bgr(THEMES["light"].evader)).all(axis=2).astype(np.uint8)
    grown = cv2.dilate(evader, np.ones((15, 15), np.uint8))  # a letter may cut the diamond in two
    assert cv2.connectedComponents(grown)[0] - 1 == 3


@pytest.mark.parametrize("panels", [1, 2, 5, 6, 9])
def test_snapshot_times_go_from_start_to_capture(episode: Episode, panels: int) -> None:
    times = snapshot_times(episode, None, panels)
    assert len(times) == panels
    assert times[-1] == pytest.approx(12.0)
    assert draw_snapshots(episode, panels=panels, width=700).shape[1] == 700


@pytest.mark.parametrize("options", [{"times": [13.0]}, {"times": [-1.0]}, {"times": []}, {"panels": 0}])
def test_wrong_snapshot_times_are_a_sentence(episode: Episode, options: dict[str, object]) -> None:
    with pytest.raises(GeomsimError):
        draw_snapshots(episode, **options)


def test_the_cells_picture_shows_cells_apart_and_repairs_in_red(cells: CellMap, tmp_path: Path) -> None:
    repair = Repair("filled", "Filled a pin-hole at (1, 4).", shapely.box(0.8, 3.8, 1.2, 4.2))
    repaired = dataclasses.replace(cells, plan=dataclasses.replace(cells.plan, repairs=(repair,)))
    plain, red = draw_cells(cells, width=800), draw_cells(repaired, width=800)
    assert np.array_equal(plain, draw_cells(cells, width=800))
    changed = red[100:].astype(int) - plain[100:]
    assert (changed[..., 0] < -100).any()  # blue and green give way
    assert (changed[..., 2] > -60).all()  # red does not
    path = write_cells_picture(cells, tmp_path / "c.png", width=800)
    assert np.array_equal(cv2.imread(str(path)), plain)
