"""Which times of an episode the frames of a video show, and the frames as files."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from geomsim.drawing.frame import FrameDrawer, FrameStyle
from geomsim.drawing.strokes import Image
from geomsim.drawing.theme import DrawingError
from geomsim.episode import Episode
from geomsim.files import output_folder, replacing

__all__ = ["Playback", "Progress", "write_frames", "write_png"]

Progress = Callable[[float, float], None]

# A video that nobody chose a speed for lasts no longer than this, in seconds, and plays at one of these speeds.
_LONGEST = 40.0
_SPEEDS = (2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 15.0, 20.0, 30.0, 40.0, 50.0, 60.0, 80.0, 100.0)

# How long the last frame stands, in seconds of the video.
_HOLD = 2.0


@dataclass(frozen=True, slots=True)
class Playback:
    """Frames of a video.

    Attributes
    ----------
    fps : int
        Frames in a second of the video.
    speedup : float
        Seconds of the episode in a second of the video.
    times : ndarray, shape (k,)
        Time of the episode that each frame shows; the last ones show its end.
    """

    fps: int
    speedup: float
    times: NDArray[np.float64]

    @classmethod
    def of(cls, episode: Episode, fps: int = 25, speedup: float | None = None, length: float | None = None) -> Playback:
        """Plan the frames of an episode.

        Parameters
        ----------
        episode : Episode
            The record.
        fps : int
            Frames in a second, 1 to 240.
        speedup : float, optional
            Seconds of the episode in a second of the video. By default a round number with which the video lasts
            40 s at most.
        length : float, optional
            Instead of ``speedup``: how long the video lasts with the stand at its end, seconds.

        Raises
        ------
        DrawingError
            If one of them is out of range.
        """
        if not 1 <= fps <= 240:
            raise DrawingError(f"A video has 1 to 240 frames a second, not {fps}.")
        lasts = float(episode.times[-1])
        if length is not None:
            if speedup is not None:
                raise DrawingError("A video can be given a speed-up or a length, not both.")
            if not _HOLD < length < np.inf:
                raise DrawingError(f"A video lasts more than {_HOLD:g} s, the stand at its end, not {length:g} s.")
            speedup = max(lasts, 1e-9) / (length - _HOLD)
        if speedup is None:
            speedup = next((s for s in _SPEEDS if lasts / s <= _LONGEST), lasts / _LONGEST)
        if not 0 < speedup < np.inf:
            raise DrawingError(f"The speed-up of a video must be a positive number, not {speedup:g}.")
        moving = np.arange(0.0, lasts, speedup / fps)
        return cls(fps, speedup, np.append(moving, np.full(round(_HOLD * fps) + 1, lasts)))

    @property
    def note(self) -> str:
        """What to say of the speed in the picture."""
        return f"speed \u00d7{self.speedup:.3g}"


def write_frames(
    episode: Episode,
    folder: Path,
    *,
    style: FrameStyle | None = None,
    fps: int = 25,
    speedup: float | None = None,
    progress: Progress | None = None,
) -> Path:
    """Write every frame of a video as a numbered PNG file.

    Parameters
    ----------
    episode : Episode
        The record.
    folder : Path
        Where to; made if it is not there. Files are called ``frame_00000.png`` and so on.
    style : FrameStyle, optional
        How they look.
    fps, speedup : int and float
        As for :func:`geomsim.video.write_video`; the last frame is there once.
    progress : callable, optional
        Called with the number of frames done and in all.

    Returns
    -------
    Path
        The folder.

    Raises
    ------
    GeomsimError
        If the folder cannot be written.
    """
    playback = Playback.of(episode, fps, speedup)
    times = np.unique(playback.times)
    drawer = FrameDrawer(episode, replace(style or FrameStyle(), note=""))
    folder = output_folder(folder)
    for k, time in enumerate(times):
        write_png(drawer.draw(float(time)), folder / f"frame_{k:05d}.png")
        if progress is not None:
            progress(k + 1, len(times))
    return folder


def write_png(image: Image, path: Path) -> Path:
    """Write an image, blue first, whole or not at all; GeomsimError if it cannot be written."""
    _, data = cv2.imencode(".png", image, [cv2.IMWRITE_PNG_COMPRESSION, 4])
    with replacing(path) as part:
        part.write_bytes(data.tobytes())
    return path
