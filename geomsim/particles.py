"""The other way to follow an evader: many particles, each of which strolls as one evader might (Section IV)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from geomsim.sensing import Sensor
from geomsim.watching import Watch, missed_at
from planners.places.lines import along

__all__ = ["PARTICLES", "Swarm"]

#: how many there are; a probability is then off by 0.0016 at most, as a standard deviation
PARTICLES = 100_000


class Swarm:
    """Particles that look for nobody: each goes exactly as the paper's evader does, and weighs what is unseen of it.

    In contrast to places nothing is rounded, neither where an evader is nor when it turns; but the answer has the
    noise of a sample. It looks as :class:`geomsim.watching.Lookout` does.

    Parameters
    ----------
    watch : Watch
        Where, how fast, and how often.
    sensors : sequence of Sensor
        Those of P robots.
    belief : ndarray, shape (N,)
        Probability of each place of ``watch`` at first; particles set out from these places.
    rng : Generator
        Their chance.
    count : int
        How many there are.
    """

    def __init__(
        self,
        watch: Watch,
        sensors: Sequence[Sensor],
        belief: NDArray[np.float64],
        rng: np.random.Generator,
        count: int = PARTICLES,
    ) -> None:
        self._watch, self._sensors, self._rng = watch, sensors, rng
        place = rng.choice(len(belief), size=count, p=belief / belief.sum())
        self._edge, self._way = watch.places.edge[place].copy(), watch.places.way[place].copy()
        self._stands = watch.places.points[place]
        self._weight = np.full(count, float(belief.sum()) / count)
        self._looked = False

    def look(self, eyes: NDArray[np.float64], headings: NDArray[np.float64]) -> float:
        """Return the probability that nobody has been seen after one look more; (P, 2), metres, and (P,), radians."""
        if self._looked:
            self._move()
        self._looked = True
        points = self._points()
        for sensor, eye, heading in zip(self._sensors, eyes, headings, strict=True):
            self._weight *= missed_at(self._watch.grid, points, sensor, eye, float(heading), self._watch.step)
        return float(self._weight.sum())

    def _move(self) -> None:
        graph = self._watch.places.roads.graph
        going = np.flatnonzero(self._edge >= 0)
        self._way[going] += self._watch.speed * self._watch.step
        while len(going):
            going = going[self._way[going] >= graph.length[self._edge[going]]]
            edge = self._edge[going]
            end = graph.indices[edge]
            self._way[going] -= graph.length[edge]
            self._edge[going] = graph.indptr[end] + self._rng.integers(0, graph.degree[end])

    def _points(self) -> NDArray[np.float64]:
        points, lines = self._stands.copy(), self._watch.places.roads.lines
        order = np.argsort(self._edge, kind="stable")
        ends = np.searchsorted(self._edge[order], np.arange(len(lines) + 1))
        for edge, line in enumerate(lines):
            mine = order[ends[edge] : ends[edge + 1]]
            if len(mine):
                points[mine] = along(line, self._way[mine])[0]
        return points
