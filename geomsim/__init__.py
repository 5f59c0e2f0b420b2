"""Find somebody who moves about a building: probabilistic pursuit with several robots in a continuous 2D world."""
