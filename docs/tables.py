"""Make the measured table of ``docs/choosing.md`` anew: ``python docs/tables.py``, some minutes."""

import argparse
import re
from pathlib import Path

import geomsim as gs

PAGE = Path(__file__).parent / "choosing.md"
BEGIN, END = "<!-- table: python docs/tables.py -->", "<!-- end of table -->"

METHODS = (
    "stationary",
    "random",
    "decoupled-distance-over-probability-1",
    "decoupled-probability-5",
    "decoupled-entropy-1",
    "decoupled-entropy-5",
    "decoupled-target-probability-5",
    "coupled-entropy-2",
    "sequential",
    "best-response",
    "beam",
)


def table(plan: str, trials: int) -> str:
    """Run every method and return a table in Markdown, the soonest first."""
    place = gs.load_plan(plan)
    cells = gs.convex_cells(place)
    timing = gs.Timing(limit=3600.0)
    result = gs.run_trials(place, METHODS, trials=trials, cells=cells, capture="sight", timing=timing, workers=1)
    told = result.summary().methods
    lines = [
        f"Plan {place.name}, {len(cells)} cells, 2 robots, capture by sight, {trials} evaders, the same for all.",
        "",
        "| method | mean time to capture (s) | standard error | captured within an hour |",
        "|---|---:|---:|---:|",
    ]
    for method in sorted(told, key=lambda m: m.observed.mean):
        seen = method.observed
        error = "" if seen.sem is None else f"{seen.sem:.1f}"
        lines.append(f"| `{method.name}` | {seen.mean:.1f} | {error} | {100 * seen.captured_share:.0f} % |")
    return "\n".join(lines)


def main() -> None:
    """Write the table into the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plan", default="office")
    parser.add_argument("--trials", type=int, default=200)
    told = parser.parse_args()
    text = PAGE.read_text(encoding="utf-8")
    made = f"{BEGIN}\n\n{table(told.plan, told.trials)}\n\n{END}"
    PAGE.write_text(re.sub(f"{re.escape(BEGIN)}.*?{re.escape(END)}", made, text, flags=re.DOTALL), encoding="utf-8")


if __name__ == "__main__":
    main()
