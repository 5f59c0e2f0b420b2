"""``geomsim render``: pictures and video from a saved episode, without simulating again."""

from __future__ import annotations

from pathlib import Path

from geomsim.cli.console import say, say_json
from geomsim.cli.drawing import DrawFlags
from geomsim.cli.flags import JsonFlag, OutFlag

__all__ = ["render"]


def render(
    record: Path,
    *,
    out: OutFlag = None,
    json: JsonFlag = False,
    drawing: DrawFlags = DrawFlags(),  # noqa: B008 a frozen value without fields set
) -> int:
    """Draw a saved episode again.

    Parameters
    ----------
    record
        An `episode.npz` that `geomsim run` wrote.
    """
    from geomsim.episode import Episode
    from geomsim.files import output_folder

    drawing.check()
    episode = Episode.load(record)
    folder = output_folder(out or record.parent)
    files: dict[str, Path] = {}
    drawing.draw(episode, folder, files)
    if json:
        say_json({"files": {kind: str(path) for kind, path in files.items()}})
    else:
        for kind, path in files.items():
            say(f"{kind + ':':<10} {path}")
    return 0
