"""What there is to show at a time: positions between two physics steps, trails, the way ahead, the belief."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from discretize import CellMap
from geomsim.drawing.theme import DrawingError
from geomsim.episode import Capture, Episode

__all__ = ["Moment", "Timeline", "beliefs_of", "shares"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Moment:
    """An episode at one time.

    Attributes
    ----------
    time : float
        Seconds.
    pursuers : ndarray, shape (R, 2)
        Positions, metres.
    headings : ndarray, shape (R,)
        Radians.
    cells : ndarray of int32, shape (R,)
        Cell that each pursuer is in, counted from 0.
    evaders : ndarray, shape (E, 2)
        Positions, metres.
    captures : tuple of Capture
        Those up to then.
    captured : bool
        Whether all evaders have been captured by then.
    step : int
        Index of the last belief step.
    trails : tuple of ndarray, each of shape (k, 2)
        The way that each pursuer has come lately, oldest first, metres.
    routes : tuple of ndarray, each of shape (k, 2)
        The way that each pursuer intends to go, from where it is, metres; empty where it has no plan.
    """

    time: float
    pursuers: Array
    headings: Array
    cells: NDArray[np.int32]
    evaders: Array
    captures: tuple[Capture, ...]
    captured: bool
    step: int
    trails: tuple[Array, ...]
    routes: tuple[Array, ...]


class Timeline:
    """Answers for any time of an episode.

    Parameters
    ----------
    episode : Episode
        The record.
    trail : float
        How much of the way a pursuer has come is shown, seconds.
    """

    def __init__(self, episode: Episode, trail: float = 20.0) -> None:
        self._episode = episode
        self._trail = trail
        steps = np.hypot(*np.moveaxis(np.diff(episode.pursuers, axis=0), -1, 0))
        self._gone = np.concatenate([np.zeros((1, episode.pursuers.shape[1])), np.cumsum(steps, axis=0)])
        self._legs = _legs(episode.cells)
        self._ways: dict[int, Array] = {}

    def at(self, time: float) -> Moment:
        """Return what there is to show at a time, held at the first and the last of the episode."""
        episode = self._episode
        out = episode.outcome
        time = float(np.clip(time, episode.times[0], episode.times[-1]))
        i = int(np.clip(np.searchsorted(episode.times, time, side="right") - 1, 0, max(len(episode.times) - 2, 0)))
        j = min(i + 1, len(episode.times) - 1)
        part = (time - episode.times[i]) / (episode.times[j] - episode.times[i]) if j > i else 0.0
        pursuers = _between(episode.pursuers, i, j, part)
        turn = (episode.headings[j] - episode.headings[i] + np.pi) % (2 * np.pi) - np.pi
        gone = _between(self._gone, i, j, part)
        return Moment(
            time=time,
            pursuers=pursuers,
            headings=episode.headings[i] + part * turn,
            cells=episode.pursuer_cells[i if part < 0.5 else j],
            evaders=_between(episode.evaders, i, j, part),
            captures=tuple(capture for capture in out.captures if time >= capture.time - 1e-9),
            captured=out.captured and time >= out.time - 1e-9,
            step=max(int(np.searchsorted(episode.belief_times, time + 1e-9, side="right")) - 1, 0),
            trails=tuple(self._trail_of(r, i, time, pursuers[r]) for r in range(len(pursuers))),
            routes=tuple(self._route_of(r, time, gone[r], pursuers[r]) for r in range(len(pursuers))),
        )

    def _trail_of(self, pursuer: int, i: int, time: float, here: Array) -> Array:
        times = self._episode.times
        first = int(np.searchsorted(times, time - self._trail))
        # Points on a fixed grid of steps, so that the trail does not shimmer as it moves on.
        every = max(1, round(0.25 / max(times[-1] / max(len(times) - 1, 1), 1e-9)))
        picked = np.arange(-(-first // every) * every, i + 1, every)
        return np.vstack([self._episode.pursuers[picked, pursuer], here])

    def _route_of(self, pursuer: int, time: float, gone: float, here: Array) -> Array:
        episode = self._episode
        decided = int(np.searchsorted(episode.decision_times, time + 1e-9, side="right"))
        mine = np.flatnonzero(episode.decision_pursuers[:decided] == pursuer)
        if not len(mine):
            return np.empty((0, 2))
        k = int(mine[-1])
        way = self.way(k)
        start = self._gone[np.searchsorted(episode.times, episode.decision_times[k] - 1e-9), pursuer]
        along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(way, axis=0).T))])
        return np.vstack([here, way[along > gone - start + 1e-9]])

    def way(self, k: int) -> Array:
        """Return the whole way of decision ``k`` along the legs between checkpoints, shape (m, 2), metres."""
        if k not in self._ways:
            episode = self._episode
            i = min(int(np.searchsorted(episode.times, episode.decision_times[k] - 1e-9)), len(episode.times) - 1)
            pursuer = episode.decision_pursuers[k]
            stops = [int(episode.pursuer_cells[i, pursuer]), *(int(c) for c in episode.decision_paths[k])]
            pieces = [episode.pursuers[i, pursuer][None]]
            for a, b in pairwise(stops):
                pieces.extend(self._legs.get((a, b), (episode.cells.checkpoints[b][None],)))
            self._ways[k] = np.vstack(pieces)
        return self._ways[k]


def shares(belief: Array) -> Array:
    """Return for each cell the chance that the evader is there if it has not been captured, shape (N,)."""
    free = 1.0 - belief[0]
    return belief[1:] / free if free > 1e-12 else np.zeros(len(belief) - 1)


def beliefs_of(episode: Episode, robot: int | None) -> Array:
    """Return the beliefs of a robot, numbered from 1, or those by all looks for None; shape (B, N + 1).

    Raises
    ------
    DrawingError
        If there is no such robot, or one planner planned for all.
    """
    if robot is None:
        return episode.beliefs
    robots = episode.own_beliefs.shape[1]
    if not robots:
        raise DrawingError("The robots of this episode have no beliefs of their own: one planner planned for all.")
    if not 1 <= robot <= robots:
        raise DrawingError(f"There is no robot {robot}; robots are numbered from 1 to {robots}.")
    return episode.own_beliefs[:, robot - 1]


def _between(values: Array, i: int, j: int, part: float) -> Array:
    mixed: Array = (1.0 - part) * values[i] + part * values[j]
    return mixed


def _legs(cells: CellMap) -> dict[tuple[int, int], tuple[Array, Array]]:
    """Ways between neighbouring checkpoints, as two pieces, in both directions."""
    legs: dict[tuple[int, int], tuple[Array, Array]] = {}
    for portal in cells.portals:
        (a, b), (leave, arrive) = portal.cells, portal.legs
        legs[a, b] = (leave[1:], arrive[::-1])
        legs[b, a] = (arrive[1:], leave[::-1])
    return legs
