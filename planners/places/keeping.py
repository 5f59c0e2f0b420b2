"""What sees what, kept on disk: it depends on nothing but the plan and the places looked at."""

from __future__ import annotations

import hashlib
import os
import sys
import zipfile
from contextlib import suppress
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from discretize import WallGrid

__all__ = ["cache_folder", "sight_among"]

#: to be raised when lines of sight are judged in another way, so that older entries are made anew
_VERSION = 1

Seen = tuple[NDArray[np.int64], NDArray[np.int32]]


def cache_folder() -> Path:
    """Return where results are kept: ``$GEOMSIM_CACHE``, or the system's folder for caches."""
    told = os.environ.get("GEOMSIM_CACHE")
    if told:
        return Path(told)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local") / "geomsim" / "Cache"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "geomsim"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "geomsim"


def sight_among(
    walls: NDArray[np.float64], eyes: NDArray[np.float64], targets: NDArray[np.float64], reach: float
) -> Seen:
    """Find which targets each eye sees, or return what was found before and kept.

    An entry is named by a hash of all that it depends on; one that is damaged is made anew. A folder that cannot be
    written to only costs time.

    Parameters
    ----------
    walls : ndarray, shape (W, 2, 2)
        Metres.
    eyes, targets : ndarray, shape (K, 2) and (N, 2)
        Metres.
    reach : float
        No eye sees further than this, metres.

    Returns
    -------
    indptr, indices : ndarray
        As :func:`discretize.raycast.seen_among` gives them.
    """
    digest = hashlib.sha256(f"{_VERSION} {reach!r} {len(walls)} {len(eyes)} {len(targets)}".encode())
    for array in (walls, eyes, targets):
        digest.update(np.ascontiguousarray(array, dtype=np.float64).tobytes())
    path = cache_folder() / f"sight-{digest.hexdigest()[:32]}.npz"
    kept = _read(path, len(eyes), len(targets))
    if kept is not None:
        return kept
    from discretize.raycast import seen_among

    found = seen_among(WallGrid.of(walls), eyes, targets, reach)
    _write(path, found)
    return found


def _read(path: Path, eyes: int, targets: int) -> Seen | None:
    """Return an entry; None if there is none, or none that can be right."""
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as entry:
            indptr, indices = entry["indptr"], entry["indices"]
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        return None
    right = (
        (indptr.dtype, indptr.shape, indices.dtype, indices.ndim) == (np.int64, (eyes + 1,), np.int32, 1)
        and indptr[0] == 0
        and indptr[-1] == len(indices)
        and bool((np.diff(indptr) >= 0).all())
        and (len(indices) == 0 or 0 <= int(indices.min()) <= int(indices.max()) < targets)
    )
    return (indptr, indices) if right else None


def _write(path: Path, found: Seen) -> None:
    """Keep an entry; nobody ever meets half of one."""
    part = path.with_name(f".{path.stem}.{os.getpid()}.part.npz")
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        np.savez(part, indptr=found[0], indices=found[1])
        part.replace(path)
    with suppress(OSError):
        part.unlink(missing_ok=True)
