"""The pursuers as agents of a PettingZoo parallel environment."""

from __future__ import annotations

from functools import cache
from typing import Any, ClassVar

import numpy as np
from gymnasium import spaces
from gymnasium.utils import seeding
from numpy.typing import NDArray
from pettingzoo import ParallelEnv

from geomsim.learning.hunt import CONTROLS, Hunt
from geomsim.learning.pictures import frame
from geomsim.learning.views import Views
from geomsim.scenario import read_scenario
from maps import GeomsimError, nearest

__all__ = ["PursuitEnv", "check_options"]

RENDER_MODES = ["rgb_array"]


def check_options(control: str, render_mode: str | None) -> None:
    """Raise GeomsimError if there is no such control or render mode."""
    if control not in CONTROLS:
        raise GeomsimError(f"There is no control {control!r}; {nearest(control, CONTROLS)}")
    if render_mode is not None and render_mode not in RENDER_MODES:
        raise GeomsimError(f"There is no render mode {render_mode!r}; {nearest(render_mode, RENDER_MODES)}")


class PursuitEnv(ParallelEnv[str, dict[str, NDArray[Any]], Any]):
    """Robots ``robot_1`` to ``robot_P`` look for an evader.

    *Observation*, a dict: ``belief`` (N + 1,), index 0 the capture state; ``places`` (P, 2), metres, the robot's own
    first; ``cells`` (P,), counted from 0, in the same order; ``seen`` (N,), 1 where the robot sees a cell's checkpoint;
    with checkpoints also ``action_mask``.

    *Action*: with ``control="checkpoint"`` 0 to stay for a belief step, k for the k-th neighbour of the cell, in rising
    order. A number beyond the last neighbour is a stay; of a robot that is on its way the action counts for nothing,
    and its mask leaves only 0. A step lasts until one of the robots is at its checkpoint. With ``control="velocity"``
    a share of the robot's speed in x and in y, for a belief step; it is cut where both together exceed 1.

    *Reward*: minus the seconds that the step lasted, for each robot. *Terminated* when the evader is captured,
    *truncated* at the time limit. ``infos[robot]`` has ``time``, seconds since the beginning, and
    ``captured_by``, counted from 0, -1 for nobody.

    Parameters
    ----------
    control : {"checkpoint", "velocity"}
        What robots are told.
    render_mode : {"rgb_array"}, optional
        Whether :meth:`render` draws.
    **keys
        The keys of a scenario file, such as ``plan="house"``, ``pursuers=3`` or ``capture="cell"``.

    Raises
    ------
    GeomsimError
        If a key or value is wrong.
    """

    metadata: ClassVar[dict[str, Any]] = {
        "name": "geomsim_pursuit_v0",
        "render_modes": RENDER_MODES,
        "render_fps": 5,
    }

    def __init__(self, control: str = "checkpoint", render_mode: str | None = None, **keys: Any) -> None:
        check_options(control, render_mode)
        self.render_mode = render_mode
        self.hunt = Hunt(read_scenario(None, keys), control)
        self._views = Views(self.hunt)
        self._chance, _ = seeding.np_random(keys.get("seed"))
        self.possible_agents = [f"robot_{k + 1}" for k in range(self.hunt.team.pursuers)]
        self.agents: list[str] = []
        self._spaces = cache(self._space)

    def observation_space(self, agent: str) -> spaces.Space[Any]:
        """Return what an agent may observe; always the same object."""
        return self._spaces("observation", agent)

    def action_space(self, agent: str) -> spaces.Space[Any]:
        """Return what an agent may do; always the same object."""
        return self._spaces("action", agent)

    def reset(
        self,
        seed: int | None = None,
        options: dict[str, Any] | None = None,  # noqa: ARG002 none are known
    ) -> tuple[dict[str, dict[str, NDArray[Any]]], dict[str, dict[str, Any]]]:
        """Begin anew: with the pursuit that :func:`geomsim.run_episode` runs of this seed, or the next of many."""
        if seed is not None:
            self._chance, _ = seeding.np_random(seed)
        self.hunt.begin(int(self._chance.integers(2**31)) if seed is None else seed)
        self.agents = list(self.possible_agents)
        return self._observed(self.agents), {agent: self.hunt.told() for agent in self.agents}

    def step(
        self, actions: dict[str, Any]
    ) -> tuple[
        dict[str, dict[str, NDArray[Any]]],
        dict[str, float],
        dict[str, bool],
        dict[str, bool],
        dict[str, dict[str, Any]],
    ]:
        """Let the robots go on."""
        before, agents = self.hunt.time, self.agents
        self._views.act({self.possible_agents.index(agent): action for agent, action in actions.items()})
        captured, over = self.hunt.captured, self.hunt.over
        if over:
            self.agents = []
        return (
            self._observed(agents),
            dict.fromkeys(agents, before - self.hunt.time),
            dict.fromkeys(agents, captured),
            dict.fromkeys(agents, over and not captured),
            {agent: self.hunt.told() for agent in agents},
        )

    def render(self) -> NDArray[np.uint8] | None:
        """Draw this moment, shape (height, width, 3), red first; None without a render mode."""
        return None if self.render_mode is None else frame(self.hunt)

    def close(self) -> None:
        """Leave nothing behind: nothing is held."""

    def _space(self, kind: str, agent: str) -> spaces.Space[Any]:
        if agent not in self.possible_agents:
            raise GeomsimError(f"There is no agent {agent!r}; {nearest(agent, self.possible_agents)}")
        if kind == "observation":
            return self._views.own_space()
        if self.hunt.control == "velocity":
            return spaces.Box(-1.0, 1.0, (2,), np.float32)
        return spaces.Discrete(self._views.options)

    def _observed(self, agents: list[str]) -> dict[str, dict[str, NDArray[Any]]]:
        return {agent: self._views.own(self.possible_agents.index(agent)) for agent in agents}
