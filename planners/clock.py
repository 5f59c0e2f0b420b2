"""A limit on thinking time, which every planner that searches takes in the same way."""

from __future__ import annotations

import math
import time

__all__ = ["FOREVER", "Clock"]


class Clock:
    """Tells a search when to end with the best plan that it has.

    With a limit, results depend on the machine and on what else it does; so no planner has one unless it is asked for.

    Parameters
    ----------
    seconds : float
        Time from now on.
    """

    def __init__(self, seconds: float = math.inf) -> None:
        self.until = time.perf_counter() + seconds

    @property
    def left(self) -> float:
        """Seconds that are left; below 0 when time is over."""
        return self.until - time.perf_counter()

    def over(self) -> bool:
        """Whether time is over."""
        return time.perf_counter() >= self.until


FOREVER = Clock()
"""No limit."""
