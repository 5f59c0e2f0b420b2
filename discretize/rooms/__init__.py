"""Few, room- and hallway-like cells, convex up to a stated tolerance."""

from discretize.rooms.rooms import RoomCut, room_cells

__all__ = ["RoomCut", "room_cells"]
