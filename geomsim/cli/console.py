"""What commands say: sentences and progress on stderr, results on stdout."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

__all__ = ["complain", "progress", "say", "say_json"]


def complain(sentence: str) -> None:
    """Print one sentence on stderr."""
    sys.stderr.write(f"geomsim: {sentence}\n")


def say(line: str) -> None:
    """Print one line of the result on stdout."""
    sys.stdout.write(line + "\n")


def say_json(result: dict[str, Any]) -> None:
    """Print one JSON object on stdout, on one line."""
    sys.stdout.write(json.dumps(result, allow_nan=False) + "\n")


@contextmanager
def progress(what: str) -> Iterator[Callable[[float, float], None] | None]:
    """Show a progress bar if stderr is a terminal.

    Yields a function of what is done and what there is to do in all, or None in a pipe.
    """
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)
