"""What a team that goes given ways will see of an evader, without sampling: the belief over places under its looks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from discretize import CellMap, WallGrid
from geomsim.believing import strolling
from geomsim.evaders import Still
from geomsim.sensing import Sensor
from geomsim.team import Evader
from planners import DwellTime, StationaryMotion, uniform_belief

if TYPE_CHECKING:
    from planners.motion import Sparse

__all__ = ["LOOK_STEP", "Lookout", "Track", "Watch", "looks_every", "missed_at"]

#: between two looks, seconds, as near as physics steps allow: what shows for a shorter time may be missed. Measured on
#: the bundled plans, half a second is too long in the small house only.
LOOK_STEP = 0.2


@dataclass(frozen=True, slots=True)
class Track:
    """Where P robots were at S successive physics steps.

    Attributes
    ----------
    eyes : ndarray, shape (S, P, 2)
        Metres.
    headings : ndarray, shape (S, P)
        Where they looked, radians.
    step : float
        Of physics, seconds.
    """

    eyes: NDArray[np.float64]
    headings: NDArray[np.float64]
    step: float


class Watch:
    """Predicts when robots with given sensors see an evader that strolls, or stands still.

    The robots' ways do not depend on the evader before it is seen, so that the probability of its being unseen is
    that of the belief over places, with a look at every step. Nothing is seen twice: a place that was looked at and
    empty stays empty until the evader's motion fills it again.

    Parameters
    ----------
    cells : CellMap
        Where.
    evader : Evader
        Who is looked for. Who stands still does so; any other is taken to stroll like the paper's evader.
    physics_step : float
        Seconds.

    Attributes
    ----------
    speed : float
        Of the evader, metres a second; 0 if it stands still.
    places : Places
        Where it is looked for: in a look's time an evader goes from one to the next.
    every : int
        Physics steps from one look to the next. Bodies set out one step late, so the first look is after one step.
    begin, step : float
        Time of the first look, and from one to the next, seconds.
    grid : WallGrid
        Walls.
    """

    def __init__(self, cells: CellMap, evader: Evader, physics_step: float) -> None:
        self.every = looks_every(physics_step)
        self.begin, self.step = physics_step, self.every * physics_step
        still = isinstance(evader.model, Still)
        self.speed = 0.0 if still else evader.speed
        moves = strolling(cells, StationaryMotion() if still else DwellTime(evader.speed), self.step)
        self.places = moves.places
        inner: Sparse = moves.matrix(self.places.roads.graph, self.step)[1:, 1:]
        self.transposed = inner.T.tocsr()
        self.grid = WallGrid.of(cells.plan.walls)

    def first_belief(self, starts: Sequence[int]) -> NDArray[np.float64]:
        """Return where an evader is that sets out from any checkpoint but those of robots alike; shape (N,)."""
        graph = self.places.roads.graph
        cells = uniform_belief(graph, exclude=starts, component=int(graph.component[starts[0]]))
        return self.places.space.spread(cells)[1:]

    def lookout(self, sensors: Sequence[Sensor], belief: NDArray[np.float64]) -> Lookout:
        """Begin to look, with a belief of shape (N,)."""
        return Lookout(self, sensors, belief)

    def survival(
        self, track: Track, sensors: Sequence[Sensor], belief: NDArray[np.float64], residue: float = 1e-3
    ) -> NDArray[np.float64]:
        """Return the probability that nobody has been seen at each look.

        Parameters
        ----------
        track : Track
            The ways of P robots.
        sensors : sequence of Sensor
            Theirs.
        belief : ndarray, shape (N,)
            Probability of each place at first.
        residue : float
            The curve ends when it is below this, or with the track.
        """
        looker, curve = self.lookout(sensors, belief), []
        for k in range(1, len(track.eyes), self.every):
            curve.append(looker.look(track.eyes[k], track.headings[k]))
            if curve[-1] < residue:
                break
        return np.array(curve)

    def missed(self, sensor: Sensor, eye: NDArray[np.float64], heading: float) -> NDArray[np.float64]:
        """Return the probability of missing an evader in each place at one look, shape (N,)."""
        return missed_at(self.grid, self.places.points, sensor, eye, heading, self.step)


def missed_at(
    grid: WallGrid,
    points: NDArray[np.float64],
    sensor: Sensor,
    eye: NDArray[np.float64],
    heading: float,
    step: float,
) -> NDArray[np.float64]:
    """Return the probability of missing an evader at each point, shape (N,), in a look that lasts for a step.

    Parameters
    ----------
    grid : WallGrid
        Walls.
    points : ndarray, shape (N, 2)
        Metres.
    sensor : Sensor
        The eye's.
    eye : ndarray, shape (2,)
        Where it is, metres.
    heading : float
        Where it looks, radians.
    step : float
        Seconds.
    """
    from discretize.raycast import seen_from

    seen = seen_from(grid, eye, points, sensor.range)
    if sensor.field_of_view < math.tau:
        way = points - eye
        off = np.arctan2(way[:, 1], way[:, 0]) - heading
        seen &= (np.abs(np.arctan2(np.sin(off), np.cos(off))) <= sensor.field_of_view / 2) | ~way.any(axis=1)
    return np.where(seen, math.exp(-sensor.attention * step), 1.0)


class Lookout:
    """The belief over places of robots that look again and again.

    Attributes
    ----------
    free : ndarray, shape (N,)
        Probability of each place, of an evader that was not seen.
    """

    def __init__(self, watch: Watch, sensors: Sequence[Sensor], belief: NDArray[np.float64]) -> None:
        self._watch, self._sensors = watch, sensors
        self.free, self._looked = belief, False
        # what each robot missed last, from where: who stands need not look for it again
        self._known: list[tuple[bytes, NDArray[np.float64]]] = [(b"", np.empty(0))] * len(sensors)

    def look(self, eyes: NDArray[np.float64], headings: NDArray[np.float64]) -> float:
        """Return the probability that nobody has been seen after one look more; (P, 2), metres, and (P,), radians."""
        if self._looked:
            self.free = self._watch.transposed @ self.free
        self._looked = True
        for i, sensor in enumerate(self._sensors):
            key = eyes[i].tobytes() + headings[i].tobytes()
            if self._known[i][0] != key:
                self._known[i] = key, self._watch.missed(sensor, eyes[i], float(headings[i]))
            self.free = self.free * self._known[i][1]
        return float(self.free.sum())


def looks_every(physics_step: float) -> int:
    """Return the number of physics steps, of so many seconds, from one look to the next."""
    return max(1, round(LOOK_STEP / physics_step))
