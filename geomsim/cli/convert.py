"""``geomsim convert``: a floor plan from one format into another."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from geomsim.cli.console import say, say_json
from geomsim.cli.flags import JsonFlag, PlanFlags

__all__ = ["convert"]


def convert(
    plan: str,
    target: Path,
    *,
    pixel: Annotated[float, Parameter(help="Size of a pixel of a ROS map that is written, metres.")] = 0.05,
    json: JsonFlag = False,
    flags: PlanFlags = PlanFlags(),  # noqa: B008 a frozen value without fields set
) -> int:
    """Read a floor plan in any format and write it as GeoJSON or as a ROS map.

    Parameters
    ----------
    plan
        A bundled plan or a file; `geomsim maps` lists what there is.
    target
        A new file: .geojson for all that a plan holds, .yaml for a ROS map and its image.
    """
    from maps import write_plan

    place = flags.read(plan)
    files = [str(path) for path in write_plan(place, target, resolution=pixel)]
    repairs = [repair.message for repair in place.repairs]
    if json:
        say_json({"plan": place.name, "area": place.area, "repairs": repairs, "files": files})
        return 0
    say(f"{place.name}: {place.area:.1f} m2 of free space")
    for line in (*repairs, *files):
        say(f"  {line}")
    return 0
