"""How fast pictures are drawn and encoded: ``python tests/benchmarks/drawing.py [--write]``.

A pursuit of 60 s by three robots in the bundled office, and in larger buildings, drawn at 1280 x 720. Times are
processor time of the drawing thread, milliseconds, the median of five rounds; `relative` divides by the time that
copying one frame takes in the same run, so that numbers from different machines can be compared. ``--write`` stores
them beside this file.
"""

from __future__ import annotations

import json
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from geomsim.drawing import FrameDrawer, FrameStyle
from geomsim.drawing.moment import Timeline
from geomsim.drawing.sight import Sight
from geomsim.episode import Episode
from geomsim.pursuit import run_episode
from geomsim.replay.page import replay_page
from geomsim.scenario import read_scenario
from geomsim.snapshots import draw_snapshots
from geomsim.video import write_video

STORED = Path(__file__).with_suffix(".json")
ROUNDS = 5

#: other buildings in which frames are drawn; the scan lies beside the checkout or is left out
LARGER = {
    "museum": "museum",
    "a scan with 2,300 walls": str(
        Path(__file__).parents[3] / "shared" / "floorplans" / "ros" / "willow_full_0.05.yaml"
    ),
}


def pursuit(where: str = "office") -> Episode:
    """Return a minute of three robots that see half a metre, so that the evader stays free."""
    told = read_scenario(None, {"plan": where, "pursuers": 3, "range": 0.5, "time_limit": 60.0, "seed": 1})
    plan, cells = told.place()
    return run_episode(
        plan,
        cells,
        told.team(),
        told.quarry(),
        seed=told.seed,
        motion=told.belief_motion(),
        timing=told.timing(),
        scenario={**told.as_dict(), "range": float("inf")},  # drawn with the whole line of sight
    )


def each(act: Callable[[Any], object], things: Iterable[Any]) -> Callable[[], None]:
    """Return an act that does something with each thing and keeps nothing."""

    def run() -> None:
        for thing in things:
            act(thing)

    return run


def milliseconds(act: Callable[[], object], count: int, clock: Callable[[], float] = time.thread_time) -> float:
    """Return the median over the rounds of the time that one of ``count`` parts of an act takes."""
    rounds = []
    for _ in range(ROUNDS):
        begun = clock()
        act()
        rounds.append((clock() - begun) / count * 1000)
    return statistics.median(rounds)


def measure() -> dict[str, dict[str, float]]:
    episode = pursuit()
    times = np.arange(0.0, float(episode.times[-1]), 0.2)
    drawer, bare = FrameDrawer(episode), FrameDrawer(episode, FrameStyle(sight=False))
    timeline, sight = Timeline(episode), Sight(episode)
    moments = [timeline.at(float(t)) for t in times]
    frame = drawer.draw(0.0)
    found = {
        "copying a frame": milliseconds(each(lambda _: frame.copy(), range(200)), 200),
        "a frame": milliseconds(each(drawer.draw, times.tolist()), len(times)),
        "a frame without sight": milliseconds(each(bare.draw, times.tolist()), len(times)),
        "one visibility polygon": milliseconds(each(lambda m: sight.area(m, 0), moments), len(moments)),
        "preparing an episode": milliseconds(lambda: FrameDrawer(episode), 1),
        "a contact sheet": milliseconds(lambda: draw_snapshots(episode), 1),
        "a replay": milliseconds(lambda: replay_page(episode), 1),
    }
    for name, where in LARGER.items():
        if where in ("museum", "school") or Path(where).exists():
            other = FrameDrawer(larger := pursuit(where))
            shown = np.arange(0.0, float(larger.times[-1]), 0.5).tolist()
            found[f"a frame, {name}"] = milliseconds(each(other.draw, shown), len(shown))
    with tempfile.TemporaryDirectory() as folder:
        for suffix, fps in ((".mp4", 25), (".webm", 25), (".gif", 10)):
            path = Path(folder) / f"a{suffix}"
            # Encoders have threads of their own: here the wall clock counts.
            count = round(fps * 12.0)
            made = milliseconds(
                lambda path=path, fps=fps: write_video(episode, path, fps=fps, size=(1280, 720), length=12.0),
                count,
                time.perf_counter,
            )
            found[f"a frame drawn and encoded as {suffix}, wall clock"] = made
    unit = found["copying a frame"]
    return {name: {"ms": round(ms, 3), "relative": round(ms / unit, 1)} for name, ms in found.items()}


def main() -> None:
    found = measure()
    stored = json.loads(STORED.read_text()) if STORED.exists() else {}
    for name, now in found.items():
        before = stored.get(name, {}).get("relative")
        told = "" if before is None else f"   stored {before:8.1f}"
        sys.stdout.write(f"{name:<50} {now['ms']:9.3f} ms   relative {now['relative']:8.1f}{told}\n")
    if "--write" in sys.argv[1:]:
        STORED.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
