"""The office: sixty rooms and hallway pieces whose cell graph is the published one of this line of research."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from maps.drafting import Door, Room, draft_plan
from maps.floorplan import FloorPlan

__all__ = ["draft_office"]

# Metres that one unit of the sketch stands for, set so that an evader walks into two pursuers that stand still after as
# long as in the paper; and how wide hallways are, two units of the sketch: 2 m between walls.
UNIT, HALLWAY = 2.216, 2.06

# Where hallways run in the sketch, from west to east and from south to north.
WEST_TO_EAST = ((5, 7), (22, 24), (34, 36), (55, 57))
SOUTH_TO_NORTH = ((5, 7), (18, 20))

# Numbers of the hallway pieces, by where they run; three rings of hallways side by side.
TOP = {45: (5, 17), 44: (17, 31), 58: (31, 50), 57: (50, 57)}
BOTTOM = {48: (5, 10), 59: (10, 17), 60: (17, 22), 50: (24, 29), 51: (29, 34), 54: (36, 48), 55: (48, 57)}
UPRIGHT = {46: (5, 14, 18), 47: (5, 7, 14), 49: (22, 5, 18), 53: (34, 5, 18), 56: (55, 7, 18)}

# Doorways where one hallway piece goes over into the next.
OPENINGS = [
    (44, 45), (44, 49), (44, 58), (45, 46), (46, 47), (47, 48), (48, 59), (49, 50), (49, 60), (50, 51),
    (51, 53), (53, 54), (53, 58), (54, 55), (55, 56), (56, 57), (57, 58), (59, 60),
]  # fmt: skip

# Rooms that open onto each hallway piece.
DOORS = {
    44: [23, 25, 43],
    45: [8, 9, 10, 22, 24],
    46: [11, 22],
    47: [12, 13, 14, 21],
    48: [15],
    51: [52],
    53: [26],
    54: [27, 28, 29, 30, 37, 38, 39, 40],
    55: [31, 32, 33],
    56: [1, 2, 3, 4, 34, 35, 36],
    58: [5, 6, 7, 41, 42],
    59: [16, 19, 20],
    60: [17, 18],
}


def draft_office() -> FloorPlan:
    """Draw an office floor of 128 m x 51 m around three rings of hallways.

    Its cell graph is the 60-vertex office graph published with the searchers of github.com/basfora/milp_mespp (MIT);
    vertex v is cell v + 1. Where the rooms lie is our own invention, no coordinates having been published.
    """
    hallways = [Room(n, "hallway", ((x0, 18), (x1, 20))) for n, (x0, x1) in TOP.items()]
    hallways += [Room(n, "hallway", ((x0, 5), (x1, 7))) for n, (x0, x1) in BOTTOM.items()]
    hallways += [Room(n, "hallway", ((x, y0), (x + 2, y1))) for n, (x, y0, y1) in UPRIGHT.items()]
    north = [*_row([8, 9, 10, 24], [0, 7.5, 10.5, 13.5, 18], 20, 25), Room(43, "reception", ((18, 20), (30, 25)))]
    north += _row([5, 6, 7], [30, 37, 43, 50], 20, 25)
    west = _column([14, 13, 12, 11], [5, 8, 11, 14, 20], 0, 5)
    south = [*_row([15, 16, 17, 18], [0, 9, 15, 19, 24], 0, 5), Room(52, "canteen", ((24, 0), (36, 5)))]
    south += _row([27, 28, 29, 30, 31, 32, 33], [36, 39, 42, 45, 48, 51, 54, 62], 0, 5)
    east = _column([4, 3, 2, 1], [5, 9, 12, 15, 20], 57, 62)
    core = [Room(22, "library", ((7, 12.5), (17, 18))), Room(23, "meeting room", ((17, 12.5), (22, 18)))]
    core += _row([21, 19, 20], [7, 11, 14, 22], 7, 12.5)
    core += [Room(25, "meeting room", ((24, 12), (34, 18))), Room(26, "meeting room", ((24, 7), (34, 12)))]
    core += _row([37, 38, 39, 40], [36, 39, 42, 45, 48], 7, 12) + _row([41, 42], [36, 42, 48], 12, 18)
    core += _column([36, 35, 34], [7, 11, 14.5, 18], 48, 55)
    doors = [Door(pair, width=1.6) for pair in OPENINGS] + [Door((22, 23)), Door((25, 26))]
    doors += [
        Door((room, hallway), at=0.25 if k % 2 else 0.75)
        for hallway, rooms in DOORS.items()
        for k, room in enumerate(rooms)
    ]
    rooms = [_built(room) for room in hallways + north + west + south + east + core]
    return draft_plan("office", rooms, doors, wall=0.06, start=(43, 44), source="bundled")


def _built(room: Room) -> Room:
    """Return a room of the sketch in metres."""
    x, y = np.transpose(room.corners)
    corners = np.transpose([_metres(x, WEST_TO_EAST), _metres(y, SOUTH_TO_NORTH)]).round(3)
    return Room(room.number, room.name, tuple((float(a), float(b)) for a, b in corners))


def _metres(sketched: NDArray[np.float64], hallways: Sequence[tuple[int, int]]) -> NDArray[np.float64]:
    """Return the metres that coordinates of the sketch stand for, along one axis with its hallways."""
    edges = [0.0, *(float(edge) for hallway in hallways for edge in hallway)]
    pieces = [HALLWAY if k % 2 else (b - a) * UNIT for k, (a, b) in enumerate(pairwise(edges))]
    beyond = np.maximum(sketched - edges[-1], 0.0) * UNIT
    return np.asarray(np.interp(sketched, edges, np.cumsum([0.0, *pieces])) + beyond)


def _row(numbers: Sequence[int], xs: Sequence[float], y0: float, y1: float) -> list[Room]:
    """Offices side by side, from left to right."""
    return [Room(n, "office", ((x0, y0), (x1, y1))) for n, (x0, x1) in zip(numbers, pairwise(xs), strict=True)]


def _column(numbers: Sequence[int], ys: Sequence[float], x0: float, x1: float) -> list[Room]:
    """Offices one above the other, from the bottom."""
    return [Room(n, "office", ((x0, y0), (x1, y1))) for n, (y0, y1) in zip(numbers, pairwise(ys), strict=True)]
