"""Find somebody who moves about a building: probabilistic pursuit with several robots in a continuous 2D world.

Ten lines run a pursuit::

    import geomsim as gs

    plan = gs.load_plan("office")
    cells = gs.convex_cells(plan)
    team = gs.Team(pursuers=2, planner=gs.Decoupled(cost="entropy", depth=5))
    episode = gs.run_episode(plan, cells, team, seed=7)
    print(episode)
    episode.save_video("pursuit.mp4")
"""

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from discretize import CellMap, Portal, check_cells, convex_cells
    from geomsim.communication import Communication
    from geomsim.conformance import check_evader
    from geomsim.episode import Capture, Episode, Outcome, Status
    from geomsim.evaders import CentroidBoundary, Fleeing, Hiding, ShortestPaths, Still, register_evader
    from geomsim.guide import Guide, Order, Orders, Report
    from geomsim.plugins import load_plugins
    from geomsim.pursuit import Timing, run_episode
    from geomsim.scenario import Scenario, read_scenario
    from geomsim.sensing import Sensor
    from geomsim.team import Evader, Team
    from geomsim.trials import Trials, run_trials
    from geomsim.waypoints import Waypoint, plan_waypoints, record_waypoints
    from maps import FloorPlan, Format, GeomsimError, check_format, register_format, write_plan
    from maps import read_plan as load_plan
    from planners import (
        Decoupled,
        Random,
        SearchGraph,
        Stationary,
        check_cost,
        check_policy,
        register_cost,
        register_planner,
    )

__all__ = [
    "Capture",
    "CellMap",
    "CentroidBoundary",
    "Communication",
    "Decoupled",
    "Episode",
    "Evader",
    "Fleeing",
    "FloorPlan",
    "Format",
    "GeomsimError",
    "Guide",
    "Hiding",
    "Order",
    "Orders",
    "Outcome",
    "Portal",
    "Random",
    "Report",
    "Scenario",
    "SearchGraph",
    "Sensor",
    "ShortestPaths",
    "Stationary",
    "Status",
    "Still",
    "Team",
    "Timing",
    "Trials",
    "Waypoint",
    "check_cells",
    "check_cost",
    "check_evader",
    "check_format",
    "check_policy",
    "convex_cells",
    "load_plan",
    "load_plugins",
    "plan_waypoints",
    "read_scenario",
    "record_waypoints",
    "register_cost",
    "register_evader",
    "register_format",
    "register_planner",
    "run_episode",
    "run_trials",
    "write_plan",
]

# Where each public name lives: it is imported when first asked for, so that `import geomsim` costs next to nothing.
_HOMES = {
    "discretize": ("CellMap", "Portal", "check_cells", "convex_cells"),
    "maps": ("FloorPlan", "Format", "GeomsimError", "check_format", "register_format", "write_plan"),
    "planners": (
        "Decoupled",
        "Random",
        "SearchGraph",
        "Stationary",
        "check_cost",
        "check_policy",
        "register_cost",
        "register_planner",
    ),
    "geomsim.communication": ("Communication",),
    "geomsim.conformance": ("check_evader",),
    "geomsim.episode": ("Capture", "Episode", "Outcome", "Status"),
    "geomsim.evaders": ("CentroidBoundary", "Fleeing", "Hiding", "ShortestPaths", "Still", "register_evader"),
    "geomsim.guide": ("Guide", "Order", "Orders", "Report"),
    "geomsim.plugins": ("load_plugins",),
    "geomsim.pursuit": ("Timing", "run_episode"),
    "geomsim.scenario": ("Scenario", "read_scenario"),
    "geomsim.sensing": ("Sensor",),
    "geomsim.team": ("Evader", "Team"),
    "geomsim.trials": ("Trials", "run_trials"),
    "geomsim.waypoints": ("Waypoint", "plan_waypoints", "record_waypoints"),
}


def _refuse_foreign_packages() -> None:
    """Other distributions have packages of these names too; beside one of them nothing here could work."""
    home = Path(__file__).resolve().parent.parent
    for name in ("maps", "discretize", "planners"):
        spec = find_spec(name)
        if spec is None or spec.origin is None or Path(spec.origin).resolve().parent.parent != home:
            found = "nowhere" if spec is None else spec.origin or next(iter(spec.submodule_search_locations or ["?"]))
            raise ImportError(
                f"geomsim needs its own package {name!r} at {home / name}, but Python finds it at {found}: "
                "install geomsim into a fresh virtual environment, and do not run it beside a folder of that name."
            )


_refuse_foreign_packages()


def __getattr__(name: str) -> object:
    if name == "load_plan":
        return import_module("maps").read_plan
    for home, names in _HOMES.items():
        if name in names:
            return getattr(import_module(home), name)
    raise AttributeError(f"module 'geomsim' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
