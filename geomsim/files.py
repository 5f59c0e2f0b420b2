"""Writing files so that nobody ever meets half of one."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from maps import GeomsimError

__all__ = ["OutputError", "default_folder", "output_folder", "replacing", "results_folder", "write_text"]


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


def default_folder(name: str, suffix: str) -> Path:
    """Return the folder for the results of a plan where the user names none: one below ``geomsim-output``.

    A plan's name comes from a file that anybody may have written, so what could lead elsewhere or break a line in it
    is replaced, and a name longer than file systems take is cut.
    """
    plain = "".join(c if c.isprintable() and c not in '/\\:*?"<>|' else "_" for c in name)
    return Path("geomsim-output") / f"{plain.encode()[:100].decode(errors='ignore').lstrip('.') or 'plan'}-{suffix}"


@contextmanager
def results_folder(path: Path) -> Iterator[Path]:
    """Give a folder for results as :func:`output_folder` does; where the block fails, folders made for it go again.

    A folder that holds something by then stays.

    Raises
    ------
    OutputError
        If it cannot be made or written.
    """
    new = [folder for folder in (path, *path.parents) if _missing(folder)]
    try:
        yield output_folder(path)
    except BaseException:
        for folder in new:
            with suppress(OSError, ValueError):  # it holds something, or never was
                folder.rmdir()
        raise


def _missing(folder: Path) -> bool:
    try:
        return not folder.exists()
    except OSError:  # making it will tell why
        return True


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
    except (OSError, ValueError) as exc:  # a ValueError is a name with a null character
        reason = getattr(exc, "strerror", None) or exc
        raise OutputError(f"Cannot write into the output folder {path}: {reason}.") from exc
    return path


def write_text(path: Path, text: str) -> Path:
    """Write a text file whole or not at all; OutputError if it cannot be written."""
    with replacing(path) as part:
        part.write_text(text, encoding="utf-8")
    return path
