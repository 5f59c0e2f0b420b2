"""Planners as agents, to learn from or to be compared with."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geomsim.learning.central import CentralEnv
from geomsim.learning.parallel import PursuitEnv
from geomsim.seeds import Streams
from maps import GeomsimError
from planners import Planner, Policy

__all__ = ["PlannerAgents"]


class PlannerAgents:
    """Lets a planner act for all robots of an environment in which robots are told checkpoints.

    It acts as in :func:`geomsim.run_episode` with the same seed: the evader is captured at the same time.

    Parameters
    ----------
    env : PursuitEnv or CentralEnv
        Its hunt is asked for the state; whoever learns has the same in observations.
    planner : Planner
        What decides.

    Raises
    ------
    GeomsimError
        If robots are told velocities.
    """

    def __init__(self, env: PursuitEnv | CentralEnv, planner: Planner) -> None:
        self._chase, self._planner = env.hunt, planner
        if self._chase.control != "checkpoint":
            raise GeomsimError("Planners choose checkpoints; make the environment with control='checkpoint'.")
        self._policy: Policy | None = None
        self._plans: list[tuple[int, ...]] = []

    def act(self) -> NDArray[np.int64]:
        """Return an action for each robot, shape (P,), 0 for those on their way."""
        hunt = self._chase
        if self._policy is None or not hunt.work.choices:  # a new pursuit
            self._policy = self._planner.solve(hunt.problem, Streams(hunt.seed).deciding)
            self._plans = [()] * hunt.team.pursuers
        decisions = self._policy.decide(hunt.state(self._plans))
        actions = np.zeros(hunt.team.pursuers, dtype=np.int64)
        for robot in np.flatnonzero(hunt.waiting).tolist():
            decision = decisions[robot]
            if decision is not None:
                actions[robot] = hunt.choices(robot).index(decision.path[0])
                self._plans[robot] = tuple(decision.path[1:])
        return actions

    def acts(self) -> dict[str, int]:
        """Return the same for a :class:`PursuitEnv`, whose agents have names."""
        return {f"robot_{k + 1}": int(action) for k, action in enumerate(self.act())}
