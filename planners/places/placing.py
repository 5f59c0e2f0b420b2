"""Places: where somebody who goes from checkpoint to checkpoint can be, and which way he is going."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from maps import GeomsimError
from planners.places.lines import along
from planners.roads import Roads
from planners.space import StateSpace

__all__ = ["PlaceError", "Places"]

#: ways that differ by less than this are equal, metres
_HAIR = 1e-9


class PlaceError(GeomsimError):
    """A spacing or map for which there are no places."""


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """N positions with directions of travel: on each way between two checkpoints one every ``spacing`` metres.

    The first place of a way is at the checkpoint where it begins, the checkpoint where it ends is the first place of
    those that go on. Both directions of a way have places of their own. A cell without ways has one place, on which
    one stands, at its checkpoint.

    Attributes
    ----------
    roads : Roads
        The ways, E of them.
    spacing : float
        Metres.
    first : ndarray of intp, shape (E + 1,)
        First place of each way; the last entry is the first of those on which one stands.
    edge : ndarray of intp, shape (N,)
        Way of each place, -1 for one on which one stands.
    way : ndarray, shape (N,)
        Metres gone from the checkpoint where the way begins.
    points : ndarray, shape (N, 2)
        Metres; NaN for the place of a cell that no body can enter.
    headings : ndarray, shape (N,)
        Directions of travel, radians; 0 where one stands.
    space : StateSpace
        The places as states: the cell of each, and its share of one who sets out from that cell's checkpoint, by any
        of its ways alike.
    """

    roads: Roads
    spacing: float
    first: NDArray[np.intp]
    edge: NDArray[np.intp]
    way: NDArray[np.float64]
    points: NDArray[np.float64]
    headings: NDArray[np.float64]
    space: StateSpace

    def __len__(self) -> int:
        return len(self.edge)

    @classmethod
    def of(cls, roads: Roads, spacing: float) -> Places:
        """Lay places along roads between the checkpoints of cells.

        Parameters
        ----------
        roads : Roads
            Made with centroids as checkpoints.
        spacing : float
            Metres; the way that an evader goes in a belief step makes its motion exact but for the ends of ways.

        Raises
        ------
        PlaceError
            If the spacing is not a number above 0.
        """
        if not 0 < spacing < np.inf:
            raise PlaceError(f"The spacing of places must be a number of metres above 0; got {spacing}.")
        graph = roads.graph
        count = np.maximum(1, np.ceil(graph.length / spacing - _HAIR)).astype(np.intp)
        first = np.concatenate([[0], np.cumsum(count)]).astype(np.intp)
        edge = np.repeat(np.arange(len(count)), count)
        way = np.asarray(spacing * (np.arange(len(edge)) - first[edge]), dtype=np.float64)
        laid = [along(line, way[first[e] : first[e + 1]]) for e, line in enumerate(roads.lines)]
        alone = np.flatnonzero(graph.degree == 0)
        begin = way == 0.0
        cell = np.concatenate([np.where(way < graph.leave[edge], roads.tails[edge], graph.indices[edge]), alone])
        share = np.concatenate([begin / np.maximum(1, graph.degree)[roads.tails[edge]], np.ones(len(alone))])
        return cls(
            roads=roads,
            spacing=spacing,
            first=first,
            edge=np.concatenate([edge, np.full(len(alone), -1)]),
            way=np.concatenate([way, np.zeros(len(alone))]),
            points=np.concatenate([*(points for points, _ in laid), roads.points[alone]]),
            headings=np.concatenate([*(headings for _, headings in laid), np.zeros(len(alone))]),
            space=StateSpace(cell.astype(np.intp), share, len(graph)),
        )
