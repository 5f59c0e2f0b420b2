"""Cut every plan of the manifest with the default method, score the cells against people's labels, print and store.

usage: python tests/benchmarks/cells.py [PREFIX ...] [--method NAME] [--half develop|hold-out] [--out DIR]

``PREFIX`` is the beginning of a manifest identifier ("ipa/"). The plans are split in two halves by a checksum of the
building's name; parameters may be chosen on the first only. The table goes to ``cells.json`` and ``cells.md`` in
``--out``, beside this program unless told otherwise. Every plan is cut in a process of its own, on one core; seconds
are those of the processor, from the plan to cells, portals and routes.
"""

import argparse
import importlib.util
import json
import multiprocessing
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from zlib import crc32

import numpy as np
import shapely
import yaml

from discretize import DEFAULT_METHOD, METHODS, CellMap, check_cells, convex_cells
from discretize.cells_geojson import write_cells
from maps import FloorPlan, GeomsimError, read_plan

SHARED = Path(__file__).parents[3] / "shared"
ROOT = SHARED / "floorplans"
TOOL = SHARED / "tools" / "score_cells.py"
COLUMNS = (
    *(
        "cells",
        "among_labels",
        "rooms",
        "iou50",
        "iou75",
        "hull90",
        "sight_mean",
        "sight_worst",
        "doors",
        "parted",
        "reflex",
    ),
    *("overlap", "uncovered", "invalid", "free_parts", "graph_parts", "problems", "seconds", "megabytes"),
)
BESIDE = 0.75
"""A door parts two cells if the places so far to either side of its middle lie in two, metres."""


def load(entry: dict) -> FloorPlan:
    """Read one plan of the manifest; pictures without a scale are at 0.05 m a pixel unless the manifest knows."""
    path = ROOT / entry["file"]
    yaml_file = ROOT / entry.get("yaml", Path(entry["file"]).with_suffix(".yaml"))
    if entry["category"] in ("ros", "bwi_gdc") and yaml_file.exists():
        return read_plan(yaml_file)
    resolution = entry.get("resolution_m_per_px")
    if entry["category"] in ("ipa", "kth", "stage", "resplan"):
        return read_plan(path, resolution=resolution if isinstance(resolution, float) else 0.05)
    return read_plan(path)


def reflex_vertices(plan: FloorPlan) -> int:
    """Count the corners that jut into the free space."""
    count = 0
    for part in plan.parts:
        for ring, inside in ((part.exterior, 1), *((hole, -1) for hole in part.interiors)):
            xy = np.array(ring.coords)[:-1]
            before, after = xy - np.roll(xy, 1, axis=0), np.roll(xy, -1, axis=0) - xy
            side = 1 if ring.is_ccw else -1
            count += int(((before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]) * side * inside < 0).sum())
    return count


def labelled_doors(entry: dict, cells: CellMap) -> tuple[int, int]:
    """Count the doors that a person marked and that have free space on both sides, and those that part two cells."""
    file = (ROOT / entry["file"]).with_name(Path(entry["file"]).stem + "_doors.yaml")
    if not file.exists():
        return 0, 0
    ends = np.array([[d["door_corner_pt_1"], d["door_corner_pt_2"]] for d in yaml.safe_load(file.read_text())])
    along = ends[:, 1] - ends[:, 0]
    across = BESIDE * np.stack([-along[:, 1], along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
    sides = np.stack([cells.locate(ends.mean(axis=1) + sign * across) for sign in (1, -1)], axis=1)
    free = sides[(sides >= 0).all(axis=1)]
    return len(free), int((free[:, 0] != free[:, 1]).sum())


def among_labels(entry: dict, path: Path) -> dict:
    """Count the cells that the scoring tool compares with labels: those that hold enough of what is labelled."""
    spec = importlib.util.spec_from_file_location("score_cells", TOOL)
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    rooms = tool.human_labels(entry)
    if rooms is None:
        return {}
    features = json.loads(path.read_text())["features"]
    cells = [shapely.geometry.shape(f["geometry"]) for f in features if f["properties"]["kind"] == "cell"]
    segments = np.where(rooms > 0, tool.rasterise(cells, rooms.shape, *tool.frame(entry)), 0)
    counts = np.unique(segments[segments > 0], return_counts=True)[1]
    return {"among_labels": int((counts > tool.MIN_PIXELS[entry["category"]]).sum())}


def cut(entry: dict, method: str, path: Path) -> dict:
    """Cut one plan, write its cells and return what there is to know without labels."""
    plan = load(entry)
    start = time.process_time()
    cells = convex_cells(plan, method=method)
    seconds = time.process_time() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1024 if sys.platform != "darwin" else 1024**2)
    report = check_cells(cells)
    write_cells(cells, path)
    doors, parted = labelled_doors(entry, cells)
    row = {
        "vertices": sum(len(wall) for wall in plan.walls[:, :1]),
        "reflex": reflex_vertices(plan),
        "uncovered": abs(1 - report.coverage),
        "free_parts": report.free_components,
        "graph_parts": report.graph_components,
        "problems": len(report.problems),
        "seconds": seconds,
        "megabytes": round(peak),
        "told": [*report.problems, *report.notes],
    }
    return row | ({"doors": doors, "parted": parted} if doors else {})


def score(entry: dict, method: str) -> dict:
    """Cut one plan in a process of its own and return its row of the table."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "cells.geojson"
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            row = pool.apply(cut, (entry, method, path))
        command = [sys.executable, str(TOOL), entry["id"], str(path)]
        found = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
        return found | among_labels(entry, path) | row


def summary(rows: list[dict], name: str) -> dict:
    """Return one row for a labelled set, rooms counting alike."""
    rooms = np.array([row["rooms"] for row in rows])
    cells = np.array([row["cells"] for row in rows])
    doors = {key: sum(row[key] for row in rows) for key in ("doors", "parted")} if "doors" in rows[0] else {}
    return {
        "id": f"all of {name}",
        "rooms": int(rooms.sum()),
        "cells": int(cells.sum()),
        "among_labels": sum(row["among_labels"] for row in rows),
        "cells_a_room": float(cells.sum() / rooms.sum()),
        **{key: float(np.average([row[key] for row in rows], weights=rooms)) for key in ("iou50", "iou75")},
        "hull90": float(np.average([row["hull90"] for row in rows], weights=cells)),
        "sight_mean": float(np.mean([row["sight_mean"] for row in rows])),
        "sight_worst": min(row["sight_worst"] for row in rows),
        **{key: max(row[key] for row in rows) for key in ("overlap", "uncovered", "megabytes")},
        **{key: sum(row[key] for row in rows) for key in ("invalid", "problems", "seconds")},
        **doors,
    }


def line(row: dict) -> str:
    """Return one line of the Markdown table."""
    values = [row.get(column, "") for column in COLUMNS]
    texts = [
        f"{v:.1g}" if isinstance(v, float) and 0 < abs(v) < 1e-3 else f"{v:.3f}" if isinstance(v, float) else v
        for v in values
    ]
    share = f" ({row['cells_a_room']:.3f} cells a room)" if "cells_a_room" in row else ""
    return " | ".join([row["id"] + share, *map(str, texts)])


def wanted(given: argparse.Namespace) -> list[dict]:
    """Return the entries of the manifest that were asked for."""
    entries = json.loads((ROOT / "MANIFEST.json").read_text())["entries"]
    entries = [e for e in entries if e["role"] == "plan" and e["id"].startswith(tuple(given.prefix or [""]))]
    if given.half:
        kept = given.half == "hold-out"
        entries = [e for e in entries if crc32(e["group"].removesuffix("_furnitures").encode()) % 2 == kept]
    return entries


def main() -> None:
    """Run, print, store."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("prefix", nargs="*")
    parser.add_argument("--method", choices=tuple(METHODS), default=DEFAULT_METHOD)
    parser.add_argument("--half", choices=("develop", "hold-out"))
    parser.add_argument("--out", type=Path, default=Path(__file__).parent)
    given = parser.parse_args()
    os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    rows, lines = [], [" | ".join(["plan", *COLUMNS]), " | ".join(["---"] * (len(COLUMNS) + 1))]
    print("\n".join(lines))
    for entry in wanted(given):
        try:
            row = score(entry, given.method)
        except GeomsimError as error:
            row = {"id": entry["id"], "told": [str(error)]}
        rows.append(row | {"set": "ipa furnished" if "_furnitures" in entry["id"] else entry["category"]})
        lines.append(line(row))
        print(lines[-1], *row["told"], flush=True)
        store(given, rows, lines)
    for name in sorted({row["set"] for row in rows if "rooms" in row}):
        rows.append(summary([row for row in rows if row.get("set") == name and "rooms" in row], name))
        lines.append(line(rows[-1]))
        print(lines[-1])
        store(given, rows, lines)


def store(given: argparse.Namespace, rows: list[dict], lines: list[str]) -> None:
    """Write the table as far as it goes."""
    given.out.mkdir(parents=True, exist_ok=True)
    (given.out / "cells.json").write_text(json.dumps({"method": given.method, "plans": rows}, indent=1) + "\n")
    (given.out / "cells.md").write_text("\n".join(f"| {text} |" for text in lines) + "\n")


if __name__ == "__main__":
    main()
