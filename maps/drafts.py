"""The bundled plans as sketches; :func:`write_drafts` turns them into the files in ``maps/bundled``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

from maps.drafting import Door, Room, draft_plan
from maps.floorplan import FloorPlan
from maps.geojson import write_geojson

__all__ = ["DRAFTS", "draft_house", "draft_office", "write_drafts"]


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
    """Draw an office floor of 45 rooms around two loops of hallways, 54 m x 27 m."""
    north = _row(1, [0, 8, 12, 16, 20, 24, 30, 34, 38, 42, 46, 54], 21.5, 27, "office")
    west = _column(14, [21.5, 17.5, 13.5, 9.5, 5.5], 0, 5, "office")
    core_north = _row(18, [7, 12, 16, 20, 26], 13.5, 19.5, "office") + _row(
        22, [28, 33, 37, 42, 47], 13.5, 19.5, "office"
    )
    core_south = _row(29, [7, 11, 17, 21, 26], 7.5, 13.5, "office") + _row(
        33, [28, 32, 38, 43, 47], 7.5, 13.5, "office"
    )
    east = _column(37, [21.5, 16, 11, 5.5], 49, 54, "office")
    south = _row(42, [0, 7, 11, 15, 19, 24, 30, 35, 39, 43, 47, 54], 0, 5.5, "office")
    hallways = [
        Room(12, "north hallway, west end", ((5, 19.5), (28, 21.5))),
        Room(13, "north hallway, east end", ((28, 19.5), (49, 21.5))),
        Room(26, "west hallway", ((5, 7.5), (7, 19.5))),
        Room(27, "middle hallway", ((26, 7.5), (28, 19.5))),
        Room(28, "east hallway", ((47, 7.5), (49, 19.5))),
        Room(40, "south hallway, west end", ((5, 5.5), (26, 7.5))),
        Room(41, "south hallway, east end", ((26, 5.5), (49, 7.5))),
    ]
    names = {
        1: "board room",
        6: "reception",
        11: "meeting room",
        21: "kitchen",
        22: "library",
        29: "copy room",
        33: "store room",
        36: "server room",
        42: "workshop",
        47: "common room",
        52: "meeting room",
    }
    rooms = [
        Room(r.number, names.get(r.number, r.name), r.corners)
        for r in north + west + core_north + core_south + east + south + hallways
    ]
    openings = [(12, 13), (12, 26), (12, 27), (13, 28), (26, 40), (27, 41), (28, 41), (40, 41)]
    doors = [Door(pair, width=1.6) for pair in openings]
    doors += _doors([1, 2, 3, 4, 5, 6, 18, 19, 20, 21], 12) + _doors([7, 8, 9, 10, 11, 22, 23, 24, 25], 13)
    doors += _doors([14, 15, 16, 17], 26) + _doors([37, 38, 39], 28)
    doors += _doors([29, 30, 31, 32, 42, 43, 44, 45, 46], 40) + _doors([33, 34, 35, 36, 47, 48, 49, 50, 51, 52], 41)
    # Two offices with an anteroom, and a kitchen with a second door.
    doors += [Door((2, 3), at=0.8), Door((50, 51), at=0.2), Door((21, 27), at=0.5)]
    return draft_plan("office", rooms, doors, start=(12, 13), source="bundled")


def _row(first: int, xs: Sequence[float], y0: float, y1: float, name: str) -> list[Room]:
    """Rooms side by side, numbered from left to right."""
    return [Room(first + k, name, ((x0, y0), (x1, y1))) for k, (x0, x1) in enumerate(pairwise(xs))]


def _column(first: int, ys: Sequence[float], x0: float, x1: float, name: str) -> list[Room]:
    """Rooms one below the other, numbered from the top."""
    return [Room(first + k, name, ((x0, y1), (x1, y0))) for k, (y0, y1) in enumerate(pairwise(ys))]


def _doors(rooms: Sequence[int], hallway: int) -> list[Door]:
    """Doors onto a hallway, those of neighbours in turn at the near and the far end of their wall."""
    return [Door((room, hallway), at=0.15 if k % 2 else 0.85) for k, room in enumerate(rooms)]


DRAFTS: dict[str, Callable[[], FloorPlan]] = {"house": draft_house, "office": draft_office}
"""The bundled plans that are drawn here, by name."""


def write_drafts(folder: Path) -> list[Path]:
    """Write every draft as GeoJSON into a folder; ``maps/bundled`` holds what this writes."""
    return [write_geojson(draft(), folder / f"{name}.geojson") for name, draft in DRAFTS.items()]
