"""One controller for the whole team, as a Gymnasium environment."""

from __future__ import annotations

from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from geomsim.learning.hunt import Hunt
from geomsim.learning.parallel import RENDER_MODES, check_options
from geomsim.learning.pictures import frame
from geomsim.learning.views import Views
from geomsim.scenario import read_scenario

__all__ = ["CentralEnv"]


class CentralEnv(gymnasium.Env[dict[str, NDArray[Any]], NDArray[Any]]):
    """A controller that sees what all robots see, and tells each of them where to go.

    Observations, actions and rewards are those of :class:`geomsim.learning.PursuitEnv`, with a row for each robot:
    ``seen`` (P, N), ``action_mask`` (P, K); actions MultiDiscrete (P,) or, with ``control="velocity"``, Box (P, 2). The
    info has ``time`` and ``captured_by``, counted from 0, -1 for nobody.

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

    metadata: ClassVar[dict[str, Any]] = {"render_modes": RENDER_MODES, "render_fps": 5}

    def __init__(self, control: str = "checkpoint", render_mode: str | None = None, **keys: Any) -> None:
        check_options(control, render_mode)
        self.render_mode = render_mode
        self.hunt = Hunt(read_scenario(None, keys), control)
        self._views = Views(self.hunt)
        robots = self.hunt.team.pursuers
        self.observation_space = self._views.all_space()
        self.action_space = (
            spaces.Box(-1.0, 1.0, (robots, 2), np.float32)
            if control == "velocity"
            else spaces.MultiDiscrete([self._views.options] * robots)
        )

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
        """Begin anew: with the pursuit that :func:`geomsim.run_episode` runs of this seed, or the next of many."""
        super().reset(seed=seed, options=options)
        self.hunt.begin(int(self.np_random.integers(2**31)) if seed is None else seed)
        return self._views.all(), self.hunt.told()

    def step(self, action: NDArray[Any]) -> tuple[dict[str, NDArray[Any]], float, bool, bool, dict[str, Any]]:
        """Let the robots go on."""
        before = self.hunt.time
        self._views.act(dict(enumerate(action)))
        captured, over = self.hunt.captured, self.hunt.over
        return self._views.all(), before - self.hunt.time, captured, over and not captured, self.hunt.told()

    def render(self) -> NDArray[np.uint8] | None:
        """Draw this moment, shape (height, width, 3), red first; None without a render mode."""
        return None if self.render_mode is None else frame(self.hunt)
