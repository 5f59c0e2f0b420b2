"""Randomness that depends on places, not on the order in which they are asked for."""

from math import log

import numpy as np
from numpy.typing import NDArray

__all__ = ["Field"]

Array = NDArray[np.float64]

WAVES = 8
SHORTEST, LONGEST = 0.4, 4.0  # waves, metres


class Field:
    """A smooth random function of the plane, about normal with variance 1: a sum of plane waves.

    A wall that is moved by a millimetre, or faces in another order, hardly change what it says.

    Parameters
    ----------
    rng : numpy.random.Generator
        Draws the waves.
    """

    def __init__(self, rng: np.random.Generator) -> None:
        angle, self._phase = rng.uniform(0.0, 2.0 * np.pi, (2, WAVES))
        number = 2.0 * np.pi / np.exp(rng.uniform(log(SHORTEST), log(LONGEST), WAVES))
        self._waves = number * np.stack([np.cos(angle), np.sin(angle)])

    def __call__(self, places: Array) -> Array:
        """Return its values at places, shape (k, 2), metres."""
        return np.asarray(np.sqrt(2.0 / WAVES) * np.cos(places @ self._waves + self._phase).sum(axis=1))
