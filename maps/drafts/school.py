"""The school: twelve rooms, some of them apart from each other, in the proportions of a real one."""

from __future__ import annotations

from maps.drafting import Door, Room, draft_plan
from maps.floorplan import FloorPlan

__all__ = ["draft_school"]


def draft_school() -> FloorPlan:
    """Draw a school of 70 m x 53 m.

    Rooms and their sizes follow the school that github.com/basfora/milp_sim (MIT) gives in metres; walls and doors,
    which it does not give, are ours.
    """
    rooms = [
        Room(1, "gymnasium", ((53, 0), (70, 31))),
        Room(2, "east hallway", ((66.6, 31), (70, 43.5))),
        Room(3, "classroom A", ((60.8, 32.2), (66.6, 35.2))),
        Room(4, "classroom B", ((60.8, 35.8), (66.6, 38.8))),
        Room(5, "classroom C", ((60.8, 39.4), (66.6, 42.4))),
        Room(6, "classroom D", ((60.6, 47.4), (68.5, 52.9))),
        Room(7, "classroom E", ((51.3, 47.4), (59.2, 52.9))),
        Room(8, "classroom F", ((42, 47.4), (49.9, 52.9))),
        Room(9, "classroom G", ((32.7, 47.4), (40.6, 52.9))),
        Room(10, "cafeteria", ((0, 33), (10, 50))),
        Room(11, "north hallway", ((20, 43.5), (70, 47.4))),
        Room(12, "west hallway", ((10, 43.5), (20, 51.8))),
    ]
    doors = [Door((1, 2), width=1.8), Door((2, 11), width=2.4), Door((11, 12), width=2.4), Door((10, 12), width=1.8)]
    doors += [Door((room, 2)) for room in (3, 4, 5)] + [Door((room, 11)) for room in (6, 7, 8, 9)]
    return draft_plan("school", rooms, doors, start=(11,), source="bundled")
