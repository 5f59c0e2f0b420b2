"""What every reader of floor plans must keep to: a check that users can run on their own."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from maps.errors import ConformanceError, GeomsimError
from maps.floorplan import FloorPlan
from maps.reading import Format

__all__ = ["check_format"]


def check_format(
    kind: Format, example: str | Path, rng: np.random.Generator, *, damages: int = 50, **options: Any
) -> None:
    """Check that a reader keeps the rules on an example file and on damaged copies of it.

    It must return a :class:`maps.FloorPlan`, the same one each time, and leave the file as it was. Of a file that is
    cut short, has wrong bytes in it or none at all it must make a plan or raise a GeomsimError, whose message is one
    short sentence; nothing else.

    Parameters
    ----------
    kind : Format
        What is checked.
    example : str or Path
        A file that it can read.
    rng : Generator
        Chooses the damages.
    damages : int
        Number of damaged copies.
    **options
        What the reader is given besides the path, such as ``resolution``.

    Raises
    ------
    ConformanceError
        At the first rule that is broken.
    """
    example = Path(example)
    content = example.read_bytes()
    first, again = (_read(kind, example, "a whole file", options) for _ in range(2))
    for plan in (first, again):
        if isinstance(plan, GeomsimError):
            raise ConformanceError(f"The reader of {kind.name!r} cannot read {example}: {plan}") from plan
        if not isinstance(plan, FloorPlan):
            raise ConformanceError(f"The reader of {kind.name!r} returns a {type(plan).__name__}, not a FloorPlan.")
    if not first.space.equals_exact(again.space, 0.0):
        raise ConformanceError(f"The reader of {kind.name!r} makes another plan of {example} when it reads it again.")
    if example.read_bytes() != content:
        raise ConformanceError(f"The reader of {kind.name!r} changes the file that it reads.")
    with TemporaryDirectory() as folder:
        copy = Path(folder) / example.name
        for k in range(damages):
            what, damaged = _damaged(content, rng, k)
            copy.write_bytes(damaged)
            plan = _read(kind, copy, what, options)
            if isinstance(plan, GeomsimError) and ("\n" in str(plan) or len(str(plan)) > 1000):
                raise ConformanceError(f"The reader of {kind.name!r} says of {what} more than a sentence: {plan}")


def _read(kind: Format, path: Path, what: str, options: dict[str, Any]) -> Any:
    """Return what the reader makes of a file, or its own error."""
    try:
        return kind.read(path, **options)
    except GeomsimError as exc:
        return exc
    except Exception as exc:
        raise ConformanceError(
            f"The reader of {kind.name!r} raises {type(exc).__name__} of {what}, which is no GeomsimError: {exc}"
        ) from exc


def _damaged(content: bytes, rng: np.random.Generator, k: int) -> tuple[str, bytes]:
    if k == 0 or not content:
        return "an empty file", b""
    at = int(rng.integers(len(content)))
    if k % 2:
        return f"a file cut short after {at} bytes", content[:at]
    wrong = bytes(rng.integers(0, 256, int(rng.integers(1, 9)), dtype=np.uint8))
    return f"a file with wrong bytes at {at}", content[:at] + wrong + content[at + len(wrong) :]
