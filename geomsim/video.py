"""Videos of a pursuit: MP4 and WebM that browsers and slides play, and GIF that plays anywhere."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import av
from av.video.reformatter import Colorspace

from geomsim.drawing.frame import FrameDrawer, FrameStyle
from geomsim.drawing.palette import Palette
from geomsim.drawing.playback import Playback, Progress
from geomsim.drawing.strokes import Image
from geomsim.drawing.theme import DrawingError
from geomsim.episode import Episode
from geomsim.files import replacing
from maps import nearest

__all__ = ["FORMATS", "VideoFormat", "write_video"]

# ITU-T H.273: BT.709 has number 1 as primaries, transfer and matrix.
_BT709 = 1


@dataclass(frozen=True, slots=True)
class VideoFormat:
    """How one kind of video is encoded.

    Attributes
    ----------
    codec : str
        Name of FFmpeg's encoder.
    options : dict
        Of the encoder.
    container : dict
        Options of the container.
    size, fps : tuple of int, int
        What it has unless told otherwise.
    """

    codec: str
    options: dict[str, str]
    container: dict[str, str]
    size: tuple[int, int] = (1280, 720)
    fps: int = 25


# faststart: a browser can play before it has the whole file. bitexact: no version and no date in the file.
FORMATS = {
    ".mp4": VideoFormat("libx264", {"preset": "veryfast", "crf": "20"}, {"movflags": "+faststart"}),
    ".webm": VideoFormat(
        "libvpx-vp9",
        {"deadline": "realtime", "cpu-used": "8", "row-mt": "1", "tile-columns": "2", "crf": "30", "b": "0"},
        {},
    ),
    ".gif": VideoFormat("gif", {}, {"loop": "0"}, size=(800, 450), fps=10),
}


def write_video(
    episode: Episode,
    path: Path,
    *,
    size: tuple[int, int] | None = None,
    fps: int | None = None,
    speedup: float | None = None,
    length: float | None = None,
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
        Where to; ``.mp4`` (H.264), ``.webm`` (VP9) or ``.gif``.
    size : tuple of int, optional
        Width and height, even numbers of pixels; by default 1280 x 720, as GIF 800 x 450.
    fps : int, optional
        Frames in a second; by default 25, as GIF 10.
    speedup : float, optional
        Seconds of the episode in a second of the video. By default a round number with which the video lasts 40 s
        at most; the picture says which.
    length : float, optional
        Instead of ``speedup``: how long the video lasts, the two seconds at its end included, seconds.
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
    kind = FORMATS.get(path.suffix.lower())
    if kind is None:
        hint = nearest(path.suffix, FORMATS)
        raise DrawingError(f"A video cannot be written as {path.name!r}: {hint}")
    size = kind.size if size is None else size
    fps = kind.fps if fps is None else fps
    if size[0] % 2 or size[1] % 2:
        raise DrawingError(f"A video needs an even width and height, not {size[0]} x {size[1]}.")
    playback = Playback.of(episode, fps, speedup, length)
    drawer = FrameDrawer(episode, replace(style or FrameStyle(), size=size, theme=theme, note=playback.note))
    with replacing(path) as part:
        _encode(drawer, playback, kind, part, progress)
    return path


def _encode(drawer: FrameDrawer, playback: Playback, kind: VideoFormat, path: Path, progress: Progress | None) -> None:
    """Draw one frame after the other; the encoder's own threads work meanwhile."""
    convert = _converter(drawer, playback, kind)
    muxer = path.suffix[1:].lower()  # FFmpeg calls its muxers as the suffixes are
    with av.open(str(path), "w", format=muxer, options={**kind.container, "fflags": "+bitexact"}) as out:
        stream: Any = out.add_stream(kind.codec, rate=playback.fps, options={**kind.options, "flags": "+bitexact"})
        stream.width, stream.height = drawer.style.size
        context = stream.codec_context
        context.thread_count = 2  # the bytes depend on it, so it is not left to the machine
        if kind.codec == "gif":
            stream.pix_fmt = "pal8"
        else:
            stream.pix_fmt = "yuv420p"
            context.colorspace = context.color_primaries = context.color_trc = _BT709
            context.gop_size = 2 * playback.fps  # a player can jump to any two seconds
        for k, image in enumerate(_frames(drawer, playback)):
            out.mux(stream.encode(convert(image)))
            if progress is not None:
                progress(k + 1, len(playback.times))
        out.mux(stream.encode(None))


def _frames(drawer: FrameDrawer, playback: Playback) -> Iterator[Image]:
    for time in playback.times:
        yield drawer.draw(float(time))


def _converter(drawer: FrameDrawer, playback: Playback, kind: VideoFormat) -> Callable[[Image], av.VideoFrame]:
    if kind.codec == "gif":
        sample = playback.times[:: max(1, len(playback.times) // 16)]
        palette = Palette.of([drawer.draw(float(time)) for time in (*sample, playback.times[-1])])
        # PyAV's types know of no palette: it comes as a pair with the indices.
        paletted: Any = av.VideoFrame.from_ndarray
        return lambda image: paletted((palette.indices(image), palette.argb), format="pal8")
    return lambda image: av.VideoFrame.from_ndarray(image, format="bgr24").reformat(
        format="yuv420p", dst_colorspace=Colorspace.ITU709
    )
