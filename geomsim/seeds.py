"""One seed, several independent streams of chance: who draws from one does not disturb the others."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["Streams", "trial_seeds"]


@dataclass(frozen=True, slots=True)
class Streams:
    """The streams of one pursuit; each begins anew whenever it is asked for.

    Attributes
    ----------
    seed : int
        What they come from.
    """

    seed: int

    @property
    def placing(self) -> np.random.Generator:
        """Where the evader starts."""
        return self._stream(0)

    @property
    def moving(self) -> np.random.Generator:
        """Where it goes."""
        return self._stream(1)

    def moving_of(self, evader: int) -> np.random.Generator:
        """Where one of several evaders goes, counted from 0; of the first one as where there are no others."""
        return self._stream(1, evader) if evader else self.moving

    @property
    def deciding(self) -> np.random.Generator:
        """The planner's."""
        return self._stream(2)

    @property
    def noticing(self) -> np.random.Generator:
        """How long robots look at the evader before they notice it."""
        return self._stream(3)

    @property
    def measuring(self) -> np.random.Generator:
        """The noise of measurements."""
        return self._stream(4)

    def _stream(self, *number: int) -> np.random.Generator:
        return np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=number))


def trial_seeds(seed: int, trials: int) -> list[int]:
    """Return the seed of each trial of an experiment; the first ones are the same whatever their number.

    They are below 2**53, so that a table or JSON can hold them.
    """
    words = np.random.SeedSequence(seed).generate_state(trials, np.uint64)
    return [int(word) for word in words >> np.uint64(11)]
