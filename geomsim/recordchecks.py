"""What must hold of an episode read from a file before anything is drawn or counted from it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geomsim.episode import Episode

__all__ = ["PLAIN", "check_shapes", "check_types", "check_values"]

#: arrays that are fields of an episode, with their types
PLAIN = {
    "times": np.float64,
    "pursuers": np.float64,
    "headings": np.float64,
    "pursuer_cells": np.int32,
    "evaders": np.float64,
    "evaders_cells": np.int32,
    "belief_times": np.float64,
    "beliefs": np.float64,
    "own_beliefs": np.float64,
    "decision_times": np.float64,
    "decision_pursuers": np.int32,
}
#: the other numbers in a record
_PACKED = {
    "decision_paths": np.int32,
    "decision_splits": np.int64,
    "checkpoints": np.float64,
    "portal_cells": np.int32,
    "portal_segments": np.float64,
    "portal_points": np.float64,
    "portal_legs": np.float64,
    "portal_splits": np.int64,
}


def check_types(arrays: Mapping[str, NDArray[Any]]) -> None:
    """Raise a ValueError if an array has another type than it was written with, or a number that is none."""
    for name, kind in (PLAIN | _PACKED).items():
        if arrays[name].dtype != kind:
            raise ValueError(f"{name} holds {arrays[name].dtype}, not {np.dtype(kind)}")
        # a cell that no body can enter has no checkpoint
        if name != "checkpoints" and not np.isfinite(arrays[name]).all():
            raise ValueError(f"{name} holds numbers that are not finite")


def check_shapes(episode: Episode) -> None:
    """Raise a ValueError if the lengths of two arrays do not fit together."""
    t, b, k = (a.size for a in (episode.times, episode.belief_times, episode.decision_times))
    n = len(episode.cells)
    r = episode.pursuers.shape[1] if episode.pursuers.ndim == 3 else -1
    e = episode.evaders.shape[1] if episode.evaders.ndim == 3 else -1
    minds = r if episode.own_beliefs.size else 0
    expected = {
        "times": (t,),
        "pursuers": (t, r, 2),
        "headings": (t, r),
        "pursuer_cells": (t, r),
        "evaders": (t, e, 2),
        "evaders_cells": (t, e),
        "belief_times": (b,),
        "beliefs": (b, n + 1),
        "own_beliefs": (b, minds, n + 1),
        "decision_times": (k,),
        "decision_pursuers": (k,),
    }
    for name, shape in expected.items():
        found = getattr(episode, name).shape
        if found != shape:
            raise ValueError(f"{name} has shape {found}, not {shape}")
    if episode.cells.checkpoints.shape != (n, 2) or len(episode.cells.names) != n:
        raise ValueError(f"there are {n} cells, but not as many checkpoints and names")
    if t == 0 or b == 0 or r < 1 or e < 1 or len(episode.decision_paths) != k:
        raise ValueError("it holds no time steps, no pursuers, no evader or too few paths")


def check_values(episode: Episode) -> None:
    """Raise a ValueError if times fall, or numbers of cells, places or probabilities are out of range."""
    n, out = len(episode.cells), episode.outcome
    r, e = episode.pursuers.shape[1], episode.evaders.shape[1]
    for name in ("times", "belief_times", "decision_times"):
        times = getattr(episode, name)
        if np.any(np.diff(times, prepend=0.0) < 0):
            raise ValueError(f"{name} fall")
    numbers = {
        "pursuer_cells": (episode.pursuer_cells, n),
        "evaders_cells": (episode.evaders_cells, n),
        "decision_pursuers": (episode.decision_pursuers, r),
        "decision_paths": (np.concatenate([*episode.decision_paths, np.empty(0, np.int32)]), n),
        "portals": (np.array(episode.cells.edges, dtype=np.int32), n),
        "the outcome's cell": (_if_any(out.cell), n),
        "the outcome's pursuer": (_if_any(out.pursuer), r),
        "the captures' cells": (np.array([capture.cell for capture in out.earlier], np.int32), n),
        "the captures' pursuers": (np.array([capture.pursuer for capture in out.earlier], np.int32), r),
        "the captures' evaders": (np.array([out.evader, *(c.evader for c in out.earlier)], np.int32), e),
    }
    for name, (found, count) in numbers.items():
        if np.any((found < 0) | (found >= count)):
            raise ValueError(f"{name} holds numbers that are not from 0 to {count - 1}")
    for name in ("beliefs", "own_beliefs"):
        values = getattr(episode, name)
        if np.any((values < 0) | (values > 1 + 1e-6)):
            raise ValueError(f"{name} holds numbers that are no probabilities")
    if not all(isinstance(cell, shapely.Polygon) and not cell.is_empty for cell in episode.cells.cells):
        raise ValueError("a cell is no polygon")
    x0, y0, x1, y1 = episode.plan.bounds
    places = np.concatenate([episode.pursuers.reshape(-1, 2), episode.evaders.reshape(-1, 2)])
    if np.any((places < (x0, y0)) | (places > (x1, y1))):
        raise ValueError("a robot or the evader is outside the plan")


def _if_any(number: int | None) -> NDArray[np.int32]:
    return np.array([] if number is None else [number], dtype=np.int32)
