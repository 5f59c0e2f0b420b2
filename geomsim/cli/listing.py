"""``geomsim maps`` and ``geomsim planners``: what there is to choose from."""

from __future__ import annotations

from geomsim.cli.console import say, say_json
from geomsim.cli.flags import JsonFlag

__all__ = ["maps", "planners"]


def maps(*, json: JsonFlag = False) -> int:
    """List the bundled floor plans, and the kinds of files that can be read."""
    from maps import FORMATS, bundled_names, read_plan

    plans = [read_plan(name) for name in bundled_names()]
    if json:
        say_json(
            {
                "maps": [{"name": p.name, "area": p.area, "bounds": p.bounds} for p in plans],
                "formats": [{"name": f.name, "suffixes": f.suffixes, "options": f.options} for f in FORMATS],
            }
        )
        return 0
    for p in plans:
        x0, y0, x1, y1 = p.bounds
        say(f"{p.name:<10} {x1 - x0:.0f} m x {y1 - y0:.0f} m, {p.area:.0f} m2 of free space")
    say("")
    for f in FORMATS:
        options = f" (--{' --'.join(f.options)})" if f.options else ""
        say(f"{f.name}: {' '.join(f.suffixes)}{options}")
    return 0


def planners(*, json: JsonFlag = False) -> int:
    """List the planners, each with one line and its source, and the names of heuristics and evader models."""
    from geomsim.evaders import EVADERS
    from planners import COSTS, PLANNERS

    if json:
        told = [{"name": k, "about": e.summary, "source": e.source} for k, e in PLANNERS.items()]
        say_json({"planners": told, "costs": list(COSTS), "evaders": list(EVADERS)})
        return 0
    for name, entry in PLANNERS.items():
        say(f"{name:<12} {entry.summary} [{entry.source}]")
    say("")
    say(f"cost heuristics: {', '.join(COSTS)}")
    say(f"evader models: {', '.join(EVADERS)}")
    return 0
