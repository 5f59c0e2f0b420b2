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

__all__ = ["Capture", "Episode", "Outcome", "Status"]


class Status(Enum):
    """How a pursuit ended; the value is the sentence's beginning."""

    CAPTURED = "captured"
    TIME_LIMIT = "not captured within the time limit"
    INTERRUPTED = "interrupted"


@dataclass(frozen=True, slots=True)
class Capture:
    """One evader's capture.

    Attributes
    ----------
    evader : int
        Who was captured, counted from 0.
    time : float
        When, seconds.
    pursuer : int
        By whom, counted from 0.
    position : tuple of float
        Where the evader was, metres.
    cell : int
        In which cell, counted from 0.
    """

    evader: int
    time: float
    pursuer: int
    position: tuple[float, float]
    cell: int


@dataclass(frozen=True, slots=True)
class Outcome:
    """The result of a pursuit. With several evaders it ends, and counts as captured, when the last one is captured.

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
        The chance of capture by then that the belief predicted: p0 after its last step. The belief counts on same-cell
        capture, so where capture is by sight it predicts less than happens.
    notes : tuple of str
        What a person should know of the run, a sentence each; a body that was held up, for instance.
    evader : int
        Which one was captured last, counted from 0.
    earlier : tuple of Capture
        Captures of other evaders before that, in the order of time.
    """

    status: Status
    time: float
    pursuer: int | None
    position: tuple[float, float] | None
    cell: int | None
    predicted: float
    notes: tuple[str, ...] = ()
    evader: int = 0
    earlier: tuple[Capture, ...] = ()

    @property
    def captures(self) -> tuple[Capture, ...]:
        """All captures, in the order of time."""
        if self.pursuer is None or self.position is None or self.cell is None:
            return self.earlier
        return (*self.earlier, Capture(self.evader, self.time, self.pursuer, self.position, self.cell))

    @property
    def captured(self) -> bool:
        """Whether every evader was captured."""
        return self.status is Status.CAPTURED


@dataclass(frozen=True, slots=True)
class Episode:
    """A whole pursuit of R pursuers, E evaders, T physics steps, B belief steps, N cells and K decisions.

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
    evaders : ndarray, shape (T, E, 2)
        Positions, metres; a captured one stays where it was.
    evaders_cells : ndarray of int32, shape (T, E)
        Cell that each evader is in, counted from 0.
    belief_times : ndarray, shape (B,)
        Seconds; the first is 0.
    beliefs : ndarray, shape (B, N + 1)
        Belief after each of its steps, by the looks of all robots, on an evader that is still free; index 0 is the
        capture state.
    own_beliefs : ndarray, shape (B, R, N + 1)
        The same by the looks that each robot knows of; shape (B, 0, N + 1) where one planner plans for all.
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
    evaders: NDArray[np.float64]
    evaders_cells: NDArray[np.int32]
    belief_times: NDArray[np.float64]
    beliefs: NDArray[np.float64]
    own_beliefs: NDArray[np.float64]
    decision_times: NDArray[np.float64]
    decision_pursuers: NDArray[np.int32]
    decision_paths: tuple[NDArray[np.int32], ...]
    outcome: Outcome

    @property
    def evader(self) -> NDArray[np.float64]:
        """Positions of the first evader, shape (T, 2), metres."""
        return self.evaders[:, 0]

    @property
    def evader_cells(self) -> NDArray[np.int32]:
        """Cell that the first evader is in, counted from 0, shape (T,)."""
        return self.evaders_cells[:, 0]

    def __str__(self) -> str:
        out, evaders = self.outcome, self.evaders.shape[1]
        if evaders > 1:
            last = max((capture.time for capture in out.captures), default=0.0)
            told = f"{len(out.captures)} of {evaders} evaders captured"
            return f"{told}, the last one after {last:.1f} s" if out.captured else f"{told} in {out.time:.1f} s"
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

    def _repr_png_(self) -> bytes:
        """Return snapshots for a notebook."""
        from geomsim.drawing import Picture
        from geomsim.snapshots import draw_snapshots

        return Picture(draw_snapshots(self, width=1200))._repr_png_()
