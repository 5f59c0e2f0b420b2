"""Pursuers as chains of positions: exact results for teams that wander, and for teams that know where the evader is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from maps import GeomsimError
from planners.policy import SearchProblem
from planners.simulation import Looks, Moves, SearchModel

if TYPE_CHECKING:
    from planners.motion import Sparse

__all__ = ["JointChain", "TooLargeError", "catch_chances"]

# Numbers in one array over joint positions and states: 160 MB.
LARGEST = 20_000_000


class TooLargeError(GeomsimError):
    """An exact computation would need more memory than is sensible."""


@dataclass(frozen=True, slots=True)
class Walk:
    """The positions of one pursuer: all checkpoints, then every place that it reaches between two steps of a move.

    Attributes
    ----------
    first, last : ndarray of intp, shape (K,)
        Every step from one position to another that is possible.
    kept : ndarray, shape (S, N)
        Share of each state that stays unseen from each position.
    """

    first: NDArray[np.intp]
    last: NDArray[np.intp]
    kept: NDArray[np.float64]

    @classmethod
    def of(cls, moves: Moves, looks: Looks, *, wait: bool) -> Walk:
        """List the positions and steps of a pursuer that may wait at checkpoints, or may not."""
        cells = len(moves.start) - 1
        first, last, views = [], [], moves.views[moves.start[:-1], 0].tolist()
        for cell in range(cells):
            begin, end = moves.start[cell], moves.start[cell + 1]
            for move in range(begin if wait or end == begin + 1 else begin + 1, end):
                chain = [cell, *range(len(views), len(views) + int(moves.steps[move]) - 1), int(moves.target[move])]
                views += moves.views[move, : len(chain) - 2].tolist()
                first += chain[:-1]
                last += chain[1:]
        return cls(np.array(first), np.array(last), looks.kept(np.array(views)))

    def uniform(self) -> Sparse:
        """Return the matrix of a walk that takes every possible step with the same probability, shape (S, S)."""
        from scipy.sparse import csr_array

        count = np.bincount(self.first, minlength=len(self.kept))
        return csr_array((1.0 / count[self.first], (self.first, self.last)), shape=(len(self.kept),) * 2)


class JointChain:
    """The Markov chain of a team and the evader, over joint positions and states.

    Arrays over it have one axis of positions for each pursuer and one of the evader's states. In each step the
    evader moves, then all pursuers, then those who see it capture it.

    Parameters
    ----------
    model : SearchModel
        The problem.
    walks : sequence of Walk
        The positions of each pursuer.
    """

    def __init__(self, model: SearchModel, walks: Sequence[Walk]) -> None:
        self.walks = tuple(walks)
        self.shape = (*(len(walk.kept) for walk in walks), model.states)
        self.step = model.step
        self.dispersion = model.dispersion
        self.unseen = np.ones(self.shape)
        for axis, walk in enumerate(self.walks):
            self.unseen *= np.expand_dims(walk.kept, tuple(k for k in range(len(walks)) if k != axis))

    @classmethod
    def of(cls, problem: SearchProblem, *, wait: bool, largest: int = LARGEST) -> JointChain:
        """Make the chain of a problem; pursuers may wait at checkpoints, or may not.

        Raises
        ------
        TooLargeError
            If there are more than so many joint positions and states.
        """
        model = SearchModel(problem)
        _check_size(model.moves, model.states, largest)
        return cls(model, [Walk.of(moves, model.looks, wait=wait) for moves in model.moves])

    def wandering_times(self) -> NDArray[np.float64]:
        """Return the expected time to capture from everywhere, for pursuers that wander; seconds, ``self.shape``.

        Time counts from before the first step; the position itself is taken to be without capture. It solves
        ``h = 1 + P Q_1 ... Q_R C h``, the first-step equations of the absorbing chain.

        Raises
        ------
        TooLargeError
            If the linear system does not converge, as where the evader cannot be reached.
        """
        from scipy.sparse.linalg import LinearOperator, bicgstab

        walks = [walk.uniform() for walk in self.walks]

        def remaining(flat: NDArray[np.float64]) -> NDArray[np.float64]:
            ahead = flat.reshape(self.shape) * self.unseen
            for axis, walk in enumerate(walks):
                ahead = along(walk, ahead, axis)
            return flat - along(self.dispersion, ahead, len(walks)).ravel()

        n = int(np.prod(self.shape))
        solution, failed = bicgstab(LinearOperator((n, n), remaining), np.ones(n), rtol=1e-10, maxiter=2000)
        if failed:
            raise TooLargeError("The expected time of the wandering team did not converge.")
        return np.asarray(solution * self.step).reshape(self.shape)

    def wandering_survival(
        self, teams: Sequence[tuple[int, ...]], beliefs: Sequence[NDArray[np.float64]], steps: int
    ) -> NDArray[np.float64]:
        """Return the probability of no capture after 0, 1, ... steps for pursuers that wander.

        Parameters
        ----------
        teams : sequence of tuple of int, length K
            Cells at whose checkpoints the pursuers stand at first.
        beliefs : sequence of ndarray, shape (N + 1,), length K
            Where the evader is at first.
        steps : int
            Number of steps.

        Returns
        -------
        ndarray, shape (K, steps + 1)
        """
        walks = [walk.uniform() for walk in self.walks]
        free = np.ones(self.shape)
        curve = np.empty((len(teams), steps + 1))
        for t in range(steps + 1):
            curve[:, t] = [belief[1:] @ free[team] for team, belief in zip(teams, beliefs, strict=True)]
            free *= self.unseen
            for axis, walk in enumerate(walks):
                free = along(walk, free, axis)
            free = along(self.dispersion, free, len(walks))
        return curve

    def informed_times(self, tolerance: float = 1e-9) -> NDArray[np.float64]:
        """Return the least expected time to capture if the evader's state were always known; seconds, ``self.shape``.

        The Markov decision problem of Eaton and Zadeh [4], by value iteration from below; the pursuers are told
        where the evader has moved before they move. No team that does not see the evader can be faster, so this
        bounds every planner's expected time from below, and so does every iterate.

        Parameters
        ----------
        tolerance : float
            Iteration ends when no value grows by more than this share of it.
        """
        times = np.zeros(self.shape)
        for _ in range(100_000):
            ahead = times * self.unseen
            for axis, walk in enumerate(self.walks):
                ahead = least(walk, ahead, axis)
            after = self.step + along(self.dispersion, ahead, len(self.walks))
            settled = bool((after - times <= tolerance * after).all())
            times = after
            if settled:
                break
        return times


def catch_chances(problem: SearchProblem) -> Iterator[tuple[NDArray[np.float64], ...]]:
    """Yield, for 0, 1, ... belief steps, how probable it can be made that one pursuer alone captures by then.

    The pursuer always knows the evader's state and does its best for that very time: finite-horizon value iteration.

    Parameters
    ----------
    problem : SearchProblem
        The problem.

    Yields
    ------
    tuple of ndarray, shape (C, N)
        For each pursuer, from each checkpoint and with the evader in each state.

    Raises
    ------
    TooLargeError
        If a pursuer has more than 20 million positions and states.
    """
    model = SearchModel(problem)
    for moves in model.kinds:
        _check_size([moves], model.states, LARGEST)
    walks = [Walk.of(moves, model.looks, wait=True) for moves in model.kinds]
    free = [np.ones(walk.kept.shape) for walk in walks]
    cells = len(model.graph)
    while True:
        yield tuple(1.0 - free[kind][:cells] for kind in model.kind)
        free = [along(model.dispersion, least(walk, walk.kept * f, 0), 1) for walk, f in zip(walks, free, strict=True)]


def _check_size(team: Sequence[Moves], states: int, largest: int) -> None:
    positions = [len(moves.start) - 1 + int((np.delete(moves.steps, moves.start[:-1]) - 1).sum()) for moves in team]
    size = float(np.prod([*map(float, positions), states]))
    if size > largest:
        raise TooLargeError(
            f"The team and the evader have {size:.3g} joint positions; an exact result allows {largest:.3g}."
        )


def along(matrix: Sparse | NDArray[np.float64], array: NDArray[np.float64], axis: int) -> NDArray[np.float64]:
    """Return the product of a matrix with every vector of an array along one axis."""
    front = np.moveaxis(array, axis, 0)
    product = np.asarray(matrix @ front.reshape(len(front), -1)).reshape(front.shape)
    return np.moveaxis(product, 0, axis)


def least(walk: Walk, array: NDArray[np.float64], axis: int) -> NDArray[np.float64]:
    """Return the least value along an axis among the positions that can follow each position."""
    front = np.moveaxis(array, axis, 0)
    order = np.argsort(walk.first, kind="stable")
    starts = np.searchsorted(walk.first[order], np.arange(len(walk.kept)))
    return np.moveaxis(np.minimum.reduceat(front[walk.last[order]], starts, axis=0), 0, axis)
