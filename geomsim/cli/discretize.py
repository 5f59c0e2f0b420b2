"""``geomsim discretize``: a floor plan cut into cells, as GeoJSON, as a picture, and a report."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from geomsim.cli.console import say, say_json
from geomsim.cli.flags import JsonFlag, OutFlag

__all__ = ["discretize"]


def discretize(
    plan: str,
    *,
    method: Annotated[str, Parameter(help="How to cut.")] = "exact",
    radius: Annotated[float, Parameter(help="Radius of the robot that must fit through a portal, metres.")] = 0.2,
    picture: Annotated[bool, Parameter(help="Draw the picture.")] = True,
    out: OutFlag = None,
    json: JsonFlag = False,
) -> int:
    """Cut a floor plan into cells; write them as GeoJSON and as a picture, and report on them.

    Parameters
    ----------
    plan
        A bundled plan (`geomsim maps` lists them) or a file: GeoJSON, or the YAML of a ROS map.
    """
    from json import dumps

    from discretize import check_cells, convex_cells, write_cells
    from geomsim.files import output_folder, replacing, write_text
    from maps import read_plan

    begun = time.perf_counter()
    place = read_plan(plan)
    cells = convex_cells(place, method=method, radius=radius)
    seconds = time.perf_counter() - begun
    report = check_cells(cells)
    folder = output_folder(out or Path("geomsim-output") / f"{place.name}-cells")
    files = {"cells": folder / "cells.geojson", "report": folder / "report.json"}
    with replacing(files["cells"]) as part:
        write_cells(cells, part)
    if picture:
        from geomsim.drawing import write_cells_picture

        files["picture"] = write_cells_picture(cells, folder / "cells.png")
    result = {
        "plan": place.name,
        "method": cells.method,
        "cells": len(cells),
        "portals": len(cells.portals),
        "edges": [[i + 1, j + 1] for i, j in cells.edges],
        "area": report.area,
        "coverage": report.coverage,
        "overlap": report.overlap,
        "convexity": report.convexity,
        "free_components": report.free_components,
        "graph_components": report.graph_components,
        "pockets": list(report.pockets),
        "blocked_doors": list(report.blocked_doors),
        "problems": list(report.problems),
        "repairs": [repair.message for repair in place.repairs],
        "seconds": seconds,
        "files": {kind: str(path) for kind, path in files.items()},
    }
    write_text(files["report"], dumps(result, indent=1) + "\n")
    if json:
        say_json(result)
        return 0
    say(f"{place.name}: {len(cells)} cells, {len(cells.portals)} portals, {report.area:.1f} m2, {seconds:.2f} s")
    say(f"covered {report.coverage:.9f}, overlap {report.overlap:.1e}, least convexity {report.convexity:.6f}")
    say(f"connected parts of the free space: {report.free_components}, of the cell graph: {report.graph_components}")
    if report.pockets:
        say(f"cells that a robot of radius {radius:g} m cannot enter: {len(report.pockets)}")
    if report.blocked_doors:
        say(f"doors that it cannot pass: {', '.join(map(str, report.blocked_doors))}")
    for sentence in (*report.problems, *(repair.message for repair in place.repairs)):
        say(f"  {sentence}")
    for kind, path in files.items():
        say(f"{kind + ':':<10} {path}")
    return 0
