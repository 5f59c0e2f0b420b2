"""Video that browsers and slides play: H.264 in MP4, encoded by PyAV."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

import av
from av.video.reformatter import Colorspace

from geomsim.drawing.frame import FrameDrawer, FrameStyle
from geomsim.drawing.playback import Playback, Progress
from geomsim.drawing.strokes import Image
from geomsim.drawing.theme import DrawingError
from geomsim.episode import Episode
from geomsim.files import replacing

__all__ = ["write_video"]

# ITU-T H.273: BT.709 has number 1 as primaries, transfer and matrix.
_BT709 = 1


def write_video(
    episode: Episode,
    path: Path,
    *,
    size: tuple[int, int] = (1280, 720),
    fps: int = 25,
    speedup: float | None = None,
    theme: str = "light",
    style: FrameStyle | None = None,
    progress: Progress | None = None,
) -> Path:
    """Write a video of an episode; the capture stands for two seconds at its end.

    The file appears under its name only when it is complete. The same episode gives the same bytes.

    Parameters
    ----------
    episode : Episode
        The record.
    path : Path
        Where to; must end in ``.mp4``.
    size : tuple of int
        Width and height, even numbers of pixels.
    fps : int
        Frames in a second.
    speedup : float, optional
        Seconds of the episode in a second of the video. By default a round number with which the video lasts 40 s
        at most; the picture says which.
    theme : str
        "light" or "dark".
    style : FrameStyle, optional
        How frames look otherwise; its ``size``, ``theme`` and ``note`` do not count.
    progress : callable, optional
        Called with the number of frames done and in all.

    Raises
    ------
    GeomsimError
        If an option is out of range or the file cannot be written.
    """
    if path.suffix.lower() != ".mp4":
        raise DrawingError(f"A video's name must end in .mp4, but is {path.name!r}.")
    if size[0] % 2 or size[1] % 2:
        raise DrawingError(f"H.264 needs an even width and height, not {size[0]} x {size[1]}.")
    playback = Playback.of(episode, fps, speedup)
    drawer = FrameDrawer(episode, replace(style or FrameStyle(), size=size, theme=theme, note=playback.note))
    with replacing(path) as part:
        _encode(_frames(drawer, playback, progress), part, size, fps)
    return path


def _frames(drawer: FrameDrawer, playback: Playback, progress: Progress | None) -> Iterator[Image]:
    """Draw one after the other; the encoder's own threads work meanwhile."""
    for k, time in enumerate(playback.times):
        yield drawer.draw(float(time))
        if progress is not None:
            progress(k + 1, len(playback.times))


def _encode(images: Iterable[Image], path: Path, size: tuple[int, int], fps: int) -> None:
    # faststart: a browser can play before it has the whole file. bitexact: no version, no date in the file.
    with av.open(str(path), "w", format="mp4", options={"movflags": "+faststart", "fflags": "+bitexact"}) as out:
        stream = out.add_stream("libx264", rate=fps, options={"preset": "veryfast", "crf": "20", "flags": "+bitexact"})
        stream.width, stream.height = size
        stream.pix_fmt = "yuv420p"
        context = stream.codec_context
        context.thread_count = 2  # the bytes depend on it, so it is not left to the machine
        context.colorspace = context.color_primaries = context.color_trc = _BT709
        context.gop_size = 2 * fps  # a player can jump to any two seconds
        for image in images:
            frame = av.VideoFrame.from_ndarray(image, format="bgr24")
            out.mux(stream.encode(frame.reformat(format="yuv420p", dst_colorspace=Colorspace.ITU709)))
        out.mux(stream.encode(None))
