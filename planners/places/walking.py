"""How one moves over places who goes from checkpoint to checkpoint, each time by any way alike."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from planners.graph import SearchGraph
from planners.motion import check_speed
from planners.places.placing import Places

if TYPE_CHECKING:
    from planners.motion import Sparse

__all__ = ["StandingStill", "Strolling"]

_HAIR = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Strolling:
    """The paper's evader (Section V): at a centroid it takes any portal alike and goes to the centroid beyond.

    On its way it goes exactly its speed. What it has gone past the last place of a way is a share of the spacing that
    is told by chance: it is on the place before or on the place after, so that the expected way is exact. With a
    spacing of one step's way that happens only where a way ends, and adds at most ``spacing^2 / 4`` to the variance
    of the way gone, for each checkpoint passed.

    Attributes
    ----------
    places : Places
        The states.
    speed : float
        Of the evader, metres a second.

    Raises
    ------
    MotionError
        If the speed is not a number above 0.
    """

    places: Places
    speed: float = 1.0

    def __post_init__(self) -> None:
        check_speed(self.speed)

    def matrix(self, graph: SearchGraph, time_step: float) -> Sparse:  # noqa: ARG002  (the evader has its own roads)
        """Return P over the capture state and N places for a step of any length above 0, seconds."""
        from scipy.sparse import block_diag, coo_array, csr_array

        places = self.places
        walking = np.arange(int(places.first[-1]))
        way = places.way[walking] + self.speed * time_step
        source, place, share = _settled(places, _Flow(walking, places.edge[walking], way, np.ones(len(walking))))
        alone = np.arange(len(walking), len(places))
        rows, columns = np.concatenate([source, alone]), np.concatenate([place, alone])
        entries = np.concatenate([share, np.ones(len(alone))])
        inner = coo_array((entries, (rows, columns)), shape=(len(places), len(places)))
        return csr_array(block_diag([coo_array([[1.0]]), inner]))


@dataclass(frozen=True, slots=True, eq=False)
class StandingStill:
    """An evader that stays where it is; the identity.

    Attributes
    ----------
    places : Places
        The states.
    """

    places: Places

    def matrix(self, graph: SearchGraph, time_step: float) -> Sparse:  # noqa: ARG002  (the same for every step)
        """Return the identity over the capture state and N places."""
        from scipy.sparse import csr_array, eye_array

        return csr_array(eye_array(len(self.places) + 1))


@dataclass(frozen=True, slots=True)
class _Flow:
    """K shares of those who began at some place, now ``way`` metres along ``edge``."""

    source: NDArray[np.intp]
    edge: NDArray[np.intp]
    way: NDArray[np.float64]
    share: NDArray[np.float64]

    def part(self, which: NDArray[np.bool_]) -> _Flow:
        return _Flow(self.source[which], self.edge[which], self.way[which], self.share[which])

    def passing(self, graph: SearchGraph) -> _Flow:
        """Return the same beyond the ends of their ways, on every way that goes on from there alike."""
        end = graph.indices[self.edge]
        ways = graph.degree[end]
        old = np.repeat(np.arange(len(end)), ways)
        following = np.arange(len(old)) + np.repeat(graph.indptr[end] - (np.cumsum(ways) - ways), ways)
        over = self.way - graph.length[self.edge]
        return _Flow(self.source[old], following, over[old], (self.share / ways)[old])


def _settled(places: Places, flow: _Flow) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.float64]]:
    """Return the source, the place and the share of all that a flow comes to."""
    graph, spacing = places.roads.graph, places.spacing
    found: list[tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.float64]]] = []
    while len(flow.edge):
        over = flow.way >= graph.length[flow.edge] - _HAIR
        here, flow = flow.part(~over), flow.part(over).passing(graph)
        first, count = places.first[here.edge], np.diff(places.first)[here.edge]
        step = np.minimum(np.floor(here.way / spacing + _HAIR).astype(np.intp), count - 1)
        last = step == count - 1
        gap = np.where(last, graph.length[here.edge] - step * spacing, spacing)
        beyond = np.clip((here.way - step * spacing) / gap, 0.0, 1.0)
        found.append((here.source, first + step, here.share * (1.0 - beyond)))
        found.append((here.source[~last], (first + step + 1)[~last], (here.share * beyond)[~last]))
        ends = _Flow(here.source, here.edge, graph.length[here.edge], here.share * beyond).part(last).passing(graph)
        found.append((ends.source, places.first[ends.edge], ends.share))
    source, place, share = (np.concatenate(column) for column in zip(*found, strict=True))
    moved = share > _HAIR
    return source[moved], place[moved], share[moved]
