"""The museum: galleries in enfilade, so many cycles that no team of a few robots can cut them all."""

from __future__ import annotations

from maps.drafting import Door, Room, draft_plan
from maps.floorplan import FloorPlan

__all__ = ["draft_museum"]

# Widths and depths of the galleries, metres; rows from the north, so that numbers read like a page.
WIDTHS = [7, 8, 6, 9, 9, 6, 8, 7]
DEPTHS = [7, 6, 8, 7, 7, 8, 6, 7]

# Two courtyards, by column and row, that are not part of the museum's floor.
COURTYARDS = {(2, 2), (5, 5)}

# Walls without a doorway, between a gallery and its eastern (E) or southern (S) neighbour, by column and row.
CLOSED = {
    "E": {(1, 1), (5, 1), (4, 2), (6, 3), (0, 5), (3, 5), (1, 6), (5, 6)},
    "S": {(0, 0), (7, 0), (2, 3), (6, 4), (1, 3), (4, 4), (0, 6), (3, 6)},
}


def draft_museum() -> FloorPlan:
    """Draw a museum of 62 galleries, 60 m x 56 m, with doorways 2 m wide in line with each other."""
    xs = [sum(WIDTHS[:k]) for k in range(len(WIDTHS) + 1)]
    ys = [sum(DEPTHS) - sum(DEPTHS[:k]) for k in range(len(DEPTHS) + 1)]
    places = [(i, j) for j in range(len(DEPTHS)) for i in range(len(WIDTHS)) if (i, j) not in COURTYARDS]
    number = {place: k + 1 for k, place in enumerate(places)}
    rooms = [Room(number[i, j], f"gallery {number[i, j]}", ((xs[i], ys[j + 1]), (xs[i + 1], ys[j]))) for i, j in places]
    doors = []
    for i, j in places:
        for side, other in (("E", (i + 1, j)), ("S", (i, j + 1))):
            if other in number and (i, j) not in CLOSED[side]:
                doors.append(Door((number[i, j], number[other]), width=2.0))
    return draft_plan("museum", rooms, doors, start=(number[3, 0], number[4, 0]), source="bundled")
