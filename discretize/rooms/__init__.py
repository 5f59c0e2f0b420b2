"""Few, room- and hallway-like cells, convex up to a stated tolerance."""
