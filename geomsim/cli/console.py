"""What commands say: sentences and progress on stderr, results on stdout."""

from __future__ import annotations

import io
import json
import math
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

__all__ = ["complain", "finish_stdout", "progress", "say", "say_json", "speak_plainly", "tally"]

#: an error sentence longer than this loses its middle: a wrong value may be as long as a file
_LONGEST = 1000


def speak_plainly() -> None:
    """Let stdout and stderr show what their encoding has no signs for as escapes, instead of failing.

    A stderr that the caller has closed goes to nowhere: libraries write to it without asking.
    """
    if sys.stderr is None:
        sys.stderr = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115 (open until the end)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def complain(sentence: str) -> None:
    """Print one sentence on stderr, on one line whatever is quoted in it."""
    line = _one_line(" ".join(sentence.split()))
    if len(line) > _LONGEST:
        line = f"{line[: _LONGEST // 2]} ... {line[-_LONGEST // 2 :]}"
    if sys.stderr is not None:
        with suppress(OSError):  # nobody listens
            sys.stderr.write(f"geomsim: {line}\n")
            sys.stderr.flush()


def say(line: str) -> None:
    """Print one line of the result on stdout; nothing where stdout is closed."""
    if sys.stdout is not None:
        with _reader_may_be_gone():
            sys.stdout.write(_one_line(line) + "\n")


def say_json(result: dict[str, Any]) -> None:
    """Print one JSON object on stdout, on one line."""
    say(json.dumps(_without_infinity(result), allow_nan=False))


def _without_infinity(value: Any) -> Any:
    """Return a value with null for what has no limit, such as the range of one of several robots."""
    if isinstance(value, dict):
        return {key: _without_infinity(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_without_infinity(one) for one in value]
    return None if value == math.inf else value


def finish_stdout() -> None:
    """Hand over what was said.

    Raises
    ------
    OutputError
        If stdout cannot be written, a file on a full disk for instance.
    """
    if sys.stdout is not None:
        with _reader_may_be_gone():
            sys.stdout.flush()


@contextmanager
def _reader_may_be_gone() -> Iterator[None]:
    """Take it as no error if the reader of stdout has gone, like ``head``; what else fails is an OutputError."""
    try:
        yield
    except OSError as exc:
        # what is left in the buffer would fail again when Python exits
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(exc, BrokenPipeError):
            from geomsim.files import OutputError  # with all of maps, which help need not wait for

            raise OutputError(f"Cannot write to the standard output: {exc.strerror}.") from exc


def _one_line(text: str) -> str:
    """Show control characters as escapes: names come from files, and a terminal would obey them."""
    return "".join(c if c.isprintable() or c == " " else c.encode("unicode_escape").decode() for c in text)


@contextmanager
def progress(what: str) -> Iterator[Callable[[float, float], None] | None]:
    """Show a progress bar if stderr is a terminal.

    Yields a function of what is done and what there is to do in all, or None in a pipe.
    """
    if sys.stderr is None or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


@contextmanager
def tally() -> Iterator[Callable[[str, int, int], None] | None]:
    """Show one progress bar with the time left for each of several works, if stderr is a terminal.

    Yields a function of a work's name, what is done of it, and what there is to do; or None in a pipe.
    """
    if sys.stderr is None or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    tasks: dict[str, TaskID] = {}
    # no thread that refreshes it: workers are forked from this process
    with Progress(*columns, console=Console(stderr=True), transient=True, auto_refresh=False) as bar:

        def tell(name: str, done: int, total: int) -> None:
            if name not in tasks:
                tasks[name] = bar.add_task(name, total=total)
            bar.update(tasks[name], completed=done, refresh=True)

        yield tell
