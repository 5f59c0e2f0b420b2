"""Writing files so that nobody ever meets half of one."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from maps import GeomsimError

__all__ = ["OutputError", "output_folder", "replacing", "write_text"]


class OutputError(GeomsimError):
    """Something cannot be written; the message names the file and the system's reason."""


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a temporary name beside ``path``, moved there when the block ends well and deleted when it does not.

    Parameters
    ----------
    path : Path
        The file to write. The temporary name has the same suffix.

    Raises
    ------
    OutputError
        If the system refuses, for want of room or permission, say.
    """
    part = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
    try:
        yield part
        part.replace(path)
    except OSError as exc:
        raise OutputError(f"Cannot write {path}: {exc.strerror or exc}.") from exc
    finally:
        with suppress(OSError):  # the folder may be none
            part.unlink()


def output_folder(path: Path) -> Path:
    """Make a folder for results, or find that it cannot be written before hours of work are lost on it.

    Raises
    ------
    OutputError
        If it cannot be made or written.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
        probe = path / f".{os.getpid()}.part"
        probe.touch()
        probe.unlink()
    except OSError as exc:
        raise OutputError(f"Cannot write into the output folder {path}: {exc.strerror or exc}.") from exc
    return path


def write_text(path: Path, text: str) -> Path:
    """Write a text file whole or not at all; OutputError if it cannot be written."""
    with replacing(path) as part:
        part.write_text(text, encoding="utf-8")
    return path
