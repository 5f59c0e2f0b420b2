"""What ``run`` and ``render`` draw of an episode, and the flags that say how."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cyclopts import Parameter

from geomsim.cli.console import progress
from maps import GeomsimError, nearest

if TYPE_CHECKING:
    from geomsim.drawing import FrameStyle
    from geomsim.episode import Episode

__all__ = ["DrawFlags"]

_VIDEOS = ("mp4", "webm", "gif")
_SHEETS = ("png", "svg", "pdf")


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class DrawFlags:
    """What to draw, and how.

    Attributes
    ----------
    video
        Write a video.
    snapshots
        Write a contact sheet of snapshots.
    replay
        Write a page to replay the pursuit in a browser.
    frames
        Write every frame of the video as PNG.
    cells_picture
        Write a picture of the cells with their numbers, portals and routes, in the format of the contact sheet.
    video_format
        mp4, webm or gif.
    snapshots_format
        png, svg or pdf.
    times
        When to take the snapshots, seconds, like 0,10,20. [default: six, evenly]
    fps
        Frames a second. [default: 25, of a gif 10]
    speedup
        How many times faster than life. [default: so that the video lasts 40 s at most]
    length
        How long the pursuit lasts in the video, seconds, instead of a speed-up.
    size
        Width and height of the video, pixels, like 1280x720. [default: 1280x720, of a gif 800x450]
    theme
        light or dark.
    hide_evader
        Do not show the evader before it is captured.
    numbers
        Show the number of each cell that has room for it, in video and frames.
    belief_of
        Number of the robot whose own belief the video shows, where every robot plans for itself. [default: what all
        robots have seen]
    """

    video: bool = True
    snapshots: bool = True
    replay: bool = True
    frames: bool = False
    cells_picture: bool = False
    video_format: str = "mp4"
    snapshots_format: str = "png"
    times: str | None = None
    fps: int | None = None
    speedup: float | None = None
    length: float | None = None
    size: str | None = None
    theme: str = "light"
    hide_evader: bool = False
    numbers: bool = False
    belief_of: int | None = None

    def check(self) -> None:
        """Refuse what cannot be drawn, before hours are spent on what there is to draw."""
        for flag, value, valid in (
            ("--video-format", self.video_format, _VIDEOS),
            ("--snapshots-format", self.snapshots_format, _SHEETS),
        ):
            if value not in valid:
                raise GeomsimError(f"{flag} is not {value!r}: {nearest(value, valid)}")
        if self.speedup is not None and self.length is not None:
            raise GeomsimError("--speedup and --length say the same in two ways: give one of them.")
        for flag, number in (("--fps", self.fps), ("--speedup", self.speedup), ("--length", self.length)):
            if number is not None and not 0 < number < float("inf"):
                raise GeomsimError(f"{flag} must be above 0 and finite, but is {number:g}.")
        self._times()
        self._style()

    def check_beliefs(self, robots: int) -> None:
        """Refuse to draw the own belief of a robot that will have none, of so many that have."""
        if self.belief_of is not None and not 1 <= self.belief_of <= robots:
            known = f"robots are numbered from 1 to {robots}" if robots else "one planner plans for all robots"
            raise GeomsimError(f"--belief-of {self.belief_of} asks for what no robot believes: {known}.")

    def draw(self, episode: Episode, folder: Path, files: dict[str, Path]) -> None:
        """Draw an episode into a folder; each file finished is entered into ``files``."""
        options: dict[str, Any] = {key: getattr(self, key) for key in ("fps", "speedup") if getattr(self, key)}
        options["style"] = self._style()
        if self.snapshots:
            sheet = folder / f"snapshots.{self.snapshots_format}"
            files["snapshots"] = episode.save_snapshots(sheet, times=self._times(), theme=self.theme)
        if self.cells_picture:
            from geomsim.drawing import write_cells_picture

            picture = folder / f"cells.{self.snapshots_format}"
            files["cells"] = write_cells_picture(episode.cells, picture, theme=self.theme)
        if self.replay:
            files["replay"] = episode.save_replay(folder / "replay.html")
        if self.video:
            with progress("video") as bar:
                clip = folder / f"pursuit.{self.video_format}"
                size = {"size": self._size()} if self.size else {}
                more = {"length": self.length} if self.length else {}
                files["video"] = episode.save_video(clip, progress=bar, **options, **size, **more)
        if self.frames:
            with progress("frames") as bar:
                files["frames"] = episode.save_frames(folder / "frames", progress=bar, **options)

    @staticmethod
    def clear(folder: Path) -> None:
        """Take away what an earlier run drew into a folder, which would pass for this one's."""
        for name in (
            "replay.html",
            *(f"pursuit.{suffix}" for suffix in _VIDEOS),
            *(f"{sheet}.{suffix}" for sheet in ("snapshots", "cells") for suffix in _SHEETS),
        ):
            (folder / name).unlink(missing_ok=True)
        for frame in (folder / "frames").glob("frame_*.png"):
            frame.unlink()

    def _style(self) -> FrameStyle:
        from geomsim.drawing import FrameStyle

        evader = "hidden" if self.hide_evader else "shown"
        return FrameStyle(
            size=self._size() or (1280, 720),
            theme=self.theme,
            evader=evader,
            numbers=self.numbers,
            belief_of=self.belief_of,
        )

    def _size(self) -> tuple[int, int] | None:
        if self.size is None:
            return None
        width, _, height = self.size.partition("x")
        if not (width.isdecimal() and height.isdecimal()) or max(int(width), int(height)) > 8192:
            raise GeomsimError(f"--size takes width and height like 1280x720, at most 8192 each, not {self.size!r}.")
        return int(width), int(height)

    def _times(self) -> tuple[float, ...] | None:
        if self.times is None:
            return None
        try:
            return tuple(float(part) for part in self.times.split(","))
        except ValueError:
            raise GeomsimError(f"--times takes seconds with commas between them, not {self.times!r}.") from None
