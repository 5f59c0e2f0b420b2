"""What agents observe and may do, as spaces of Gymnasium."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from geomsim.learning.hunt import Hunt

__all__ = ["Views"]


class Views:
    """Observations and actions of the robots in a hunt of N cells and P robots.

    Parameters
    ----------
    hunt : Hunt
        What is looked at.
    """

    def __init__(self, hunt: Hunt) -> None:
        self.hunt = hunt
        x0, y0, x1, y1 = hunt.cells.plan.bounds
        self._low, self._high = np.array([x0, y0], np.float32) - 1, np.array([x1, y1], np.float32) + 1
        neighbours = hunt.work.routes.neighbours
        self.options = 1 + max(len(row) for row in neighbours)

    def own_space(self) -> spaces.Dict:
        """Return the space of :meth:`own`."""
        n, p = len(self.hunt.cells), self.hunt.team.pursuers
        parts: dict[str, spaces.Space[Any]] = {
            "belief": spaces.Box(0.0, 1.0, (n + 1,), np.float32),
            "places": spaces.Box(np.tile(self._low, (p, 1)), np.tile(self._high, (p, 1)), dtype=np.float32),
            "cells": spaces.MultiDiscrete([n] * p),
            "seen": spaces.MultiBinary(n),
        }
        if self.hunt.control == "checkpoint":
            parts["action_mask"] = spaces.MultiBinary(self.options)
        return spaces.Dict(parts)

    def own(self, robot: int) -> dict[str, NDArray[Any]]:
        """Return what one robot observes; in ``places`` and ``cells`` it comes first, then the others."""
        order = [robot, *(k for k in range(self.hunt.team.pursuers) if k != robot)]
        told = self.all()
        view = {
            "belief": told["belief"],
            "places": told["places"][order],
            "cells": told["cells"][order],
            "seen": told["seen"][robot],
        }
        if self.hunt.control == "checkpoint":
            view["action_mask"] = told["action_mask"][robot]
        return view

    def all_space(self) -> spaces.Dict:
        """Return the space of :meth:`all`."""
        n, p = len(self.hunt.cells), self.hunt.team.pursuers
        parts = dict(self.own_space().spaces) | {"seen": spaces.MultiBinary([p, n])}
        if self.hunt.control == "checkpoint":
            parts["action_mask"] = spaces.MultiBinary([p, self.options])
        return spaces.Dict(parts)

    def all(self) -> dict[str, NDArray[Any]]:
        """Return what the whole team observes."""
        hunt = self.hunt
        view: dict[str, NDArray[Any]] = {
            "belief": np.clip(hunt.work.beliefs[0], 0.0, 1.0).astype(np.float32),
            "places": np.clip(hunt.work.positions[0], self._low, self._high).astype(np.float32),
            "cells": hunt.work.cells[0].astype(np.int64),
            "seen": hunt.sights().astype(np.int8),
        }
        if hunt.control == "checkpoint":
            mask = np.zeros((hunt.team.pursuers, self.options), np.int8)
            for robot, waits in enumerate(hunt.waiting.tolist()):
                mask[robot, : len(hunt.choices(robot)) if waits else 1] = 1
            view["action_mask"] = mask
        return view

    def act(self, actions: dict[int, Any]) -> None:
        """Carry out what each robot was told; who was told nothing stays, or stands."""
        hunt = self.hunt
        if hunt.control == "velocity":
            still = np.zeros(2)
            shares = [np.asarray(actions.get(robot, still), np.float64) for robot in range(hunt.team.pursuers)]
            hunt.drive(np.array(hunt.team.speeds)[:, np.newaxis] * np.stack(shares))
            return
        goals = {}
        for robot in np.flatnonzero(hunt.waiting).tolist():
            choices, action = hunt.choices(robot), int(actions.get(robot, 0))
            goals[robot] = choices[action if action < len(choices) else 0]
        hunt.send(goals)
