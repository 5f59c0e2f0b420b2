"""Capture by line of sight on cells: what share of every cell is visible from every place on a checkpoint path."""

from __future__ import annotations

import math
import weakref
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from discretize import CellMap
from discretize.sight import Sight
from planners.capture import CaptureError
from planners.graph import SearchGraph
from planners.parts import cut_cells
from planners.roads import Roads
from planners.space import StateSpace

if TYPE_CHECKING:
    from planners.motion import Sparse

__all__ = ["LineOfSight", "OwnCell", "SightMap"]

# Between two places from which a pursuer looks, and between the middles of two parts of a cell, metres; a cell has nine
# parts or more. Halving both changes the predicted capture curve by at most 0.02 in the bundled office and museum.
STATION, PART = 1.0, 4.0

# Lines of sight that are looked at for one map: a minute or so.
MOST_LINES = 60_000_000

# Lines of sight that are looked at together: some hundred megabytes.
BATCH = 500_000

InSight: TypeAlias = Callable[
    [NDArray[np.float64], NDArray[np.float64]], tuple[NDArray[np.integer[Any]], NDArray[np.integer[Any]]]
]

# A pursuer that looks all around has no heading.
ALL_AROUND = math.tau - 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class SightMap:
    """Which parts of all cells are in free sight of each station on the roads of a map.

    Stations are the checkpoints, and then, for every way, ``count`` equally distant places on it, the last one at the
    checkpoint where it ends.

    Attributes
    ----------
    space : StateSpace
        S parts of the cells.
    points : ndarray, shape (S, 2)
        Their middles, metres.
    count : ndarray of intp, shape (E,)
        Stations on each way.
    first : ndarray of intp, shape (E,)
        The first one of them.
    places : ndarray, shape (K, 2)
        Where the stations are, metres.
    headings : ndarray, shape (K,)
        Where a pursuer that goes looks there, radians; NaN at checkpoints.
    station, part : ndarray of integers, shape (L,)
        Every pair that sees each other, ordered by station.
    """

    space: StateSpace
    points: NDArray[np.float64]
    count: NDArray[np.intp]
    first: NDArray[np.intp]
    places: NDArray[np.float64]
    headings: NDArray[np.float64]
    station: NDArray[np.integer[Any]]
    part: NDArray[np.integer[Any]]

    @classmethod
    def of(cls, cells: CellMap, roads: Roads, reach: float = math.inf, spacing: float = PART) -> SightMap:
        """Find what is in sight on a map, or return what was found before; it is kept as long as the map is.

        Parameters
        ----------
        cells : CellMap
            The map.
        roads : Roads
            Its roads.
        reach : float
            What is further away than this need not be found, metres.
        spacing : float
            Between the middles of two parts of a cell, metres.

        Raises
        ------
        CaptureError
            If there are too many lines of sight to look at.
        """
        key = (id(cells), len(roads.graph), reach, spacing)
        if key not in _KEPT:
            _KEPT[key] = cls._find(cells, roads, reach, spacing)
            weakref.finalize(cells, _KEPT.pop, key, None)
        return _KEPT[key]

    @classmethod
    def _find(cls, cells: CellMap, roads: Roads, reach: float, spacing: float) -> SightMap:
        space, points = cut_cells(cells, spacing)
        sight = Sight(cells.plan)
        return cls.over(roads, space, points, STATION, lambda places, parts: _in_sight(sight, places, parts, reach))

    @classmethod
    def over(
        cls, roads: Roads, space: StateSpace, points: NDArray[np.float64], spacing: float, in_sight: InSight
    ) -> SightMap:
        """Lay stations about ``spacing`` metres apart along roads, and find what is in sight of them.

        Parameters
        ----------
        roads : Roads
            E ways.
        space : StateSpace
            S states of a belief.
        points : ndarray, shape (S, 2)
            Where they are, metres.
        spacing : float
            Metres.
        in_sight : callable
            Given K places and S points, it returns the pairs that see each other, ordered by place.
        """
        count = np.maximum(1, np.rint(roads.graph.length / spacing)).astype(np.intp)
        first = len(roads.graph) + np.concatenate([[0], np.cumsum(count)])[:-1]
        found = [_stations(line, n) for line, n in zip(roads.lines, count.tolist(), strict=True)]
        places = np.concatenate([roads.points, *(places for places, _ in found)])
        headings = np.concatenate([np.full(len(roads.points), np.nan), *(along for _, along in found)])
        station, part = in_sight(places, points)
        return cls(space, points, count, first.astype(np.intp), places, headings, station, part)


_KEPT: dict[tuple[int, int, float, float], SightMap] = {}


def _stations(line: NDArray[np.float64], count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return equally distant places on a polyline, the last one at its end, and the direction there, radians."""
    steps = np.diff(line, axis=0)
    marks = np.concatenate([[0.0], np.cumsum(np.hypot(*steps.T))])
    way = marks[-1] * np.arange(1, count + 1) / count
    places = np.stack([np.interp(way, marks, line[:, k]) for k in (0, 1)], axis=1)
    piece = np.clip(np.searchsorted(marks, way, side="left") - 1, 0, len(steps) - 1)
    return places, np.arctan2(steps[piece, 1], steps[piece, 0])


def _in_sight(
    sight: Sight, places: NDArray[np.float64], points: NDArray[np.float64], reach: float
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the pairs of a place and a point, at most ``reach`` apart, that see each other, in rising order."""
    from scipy.spatial import cKDTree

    # ways are gone in both directions, and end at checkpoints: the same place is looked from once
    known = np.flatnonzero(np.isfinite(places[:, 0]))
    once, back = np.unique(np.round(places[known], 6), axis=0, return_inverse=True)
    tree = cKDTree(points)
    near = [np.array(row, dtype=np.intp) for row in tree.query_ball_point(once, min(reach, 1e9), return_sorted=True)]
    lines = sum(len(row) for row in near)
    if lines > MOST_LINES:
        raise CaptureError(
            f"The map has {lines:.3g} lines of sight between places on checkpoint paths and parts of cells; at most "
            f"{MOST_LINES:.3g} are looked at. Give the robots a shorter range, or let the belief count on cells."
        )
    seen: list[NDArray[np.intp]] = []
    batch: list[int] = []
    size = 0
    for k in range(len(once)):
        batch.append(k)
        size += len(near[k])
        if size > BATCH or k == len(once) - 1:
            eyes = np.repeat(np.array(batch), [len(near[i]) for i in batch])
            what = np.concatenate([near[i] for i in batch])
            free = sight.between(once[eyes], points[what])
            count = np.bincount(eyes[free] - batch[0], minlength=len(batch))
            seen += np.split(what[free], np.cumsum(count)[:-1])
            batch, size = [], 0
    rows = [seen[k] for k in back.reshape(-1).tolist()]
    station = np.repeat(known, [len(row) for row in rows])
    return station, np.concatenate([np.empty(0, dtype=np.intp), *rows])


@dataclass(frozen=True, slots=True)
class LineOfSight:
    """Sees what no wall hides, within a range and a field of view.

    A robot that stands still and sees a third of a room must not count another third each second. So the states are
    not whole cells but parts of them (:func:`planners.parts.cut_cells`), so small that a part counts as seen or not,
    by the line of sight to its middle. What has been seen and was empty stays empty: looking again finds nothing,
    until the evader's motion carries probability into the seen parts again
    (:class:`planners.parts.MotionInParts`). The visible share of a cell is the share of its parts in sight.

    A pursuer on its way looks where it goes; one that waits at a checkpoint keeps the heading with which it came,
    which a plan does not know: there only those parts count that it sees whichever way it came by.

    Attributes
    ----------
    map : SightMap
        What is in free sight.
    range : float
        How far a pursuer sees, metres.
    field_of_view : float
        Angle that it sees, half of it to each side of its heading, radians.
    detection : float
        Probability of noticing, at one belief step, an evader in a part in sight, in (0, 1]. Below one, looks at
        successive steps are taken to fail independently (the paper's footnote on noisy sensors).

    Raises
    ------
    CaptureError
        If range or field of view are not above 0, or the detection probability is outside (0, 1].
    """

    map: SightMap
    range: float = math.inf
    field_of_view: float = math.tau
    detection: float = 1.0

    def __post_init__(self) -> None:
        if not (self.range > 0 and self.field_of_view > 0):
            raise CaptureError(
                f"Range and field of view must be above 0; got {self.range:g} m and {self.field_of_view:g} rad."
            )
        if not 0 < self.detection <= 1:
            raise CaptureError(f"A detection probability must be above 0 and at most 1; got {self.detection}.")

    def table(self, graph: SearchGraph) -> Sparse:
        """Return the detection probability of each part from each station, shape (K, S)."""
        from scipy.sparse import csr_array, vstack

        sights = self.map
        way = sights.points[sights.part] - sights.places[sights.station]
        seen = np.hypot(*way.T) <= self.range
        if self.field_of_view < ALL_AROUND:
            off = np.arctan2(way[:, 1], way[:, 0]) - sights.headings[sights.station]
            seen &= np.abs(np.arctan2(np.sin(off), np.cos(off))) <= self.field_of_view / 2
        entries = (np.full(int(seen.sum()), self.detection), (sights.station[seen], sights.part[seen]))
        table = csr_array(entries, shape=(len(sights.places), len(sights.space)))
        if self.field_of_view >= ALL_AROUND:
            return table
        arrivals = [sights.first[graph.indices == c] + sights.count[graph.indices == c] - 1 for c in range(len(graph))]
        waits = [table[rows].min(axis=0).reshape(1, -1) if len(rows) else table[[c]] for c, rows in enumerate(arrivals)]
        return csr_array(vstack([*waits, table[len(graph) :]]))

    def viewpoints(self, graph: SearchGraph, edge: int, way: NDArray[np.float64]) -> NDArray[np.intp]:
        """Return the station on the way that is nearest to each place, or the checkpoint where it begins."""
        count, begin = int(self.map.count[edge]), int(np.searchsorted(graph.indptr, edge, side="right")) - 1
        number = np.clip(np.rint(np.asarray(way) / graph.length[edge] * count), 0, count).astype(np.intp)
        station: NDArray[np.intp] = np.where(number == 0, begin, int(self.map.first[edge]) + number - 1)
        return station

    def row(self, graph: SearchGraph, cell: int) -> NDArray[np.float64]:
        """Return the detection probability of each part for a pursuer that waits at a checkpoint, shape (S,)."""
        return np.asarray(self.table(graph)[[cell]].toarray()[0])


@dataclass(frozen=True, slots=True, eq=False)
class OwnCell:
    """Sees the whole of the cell that it is in, on roads whose checkpoints need not be cells.

    :class:`planners.SameCell` for any roads and any parts of cells.

    Attributes
    ----------
    roads : Roads
        Where pursuers go.
    space : StateSpace
        What states are.
    detection : float
        As in :class:`planners.SameCell`.
    """

    roads: Roads
    space: StateSpace
    detection: float = 1.0

    def table(self, graph: SearchGraph) -> Sparse:  # noqa: ARG002  (the roads' own)
        """Return the detection probability of each state from each checkpoint, shape (V, S)."""
        from scipy.sparse import csr_array

        own = self.space.cell[np.newaxis] == self.roads.cell[:, np.newaxis]
        return csr_array(own * self.detection)

    def viewpoints(self, graph: SearchGraph, edge: int, way: NDArray[np.float64]) -> NDArray[np.intp]:
        """Return the checkpoint in whose cell the pursuer is."""
        begin, end = int(self.roads.tails[edge]), int(graph.indices[edge])
        return np.where(np.asarray(way) >= graph.leave[edge] - 1e-9, end, begin).astype(np.intp)

    def row(self, graph: SearchGraph, cell: int) -> NDArray[np.float64]:  # noqa: ARG002  (the roads' own)
        """Return the detection probability of each state for a pursuer at a checkpoint, shape (S,)."""
        return np.asarray((self.space.cell == self.roads.cell[cell]) * self.detection)
