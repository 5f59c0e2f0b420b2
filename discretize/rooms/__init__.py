"""Few, room- and hallway-like cells, convex up to a stated tolerance."""

from discretize.rooms.rooms import room_cells

__all__ = ["room_cells"]
