"""The house: the nine rooms of the paper's Fig. 1."""

from __future__ import annotations

from maps.drafting import Door, Room, draft_plan
from maps.floorplan import FloorPlan

__all__ = ["draft_house"]


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
