"""``geomsim export``: plan, cells and the way of the robots as files that other programs read."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from geomsim.cli.console import say, say_json
from geomsim.cli.flags import JsonFlag, OutFlag, ScenarioFlags

if TYPE_CHECKING:
    from discretize import CellMap
    from geomsim.waypoints import Waypoint

__all__ = ["export"]


def export(
    source: str | None = None,
    *,
    scenario: Annotated[Path | None, Parameter(help="A scenario file (TOML); flags override its keys.")] = None,
    duration: Annotated[float, Parameter(help="For how long the robots' way is planned, seconds.")] = 300.0,
    pixel: Annotated[float, Parameter(help="Size of a pixel of the ROS map, metres.")] = 0.05,
    out: OutFlag = None,
    json: JsonFlag = False,
    flags: ScenarioFlags = ScenarioFlags(),  # noqa: B008 a frozen value without fields set
) -> int:
    """Write what robots and other programs need: waypoints (CSV, Nav2), ROS map, cells (GeoJSON), graph (GraphML).

    Of a floor plan, the waypoints are what the team does for as long as nobody is captured; of a record, what it did.

    Parameters
    ----------
    source
        A bundled plan, a plan's file, or an `episode.npz` that `geomsim run` wrote.
    """
    from geomsim.files import default_folder, results_folder

    if source is not None and source.lower().endswith(".npz"):
        cells, rows = _recorded(source, flags, scenario)
        folder = out or Path(source).parent
    else:
        cells, rows, seed = _planned(source, flags, scenario, duration)
        folder = out or default_folder(cells.plan.name, f"{seed}-export")
    with results_folder(folder) as made:
        files = _write(made, cells, rows, pixel)
    if json:
        say_json({"plan": cells.plan.name, "robots": len(rows), "files": {k: str(v) for k, v in files.items()}})
        return 0
    say(f"{cells.plan.name}: {len(cells)} cells, {sum(map(len, rows))} waypoints of {len(rows)} robots")
    for kind, path in files.items():
        say(f"{kind + ':':<10} {path}")
    return 0


def _recorded(
    record: str, flags: ScenarioFlags, scenario: Path | None
) -> tuple[CellMap, tuple[tuple[Waypoint, ...], ...]]:
    from geomsim.episode import Episode
    from geomsim.waypoints import record_waypoints
    from maps import GeomsimError

    given = [key.replace("_", "-") for key in flags.given()] + ([] if scenario is None else ["scenario"])
    if given:
        raise GeomsimError(f"{record} is a record and holds its whole scenario: leave out --{given[0]}.")
    episode = Episode.load(record)
    return episode.cells, record_waypoints(episode)


def _planned(
    plan: str | None, flags: ScenarioFlags, scenario: Path | None, duration: float
) -> tuple[CellMap, tuple[tuple[Waypoint, ...], ...], int]:
    from geomsim.scenario import read_scenario
    from geomsim.waypoints import plan_waypoints

    told = read_scenario(scenario, flags.given() | ({} if plan is None else {"plan": plan}))
    _, cells = told.place()
    rows = plan_waypoints(
        cells, told.team(), duration=duration, seed=told.seed, motion=told.belief_motion(), timing=told.timing()
    )
    return cells, rows, told.seed


def _write(folder: Path, cells: CellMap, rows: tuple[tuple[Waypoint, ...], ...], pixel: float) -> dict[str, Path]:
    from discretize import cells_text
    from geomsim.files import write_text
    from geomsim.graphml import graphml_text
    from geomsim.waypoints import nav2_text, waypoints_text
    from maps import write_plan

    files: dict[str, Path] = {}
    # first what may be refused: a pixel may be so small that the image would be too large
    files["map"], files["image"] = write_plan(cells.plan, folder / "map.yaml", resolution=pixel)
    files["waypoints"] = write_text(folder / "waypoints.csv", waypoints_text(rows))
    for k, row in enumerate(rows, start=1):
        files[f"robot {k}"] = write_text(folder / f"robot_{k}.yaml", nav2_text(row))
    files["cells"] = write_text(folder / "cells.geojson", cells_text(cells))
    files["graph"] = write_text(folder / "graph.graphml", graphml_text(cells))
    return files
