"""Cut every plan of the manifest into rooms, score the cells against people's labels, print and store the table.

usage: python tests/benchmarks/cells.py [PREFIX ...] [--half develop|hold-out] [--out DIR]

``PREFIX`` is the beginning of a manifest identifier ("ipa/"). The plans are split in two halves by a checksum of the
building's name; parameters may be chosen on the first only. The table goes to ``cells.json`` and ``cells.md`` in
``--out``.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from zlib import crc32

import numpy as np
import shapely

from discretize.rooms import room_cells
from maps import FloorPlan, PlanError, read_plan

SHARED = Path(__file__).parents[3] / "shared"
COLUMNS = ("cells", "rooms", "iou50", "iou75", "hull90", "sight_mean", "sight_worst", "overlap", "uncovered", "seconds")


def load(entry: dict) -> FloorPlan:
    """Read one plan of the manifest; pictures without a scale are at 0.05 m a pixel unless the manifest knows."""
    root = SHARED / "floorplans"
    path = root / entry["file"]
    yaml = root / entry.get("yaml", Path(entry["file"]).with_suffix(".yaml"))
    if entry["category"] in ("ros", "bwi_gdc") and yaml.exists():
        return read_plan(yaml)
    resolution = entry.get("resolution_m_per_px")
    if entry["category"] in ("ipa", "kth", "stage", "resplan"):
        return read_plan(path, resolution=resolution if isinstance(resolution, float) else 0.05)
    return read_plan(path)


def score(identifier: str, plan: FloorPlan) -> dict:
    """Cut one plan and return its row of the table."""
    start = time.process_time()
    cut = room_cells(plan)
    seconds = time.process_time() - start
    features = [{"type": "Feature", "properties": {}, "geometry": shapely.geometry.mapping(c)} for c in cut.cells]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "cells.geojson"
        path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
        command = [sys.executable, str(SHARED / "tools" / "score_cells.py"), identifier, str(path)]
        row = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    missing = plan.area - sum(cell.area for cell in cut.cells)
    return row | {"uncovered": abs(missing) / plan.area, "seconds": seconds, "notes": list(cut.notes)}


def summary(rows: list[dict], category: str) -> dict:
    """Return one row for a labelled set, rooms counting alike."""
    rooms = np.array([row["rooms"] for row in rows])
    cells = np.array([row["cells"] for row in rows])
    return {
        "id": f"all of {category}",
        "rooms": int(rooms.sum()),
        "cells": int(cells.sum()),
        **{key: float(np.average([row[key] for row in rows], weights=rooms)) for key in ("iou50", "iou75")},
        "hull90": float(np.average([row["hull90"] for row in rows], weights=cells)),
        "sight_mean": float(np.mean([row["sight_mean"] for row in rows])),
        "sight_worst": min(row["sight_worst"] for row in rows),
        "overlap": max(row["overlap"] for row in rows),
        "uncovered": max(row["uncovered"] for row in rows),
        "seconds": sum(row["seconds"] for row in rows),
    }


def line(row: dict) -> str:
    """Return one line of the Markdown table."""
    values = [row.get(column, "") for column in COLUMNS]
    texts = [
        f"{v:.3g}" if isinstance(v, float) and 0 < abs(v) < 1e-3 else f"{v:.3f}" if isinstance(v, float) else v
        for v in values
    ]
    return " | ".join([row["id"], *map(str, texts)])


def main() -> None:
    """Run, print, store."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("prefix", nargs="*", default=[""])
    parser.add_argument("--half", choices=("develop", "hold-out"))
    parser.add_argument("--out", type=Path, default=Path())
    given = parser.parse_args()
    entries = json.loads((SHARED / "floorplans" / "MANIFEST.json").read_text())["entries"]
    entries = [entry for entry in entries if entry["role"] == "plan"]
    if given.half:
        kept = given.half == "hold-out"
        entries = [entry for entry in entries if crc32(entry["group"].removesuffix("_furnitures").encode()) % 2 == kept]
    rows, lines = [], [" | ".join(["plan", *COLUMNS]), " | ".join(["---"] * (len(COLUMNS) + 1))]
    print("\n".join(lines))
    for entry in entries:
        if not entry["id"].startswith(tuple(given.prefix)):
            continue
        try:
            plan = load(entry)
        except PlanError as error:
            print(f"{entry['id']}: {error}")
            continue
        row = score(entry["id"], plan)
        kind = "ipa furnished" if "_furnitures" in entry["id"] else entry["category"]
        rows.append(row | {"set": kind})
        lines.append(line(row))
        print(lines[-1], *row["notes"], flush=True)
    for kind in sorted({row["set"] for row in rows if "rooms" in row}):
        rows.append(summary([row for row in rows if row.get("set") == kind], kind))
        lines.append(line(rows[-1]))
        print(lines[-1])
    given.out.mkdir(parents=True, exist_ok=True)
    (given.out / "cells.json").write_text(json.dumps(rows, indent=1) + "\n")
    (given.out / "cells.md").write_text("\n".join(f"| {text} |" for text in lines) + "\n")


if __name__ == "__main__":
    main()
