"""The page as one file: template, style, program and record put together."""

from __future__ import annotations

import base64
import gzip
import html
import json
from importlib.resources import files
from pathlib import Path

from geomsim.drawing.theme import THEMES, DrawingError, Theme
from geomsim.episode import Episode
from geomsim.files import write_text
from geomsim.replay.payload import payload

__all__ = ["replay_page", "write_replay"]

_SCRIPTS = ("record.js", "sight.js", "scene.js", "controls.js")


def write_replay(episode: Episode, path: Path) -> Path:
    """Write an episode as a self-contained web page.

    Parameters
    ----------
    episode : Episode
        The record.
    path : Path
        Where to; must end in ``.html``.

    Raises
    ------
    GeomsimError
        If the file cannot be written.
    """
    if path.suffix.lower() not in (".html", ".htm"):
        raise DrawingError(f"A replay's name must end in .html, but is {path.name!r}.")
    return write_text(path, replay_page(episode))


def replay_page(episode: Episode) -> str:
    """Return the text of the page; the same episode gives the same text."""
    text = json.dumps(payload(episode), separators=(",", ":"), allow_nan=False)
    packed = base64.b64encode(gzip.compress(text.encode(), mtime=0)).decode()
    fields = {
        "title": html.escape(f"{episode.plan.name}: pursuit"),
        "summary": html.escape(_summary(episode)),
        "style": "\n".join([_variables(), _asset("replay.css")]),
        "script": "\n".join(_asset(name) for name in _SCRIPTS),
        "record": packed,
    }
    page = _asset("replay.html")
    for key, value in fields.items():
        page = page.replace(f"<!--{key}-->", value)
    return page


def _asset(name: str) -> str:
    return files("geomsim.replay").joinpath("assets", name).read_text(encoding="utf-8")


def _variables() -> str:
    """Themes as CSS variables, dark where the reader's system asks for it."""

    def rules(theme: Theme) -> str:
        keys = ("page", "text", "muted", "grid", "evader", "curve")
        return "".join(f"--{key}:{getattr(theme, key)};" for key in keys) + f"color-scheme:{theme.name};"

    light, dark = rules(THEMES["light"]), rules(THEMES["dark"])
    return f':root{{{light}}}\n:root[data-theme="dark"]{{{dark}}}'


def _summary(episode: Episode) -> str:
    robots = episode.pursuers.shape[1]
    who = f"{robots} robot{'s' * (robots != 1)} in {len(episode.cells)} cells"
    return f"{who}: {episode}."
