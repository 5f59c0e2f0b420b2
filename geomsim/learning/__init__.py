"""Pursuits as environments for learning; needs ``pip install 'geomsim[rl]'``.

Gymnasium knows the one with a central controller as ``geomsim/Pursuit-v0`` once this package is imported.
"""

try:
    import gymnasium
    import pettingzoo  # noqa: F401  (missing, it is better missed here, with a sentence)
except ImportError as exc:
    raise ImportError(
        f"geomsim.learning needs the package {exc.name}; install it with: pip install 'geomsim[rl]'."
    ) from exc

from geomsim.learning.agents import PlannerAgents
from geomsim.learning.central import CentralEnv
from geomsim.learning.parallel import PursuitEnv

__all__ = ["CentralEnv", "PlannerAgents", "PursuitEnv"]

if "geomsim/Pursuit-v0" not in gymnasium.registry:
    gymnasium.register("geomsim/Pursuit-v0", entry_point="geomsim.learning:CentralEnv")
