"""One seed, several independent streams of chance: who draws from one does not disturb the others."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["Streams", "trial_seeds"]


@dataclass(frozen=True, slots=True)
class Streams:
    """The streams of one pursuit.

    Attributes
    ----------
    placing : Generator
        Where the evader starts.
    moving : Generator
        Where it goes.
    deciding : Generator
        The planner's.
    noticing : Generator
        How long robots look at the evader before they notice it.
    """

    placing: np.random.Generator
    moving: np.random.Generator
    deciding: np.random.Generator
    noticing: np.random.Generator

    @classmethod
    def of(cls, seed: int) -> Streams:
        """Make the streams of a seed."""
        return cls(*(np.random.default_rng(s) for s in np.random.SeedSequence(seed).spawn(4)))


def trial_seeds(seed: int, trials: int) -> list[int]:
    """Return the seed of each trial of an experiment; the first ones are the same whatever their number.

    They are below 2**53, so that a table or JSON can hold them.
    """
    words = np.random.SeedSequence(seed).generate_state(trials, np.uint64)
    return [int(word) for word in words >> np.uint64(11)]
