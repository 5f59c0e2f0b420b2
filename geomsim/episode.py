"""One pursuit as it happened: the record that pictures, video and analysis are made from."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from discretize import CellMap
from maps import FloorPlan

__all__ = ["Episode", "Outcome", "Status"]


class Status(Enum):
    """How a pursuit ended; the value is the sentence's beginning."""

    CAPTURED = "captured"
    TIME_LIMIT = "not captured within the time limit"
    INTERRUPTED = "interrupted"


@dataclass(frozen=True, slots=True)
class Outcome:
    """The result of a pursuit.

    Attributes
    ----------
    status : Status
        How it ended.
    time : float
        When it ended, seconds; the capture time if captured.
    pursuer : int or None
        Who captured, counted from 0.
    position : tuple of float or None
        Where the evader was when captured, metres.
    cell : int or None
        The cell it was captured in, counted from 0.
    predicted : float
        The chance of capture by then that the belief predicted: p0 after its last step.
    notes : tuple of str
        What a person should know of the run, a sentence each; a body that was held up, for instance.
    """

    status: Status
    time: float
    pursuer: int | None
    position: tuple[float, float] | None
    cell: int | None
    predicted: float
    notes: tuple[str, ...] = ()

    @property
    def captured(self) -> bool:
        """Whether the evader was captured."""
        return self.status is Status.CAPTURED


@dataclass(frozen=True, slots=True)
class Episode:
    """A whole pursuit of R pursuers, T physics steps, B belief steps, N cells and K decisions.

    Attributes
    ----------
    scenario : dict
        Everything needed to repeat it; keys as in a scenario file.
    plan : FloorPlan
        Where it took place.
    cells : CellMap
        How the plan was cut.
    times : ndarray, shape (T,)
        Seconds; the first is 0.
    pursuers : ndarray, shape (T, R, 2)
        Positions, metres.
    headings : ndarray, shape (T, R)
        Directions of travel, radians, counterclockwise from the x axis; a robot that stands keeps its last one.
    pursuer_cells : ndarray of int32, shape (T, R)
        Cell that each pursuer is in, counted from 0.
    evader : ndarray, shape (T, 2)
        Positions, metres.
    evader_cells : ndarray of int32, shape (T,)
        Cell that the evader is in, counted from 0.
    belief_times : ndarray, shape (B,)
        Seconds; the first is 0.
    beliefs : ndarray, shape (B, N + 1)
        Belief after each of its steps; index 0 is the capture state.
    decision_times : ndarray, shape (K,)
        When a pursuer chose a path, seconds, not falling.
    decision_pursuers : ndarray of int32, shape (K,)
        Who chose, counted from 0.
    decision_paths : tuple of ndarray of int32, length K
        What was chosen: cells to visit, counted from 0, the next one first.
    outcome : Outcome
        How it ended.
    """

    scenario: dict[str, Any]
    plan: FloorPlan
    cells: CellMap
    times: NDArray[np.float64]
    pursuers: NDArray[np.float64]
    headings: NDArray[np.float64]
    pursuer_cells: NDArray[np.int32]
    evader: NDArray[np.float64]
    evader_cells: NDArray[np.int32]
    belief_times: NDArray[np.float64]
    beliefs: NDArray[np.float64]
    decision_times: NDArray[np.float64]
    decision_pursuers: NDArray[np.int32]
    decision_paths: tuple[NDArray[np.int32], ...]
    outcome: Outcome

    def __str__(self) -> str:
        out = self.outcome
        if out.captured and out.pursuer is not None and out.cell is not None:
            return f"captured after {out.time:.1f} s by pursuer {out.pursuer + 1}, in cell {out.cell + 1}"
        return f"{out.status.value}, {out.time:.1f} s"

    def save(self, path: str | Path) -> Path:
        """Write the record as a compressed ``.npz`` without pickles; see :mod:`geomsim.record`."""
        from geomsim.record import write_record

        return write_record(self, Path(path))

    @staticmethod
    def load(path: str | Path) -> Episode:
        """Read a record that :meth:`save` wrote."""
        from geomsim.record import read_record

        return read_record(Path(path))

    def save_video(self, path: str | Path, **options: Any) -> Path:
        """Write a video; see :func:`geomsim.video.write_video` for the options."""
        from geomsim.video import write_video

        return write_video(self, Path(path), **options)

    def save_snapshots(self, path: str | Path, **options: Any) -> Path:
        """Write a contact sheet of snapshots; see :func:`geomsim.snapshots.write_snapshots` for the options."""
        from geomsim.snapshots import write_snapshots

        return write_snapshots(self, Path(path), **options)

    def save_frames(self, folder: str | Path, **options: Any) -> Path:
        """Write every frame of the video as a PNG; see :func:`geomsim.drawing.write_frames` for the options."""
        from geomsim.drawing import write_frames

        return write_frames(self, Path(folder), **options)

    def save_replay(self, path: str | Path) -> Path:
        """Write a web page that plays the episode; see :func:`geomsim.replay.write_replay`."""
        from geomsim.replay import write_replay

        return write_replay(self, Path(path))
