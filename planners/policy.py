"""What a planner is given and what it returns: problem, state, decision; planner and policy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from planners.belief import uniform_belief
from planners.capture import CaptureError, CaptureModel
from planners.graph import SearchGraph
from planners.motion import MotionModel
from planners.space import StateSpace

__all__ = ["Decision", "Planner", "Policy", "PursuerState", "SearchProblem", "SearchState"]


@dataclass(frozen=True, slots=True)
class SearchProblem:
    """What does not change during a pursuit.

    Attributes
    ----------
    graph : SearchGraph
        Cells and the ways between them.
    motion : MotionModel
        How the evader is believed to move.
    capture : CaptureModel or tuple of CaptureModel
        What a pursuer is believed to catch: one for all, or one for each.
    speeds : tuple of float
        Speed of each pursuer, metres a second; its length is the size R of the team.
    time_step : float
        Time between two belief steps, seconds.
    space : StateSpace, optional
        What the states of the belief are; without it the cells of the graph.

    Raises
    ------
    CaptureError
        If there are several capture models, but not one for each pursuer.
    """

    graph: SearchGraph
    motion: MotionModel
    capture: CaptureModel | tuple[CaptureModel, ...]
    speeds: tuple[float, ...]
    time_step: float = 1.0
    space: StateSpace | None = None

    def __post_init__(self) -> None:
        if isinstance(self.capture, tuple) and len(self.capture) != len(self.speeds):
            raise CaptureError(
                f"There are {len(self.capture)} capture models for {len(self.speeds)} pursuers: give one, or one each."
            )

    @property
    def captures(self) -> tuple[CaptureModel, ...]:
        """Capture model of each pursuer."""
        return self.capture if isinstance(self.capture, tuple) else (self.capture,) * len(self.speeds)

    @property
    def states(self) -> StateSpace:
        """What the states of the belief are."""
        return StateSpace.of_cells(len(self.graph)) if self.space is None else self.space

    def first_belief(self, start: Sequence[int], component: int | None = None) -> NDArray[np.float64]:
        """Return where the evader is at first: in any cell alike but those of the pursuers; shape (S + 1,).

        The pursuers have looked once from where they start.

        Parameters
        ----------
        start : sequence of int
            Cells of the pursuers, counted from 0.
        component : int, optional
            Only cells of this connected component of the graph; without it every cell that can be entered.
        """
        beyond = range(self.states.cells, len(self.graph))  # checkpoints that are no cells
        cells = uniform_belief(self.graph, exclude=[*start, *beyond], component=component)
        belief = self.states.spread(cells[: self.states.cells + 1])
        for capture, cell in zip(self.captures, start, strict=False):
            seen = belief[1:] * capture.row(self.graph, cell)
            belief[0] += seen.sum()
            belief[1:] -= seen
        return belief


@dataclass(frozen=True, slots=True)
class PursuerState:
    """Where a pursuer is.

    Attributes
    ----------
    cell : int
        The cell that it is in, counted from 0.
    target : int or None
        The cell to whose checkpoint it is on its way; None if it stands at the checkpoint of ``cell``.
    time_left : float
        Seconds until it stands at the checkpoint of ``target``; 0 if it stands at one.
    """

    cell: int
    target: int | None = None
    time_left: float = 0.0


@dataclass(frozen=True, slots=True)
class SearchState:
    """What a policy may know when it decides.

    Attributes
    ----------
    time : float
        Seconds since the pursuit began.
    belief : ndarray, shape (N + 1,)
        Probability of the capture state (index 0) and of the evader's being in each of N states.
    pursuers : tuple of PursuerState
        The team, R of them.
    plans : tuple of tuple of int
        The path that each pursuer has announced and not yet gone, cells counted from 0; empty where it has none.
    """

    time: float
    belief: NDArray[np.float64]
    pursuers: tuple[PursuerState, ...]
    plans: tuple[tuple[int, ...], ...]


@dataclass(frozen=True, slots=True)
class Decision:
    """Where a pursuer goes next, and what it intends after that.

    Attributes
    ----------
    path : tuple of int
        Cells to visit, counted from 0, the next one first: a neighbour of the cell in which the pursuer stands, or
        that cell itself to stay for one belief step.
    cost : float
        What the planner minimised, for this path; NaN where it minimises nothing.
    """

    path: tuple[int, ...]
    cost: float = float("nan")


@runtime_checkable
class Policy(Protocol):
    """Decides for the pursuers that stand at a checkpoint."""

    def decide(self, state: SearchState) -> Sequence[Decision | None]:
        """Return a decision for each pursuer, None for those still on their way."""
        ...


@runtime_checkable
class Planner(Protocol):
    """A method of coordination with its parameters; makes a policy for a problem."""

    def solve(self, problem: SearchProblem, rng: np.random.Generator) -> Policy:
        """Prepare a policy; all its chance comes from ``rng``."""
        ...
