"""``geomsim run``: one pursuit, from a floor plan to a capture and its video."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from geomsim.cli.console import complain, progress, say, say_json
from geomsim.cli.flags import JsonFlag, OutFlag, ScenarioFlags

__all__ = ["run"]


def run(
    plan: str | None = None,
    *,
    scenario: Annotated[Path | None, Parameter(help="A scenario file (TOML); flags override its keys.")] = None,
    out: OutFlag = None,
    video: Annotated[bool, Parameter(help="Write a video.")] = True,
    snapshots: Annotated[bool, Parameter(help="Write a contact sheet of snapshots.")] = True,
    frames: Annotated[bool, Parameter(negative="", help="Write every frame of the video as PNG.")] = False,
    json: JsonFlag = False,
    flags: ScenarioFlags = ScenarioFlags(),  # noqa: B008 a frozen value without fields set
) -> int:
    """Run one pursuit and write its record, video and snapshots.

    Parameters
    ----------
    plan
        A bundled plan (`geomsim maps` lists them) or a file: GeoJSON, or the YAML of a ROS map.
    """
    from geomsim.episode import Status
    from geomsim.files import output_folder, write_text
    from geomsim.pursuit import run_episode
    from geomsim.scenario import read_scenario
    from geomsim.team import place_team

    told = read_scenario(scenario, flags.given() | ({} if plan is None else {"plan": plan}))
    team, quarry, timing, motion = told.team(), told.quarry(), told.timing(), told.belief_motion()
    place, cells = told.place()
    told = told.model_copy(update={"start": tuple(cell + 1 for cell in place_team(cells, team))})
    folder = output_folder(out or Path("geomsim-output") / f"{place.name}-{told.seed}")

    with progress("pursuit") as bar:
        episode = run_episode(
            place,
            cells,
            team,
            quarry,
            seed=told.seed,
            capture=told.capture,
            motion=motion,
            timing=timing,
            scenario=told.as_dict(),
            progress=None if bar is None else lambda time, _: bar(time, told.time_limit),
        )
    files = {"scenario": write_text(folder / "scenario.toml", told.as_toml())}
    files["record"] = episode.save(folder / "episode.npz")
    if episode.outcome.status is Status.INTERRUPTED:
        _report(episode, files, json=json)
        complain(f"Interrupted after {episode.outcome.time:.1f} s of the pursuit; what there is of it is in {folder}.")
        return 130
    try:
        if snapshots:
            files["snapshots"] = episode.save_snapshots(folder / "snapshots.png")
        if video:
            with progress("video") as bar:
                files["video"] = episode.save_video(folder / "pursuit.mp4", progress=bar)
        if frames:
            with progress("frames") as bar:
                files["frames"] = episode.save_frames(folder / "frames", progress=bar)
    except KeyboardInterrupt:
        _report(episode, files, json=json)
        complain(f"Interrupted while drawing; what was finished is in {folder}.")
        return 130
    _report(episode, files, json=json)
    return 0


def _report(episode: Any, files: dict[str, Path], *, json: bool) -> None:
    out = episode.outcome
    if json:
        say_json(
            {
                "captured": out.captured,
                "status": out.status.name.lower(),
                "capture_time": out.time if out.captured else None,
                "captured_by": None if out.pursuer is None else out.pursuer + 1,
                "capture_position": out.position,
                "capture_cell": None if out.cell is None else out.cell + 1,
                "predicted_capture_probability": out.predicted,
                "cells": len(episode.cells),
                "seed": episode.scenario["seed"],
                "scenario": episode.scenario,
                "notes": [*(repair.message for repair in episode.plan.repairs), *out.notes],
                "files": {kind: str(path) for kind, path in files.items()},
            }
        )
        return
    told = episode.scenario
    say(f"{episode.plan.name}: {len(episode.cells)} cells, {told['pursuers']} pursuers, seed {told['seed']}")
    where = "" if out.position is None else f", at ({out.position[0]:.1f}, {out.position[1]:.1f}) m"
    say(f"{episode}{where}")
    say(f"chance of capture by then that the belief predicted: {out.predicted:.2f}")
    for note in out.notes:
        say(note)
    for kind, path in files.items():
        say(f"{kind + ':':<10} {path}")
