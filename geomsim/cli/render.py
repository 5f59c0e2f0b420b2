"""``geomsim render``: pictures and video from a saved episode, without simulating again."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from geomsim.cli.console import progress, say, say_json
from geomsim.cli.flags import JsonFlag, OutFlag

__all__ = ["render"]


def render(
    record: Path,
    *,
    video: Annotated[bool, Parameter(help="Write a video.")] = True,
    snapshots: Annotated[bool, Parameter(help="Write a contact sheet of snapshots.")] = True,
    frames: Annotated[bool, Parameter(negative="", help="Write every frame of the video as PNG.")] = False,
    out: OutFlag = None,
    json: JsonFlag = False,
) -> int:
    """Draw a saved episode again.

    Parameters
    ----------
    record
        An `episode.npz` that `geomsim run` wrote.
    """
    from geomsim.episode import Episode
    from geomsim.files import output_folder

    episode = Episode.load(record)
    folder = output_folder(out or record.parent)
    files: dict[str, Path] = {}
    if snapshots:
        files["snapshots"] = episode.save_snapshots(folder / "snapshots.png")
    if video:
        with progress("video") as bar:
            files["video"] = episode.save_video(folder / "pursuit.mp4", progress=bar)
    if frames:
        with progress("frames") as bar:
            files["frames"] = episode.save_frames(folder / "frames", progress=bar)
    if json:
        say_json({"files": {kind: str(path) for kind, path in files.items()}})
    else:
        for kind, path in files.items():
            say(f"{kind + ':':<10} {path}")
    return 0
