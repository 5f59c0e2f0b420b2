"""``geomsim discretize``: a floor plan cut into cells, as GeoJSON, as a picture, and a report."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from geomsim.cli.console import say, say_json
from geomsim.cli.flags import JsonFlag, OutFlag, PlanFlags

if TYPE_CHECKING:
    from discretize import CellMap, CellReport, Certificate

__all__ = ["discretize"]


def discretize(
    plan: str,
    *,
    method: Annotated[str, Parameter(help="How to cut: rooms, exact, quine-mccluskey or visibility.")] = "rooms",
    cells: Annotated[
        Path | None, Parameter(help="Cells that this command wrote and a person may have changed, to be checked.")
    ] = None,
    radius: Annotated[float, Parameter(help="Radius of the robot that must fit through a portal, metres.")] = 0.2,
    picture: Annotated[bool, Parameter(help="Draw the picture.")] = True,
    out: OutFlag = None,
    json: JsonFlag = False,
    flags: PlanFlags = PlanFlags(),  # noqa: B008 a frozen value without fields set
) -> int:
    """Cut a floor plan into cells; write them as GeoJSON and as a picture, and report on them.

    Parameters
    ----------
    plan
        A bundled plan or a file, a GeoJSON or a ROS map for instance; `geomsim maps` lists what there is.
    """
    from json import dumps

    from discretize import cells_text, certify, check_cells, convex_cells, read_cells
    from geomsim.files import default_folder, results_folder, write_text

    begun = time.perf_counter()
    place = flags.read(plan)
    made = read_cells(cells, place, radius=radius) if cells else convex_cells(place, method=method, radius=radius)
    seconds = time.perf_counter() - begun
    result = _result(made, check_cells(made), certify(made), seconds)
    with results_folder(out or default_folder(place.name, "cells")) as folder:
        files = {"cells": folder / "cells.geojson", "report": folder / "report.json"}
        write_text(files["cells"], cells_text(made))
        if picture:
            from geomsim.drawing import write_cells_picture

            files["picture"] = write_cells_picture(made, folder / "cells.png")
        result["files"] = {kind: str(path) for kind, path in files.items()}
        write_text(files["report"], dumps(result, indent=1) + "\n")
    if json:
        say_json(result)
    else:
        _tell(result, radius)
    return 0


def _result(cells: CellMap, report: CellReport, certificate: Certificate, seconds: float) -> dict[str, Any]:
    return {
        "plan": cells.plan.name,
        "method": cells.method,
        "cells": len(cells),
        "portals": len(cells.portals),
        "edges": [[i + 1, j + 1] for i, j in cells.edges],
        "area": report.area,
        "coverage": report.coverage,
        "overlap": report.overlap,
        "convexity": report.convexity,
        "tolerance": report.tolerance if report.tolerance < 1 else None,
        "strict": cells.strict,
        "free_components": report.free_components,
        "graph_components": report.graph_components,
        "pockets": list(report.pockets),
        "blocked_doors": list(report.blocked_doors),
        "certificate": {
            "reflex_bound": certificate.reflex_bound,
            "hidden_bound": certificate.hidden_bound,
            "exact": certificate.exact,
            "mutual_sight": certificate.mutual_sight,
        },
        "problems": list(report.problems),
        "notes": list(report.notes),
        "repairs": [repair.message for repair in cells.plan.repairs],
        "seconds": seconds,
    }


def _tell(told: dict[str, Any], radius: float) -> None:
    size = f"{told['cells']} cells, {told['portals']} portals, {told['area']:.1f} m2"
    say(f"{told['plan']}: {size}, {told['seconds']:.2f} s")
    say(f"covered {told['coverage']:.9f}, overlap {told['overlap']:.1e}")
    say(f"area of a cell over its convex hull's: at least {told['convexity']:.6f}{_promise(told)}")
    say(f"connected parts of the free space: {told['free_components']}, of the cell graph: {told['graph_components']}")
    bounds = told["certificate"]
    at_least = max(bounds["reflex_bound"], bounds["hidden_bound"])
    say(f"no strictly convex cutting has fewer than {at_least} cells; the exact method makes {bounds['exact']}")
    say(f"least share of a cell that a place in it sees of the others: {bounds['mutual_sight']:.3f}")
    if told["pockets"]:
        say(f"cells that a robot of radius {radius:g} m cannot enter: {len(told['pockets'])}")
    if told["blocked_doors"]:
        say(f"doors that it cannot pass: {', '.join(map(str, told['blocked_doors']))}")
    for sentence in (*told["problems"], *told["notes"], *told["repairs"]):
        say(f"  {sentence}")
    for kind, path in told["files"].items():
        say(f"{kind + ':':<10} {path}")


def _promise(told: dict[str, Any]) -> str:
    """Words for how nearly convex cells should be."""
    if told["tolerance"] is None:
        return ""
    judged = "" if told["strict"] else ", small obstacles and what is too narrow for the robot left out"
    return f" (tolerance {told['tolerance']:g}{judged})"
