"""The bundled plans as sketches; :func:`write_drafts` turns them into the files in ``maps/bundled``."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

from maps.drafting import Door, Room, draft_plan
from maps.floorplan import FloorPlan
from maps.geojson import write_geojson

__all__ = ["DRAFTS", "draft_house", "draft_museum", "draft_office", "write_drafts"]


def draft_house() -> FloorPlan:
    """Draw a house of nine rooms, 12 m x 10 m, whose cell graph is the one of the paper's Fig. 2."""
    rooms = [
        Room(1, "living room", ((0, 6), (5, 10))),
        Room(2, "kitchen", ((0, 0), (3, 3))),
        Room(3, "shower room", ((5, 8), (7, 10))),
        Room(4, "hall", ((5, 0), (7, 8))),
        Room(5, "bedroom", ((7, 6.5), (12, 10))),
        Room(6, "main bedroom", ((7, 0), (12, 4))),
        Room(7, "bathroom", ((7, 4), (12, 6.5))),
        Room(8, "dining room", ((0, 3), (5, 6))),
        Room(9, "pantry", ((3, 0), (5, 3))),
    ]
    doors = [
        Door((1, 4)),
        Door((1, 8), at=0.3),
        Door((2, 8), at=0.7),
        Door((2, 9), at=0.8),
        Door((3, 4)),
        Door((4, 5)),
        Door((4, 6), at=0.75),
        Door((4, 9), at=0.4),
        Door((5, 7), at=0.6),
        Door((6, 7), at=0.6),
    ]
    return draft_plan("house", rooms, doors, start=(4,), source="bundled")


def draft_office() -> FloorPlan:
    """Draw an office floor of 60 cells, 57 m x 36 m, around two loops of hallways and a passage between them.

    The cell graph is the published 60-cell office graph of the line of research of the paper (G60V of
    https://github.com/basfora/milp_mespp, MIT), cell k being its vertex k - 1: six independent cycles.
    """
    rooms = [Room(number, name, ((x0, y0), (x1, y1))) for number, name, x0, y0, x1, y1 in _OFFICE]
    doors = [Door(pair, width=1.6) for pair in _OFFICE_OPENINGS]
    for hallway, beside in _OFFICE_DOORS.items():
        doors += [Door((room, hallway), width=1.0, at=0.15 if k % 2 else 0.85) for k, room in enumerate(beside)]
    doors += [Door((22, 23), width=1.0, at=0.3), Door((25, 26), width=1.0, at=0.3)]
    return draft_plan("office", rooms, doors, start=(43, 44), source="bundled")


_OFFICE = (
    # North rooms, from the west.
    (11, "meeting room", 0, 31, 10, 36),
    (22, "library", 10, 31, 22, 36),
    (23, "reading room", 22, 31, 27, 36),
    (43, "reception", 27, 31, 32, 36),
    (5, "office", 32, 31, 36.5, 36),
    (6, "office", 36.5, 31, 41, 36),
    (7, "lecture room", 41, 31, 57, 36),
    # North hallway, from the west.
    (46, "north hallway, west end", 6, 29, 12, 31),
    (45, "north hallway, west", 12, 29, 24, 31),
    (44, "north hallway, middle", 24, 29, 32, 31),
    (58, "north hallway, east", 32, 29, 46, 31),
    (57, "north hallway, east end", 46, 29, 52, 31),
    # West rooms, from the north, and their hallway.
    (12, "office", 0, 25, 6, 31),
    (13, "office", 0, 20, 6, 25),
    (14, "office", 0, 15, 6, 20),
    (15, "workshop", 0, 5, 6, 15),
    (47, "west hallway, north", 6, 15, 8, 29),
    (48, "west hallway, south", 6, 7, 8, 15),
    # Rooms inside the west loop.
    (8, "print shop", 8, 24, 15, 29),
    (9, "office", 15, 24, 18, 29),
    (10, "office", 18, 24, 21, 29),
    (24, "office", 21, 24, 24, 29),
    (21, "open office", 8, 15, 24, 24),
    (20, "canteen", 8, 7, 24, 15),
    # Between the loops.
    (49, "middle hallway", 24, 7, 26, 29),
    (25, "kitchen", 26, 23, 32, 29),
    (26, "copy room", 26, 17, 32, 23),
    (50, "passage, west", 26, 15, 29, 17),
    (51, "passage, east", 29, 15, 32, 17),
    (52, "archive", 26, 5, 32, 15),
    (53, "cross hallway", 32, 7, 34, 29),
    # Rooms inside the east loop, around a courtyard.
    (41, "office", 34, 24, 40, 29),
    (42, "office", 40, 24, 46, 29),
    (36, "office", 46, 25, 50, 29),
    (35, "office", 46, 21, 50, 25),
    (34, "office", 46, 17, 50, 21),
    (37, "office", 34, 7, 38, 13),
    (38, "office", 38, 7, 42, 13),
    (39, "office", 42, 7, 46, 13),
    (40, "office", 46, 7, 50, 13),
    # East hallway and rooms, from the north.
    (56, "east hallway, north", 50, 17, 52, 29),
    (55, "east hallway, south", 50, 5, 52, 17),
    (1, "office", 52, 26, 57, 31),
    (2, "office", 52, 23, 57, 26),
    (3, "office", 52, 20, 57, 23),
    (4, "office", 52, 17, 57, 20),
    (33, "office", 52, 13, 57, 17),
    (32, "office", 52, 9, 57, 13),
    (31, "office", 52, 5, 57, 9),
    # South hallway and rooms, from the west.
    (59, "south hallway, west", 6, 5, 16, 7),
    (60, "south hallway, middle", 16, 5, 26, 7),
    (54, "south hallway, east", 32, 5, 50, 7),
    (16, "store room", 0, 0, 10, 5),
    (19, "office", 10, 0, 16, 5),
    (17, "office", 16, 0, 21, 5),
    (18, "laboratory", 21, 0, 29, 5),
    (27, "laboratory", 29, 0, 36, 5),
    (28, "office", 36, 0, 41, 5),
    (29, "office", 41, 0, 46, 5),
    (30, "meeting room", 46, 0, 57, 5),
)
"""Number, name, and two opposite corners of each cell, metres."""

_OFFICE_OPENINGS = (
    *((44, 45), (44, 49), (44, 58), (45, 46), (46, 47), (47, 48), (48, 59), (49, 50), (49, 60), (50, 51), (51, 53)),
    *((53, 54), (53, 58), (54, 55), (55, 56), (56, 57), (57, 58), (59, 60)),
)
"""Hallways that lead into each other."""

_OFFICE_DOORS = {
    44: (23, 25, 43),
    45: (8, 9, 10, 22, 24),
    46: (11, 22),
    47: (12, 13, 14, 21),
    48: (15,),
    51: (52,),
    53: (26,),
    54: (27, 28, 29, 30, 37, 38, 39, 40),
    55: (31, 32, 33),
    56: (1, 2, 3, 4, 34, 35, 36),
    58: (5, 6, 7, 41, 42),
    59: (16, 19, 20),
    60: (17, 18),
}
"""Rooms on each hallway."""


def draft_museum() -> FloorPlan:
    """Draw a museum of 64 galleries in enfilade, 59 m x 59 m, with doorways of 2 m: 21 independent cycles.

    Each row of galleries is one enfilade from end to end; four doorways lead from each row to the next.
    """
    xs, ys = [0, 7, 14, 23, 30, 37, 44, 52, 59], [0, 8, 15, 22, 29, 36, 45, 52, 59]
    number = {(row, column): 8 * row + column + 1 for row in range(8) for column in range(8)}
    columns, rows = list(pairwise(xs)), list(pairwise(reversed(ys)))
    galleries = []
    for (row, column), n in number.items():
        (left, right), (top, bottom) = columns[column], rows[row]
        galleries.append(Room(n, f"gallery {n}", ((left, bottom), (right, top))))
    along = [(number[row, column], number[row, column + 1]) for row in range(8) for column in range(7)]
    across = [(number[row, c], number[row + 1, c]) for row in range(7) for c in _CROSSINGS[row % 2]]
    doors = [Door(pair, width=2.0) for pair in along + across]
    return draft_plan("museum", galleries, doors, start=(60, 61), source="bundled")


_CROSSINGS = ((0, 2, 5, 7), (1, 3, 4, 6))
"""Columns, from 0, of the doorways from an even row of galleries to the next, and from an odd one."""


DRAFTS: dict[str, Callable[[], FloorPlan]] = {"house": draft_house, "museum": draft_museum, "office": draft_office}
"""The bundled plans that are drawn here, by name."""


def write_drafts(folder: Path) -> list[Path]:
    """Write every draft as GeoJSON into a folder; ``maps/bundled`` holds what this writes."""
    return [write_geojson(draft(), folder / f"{name}.geojson") for name, draft in DRAFTS.items()]
