"""``geomsim run``: one pursuit, from a floor plan to a capture and its video."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from geomsim.cli.console import complain, progress, say, say_json
from geomsim.cli.drawing import DrawFlags
from geomsim.cli.flags import JsonFlag, OutFlag, ScenarioFlags

if TYPE_CHECKING:
    from geomsim.episode import Capture, Episode

__all__ = ["run"]


def run(
    plan: str | None = None,
    *,
    scenario: Annotated[Path | None, Parameter(help="A scenario file (TOML); flags override its keys.")] = None,
    out: OutFlag = None,
    json: JsonFlag = False,
    drawing: DrawFlags = DrawFlags(),  # noqa: B008 a frozen value without fields set
    flags: ScenarioFlags = ScenarioFlags(),  # noqa: B008 a frozen value without fields set
) -> int:
    """Run one pursuit; write its record, video, snapshots and replay.

    Parameters
    ----------
    plan
        A bundled plan or a file, a GeoJSON or a ROS map for instance; `geomsim maps` lists what there is.
    """
    from geomsim.episode import Status
    from geomsim.files import default_folder, results_folder, write_text
    from geomsim.pursuit import run_episode
    from geomsim.scenario import read_scenario
    from geomsim.team import place_team

    drawing.check()
    told = read_scenario(scenario, flags.given() | ({} if plan is None else {"plan": plan}))
    team, quarry, timing, motion = told.team(), told.quarry(), told.timing(), told.belief_motion()
    drawing.check_beliefs(0 if team.communication.central else team.pursuers)
    place, cells = told.place()
    told = told.model_copy(update={"start": tuple(cell + 1 for cell in place_team(cells, team))})
    with results_folder(out or default_folder(place.name, str(told.seed))) as folder:
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
        drawing.clear(folder)
        interrupted = False
        try:
            record = episode.save(folder / "episode.npz")
        except KeyboardInterrupt:
            # the pursuit is finished, so it is kept; whoever presses Ctrl-C once more means it
            interrupted = True
            record = episode.save(folder / "episode.npz")
        files = {"scenario": write_text(folder / "scenario.toml", told.as_toml()), "record": record}
    if episode.outcome.status is Status.INTERRUPTED:
        _report(episode, files, json=json)
        complain(f"Interrupted after {episode.outcome.time:.1f} s of the pursuit; what there is of it is in {folder}.")
        return 130
    try:
        if interrupted:
            raise KeyboardInterrupt
        drawing.draw(episode, folder, files)
    except KeyboardInterrupt:
        _report(episode, files, json=json)
        complain(f"Interrupted while drawing; what was finished is in {folder}.")
        return 130
    _report(episode, files, json=json)
    return 0


def _count(pursuers: int) -> str:
    return "1 pursuer" if pursuers == 1 else f"{pursuers} pursuers"


def _unreached(episode: Episode) -> list[str]:
    """Say how much of the building the robots, and so the evader, cannot get to."""
    parts = episode.cells.components
    apart = int((parts != parts[episode.pursuer_cells[0, 0]]).sum())
    if not apart:
        return []
    radius = episode.cells.radius
    return [f"{apart} of {len(parts)} cells cannot be reached from the start by a body of radius {radius:g} m."]


def _told(capture: Capture) -> dict[str, Any]:
    return {
        "evader": capture.evader + 1,
        "time": capture.time,
        "captured_by": capture.pursuer + 1,
        "cell": capture.cell + 1,
        "position": capture.position,
    }


def _report(episode: Episode, files: dict[str, Path], *, json: bool) -> None:
    out = episode.outcome
    notes = [*episode.cells.notes, *_unreached(episode), *out.notes]
    if json:
        say_json(
            {
                "captured": out.captured,
                "status": out.status.name.lower(),
                "capture_time": out.time if out.captured else None,
                "captured_by": None if out.pursuer is None else out.pursuer + 1,
                "capture_position": out.position,
                "capture_cell": None if out.cell is None else out.cell + 1,
                "captures": [_told(capture) for capture in out.captures],
                "predicted_capture_probability": out.predicted,
                "cells": len(episode.cells),
                "seed": episode.scenario["seed"],
                "scenario": episode.scenario,
                "notes": [*(repair.message for repair in episode.plan.repairs), *notes],
                "files": {kind: str(path) for kind, path in files.items()},
            }
        )
        return
    told = episode.scenario
    say(f"{episode.plan.name}: {len(episode.cells)} cells, {_count(told['pursuers'])}, seed {told['seed']}")
    several = episode.evaders.shape[1] > 1
    where = "" if several or out.position is None else f", at ({out.position[0]:.1f}, {out.position[1]:.1f}) m"
    say(f"{episode}{where}")
    for capture in out.captures if several else ():
        say(
            f"evader {capture.evader + 1}: after {capture.time:.1f} s by pursuer {capture.pursuer + 1}, "
            f"in cell {capture.cell + 1}, at ({capture.position[0]:.1f}, {capture.position[1]:.1f}) m"
        )
    say(f"chance of capture by then that the belief predicted: {out.predicted:.2f}")
    for note in notes:
        say(note)
    for kind, path in files.items():
        say(f"{kind + ':':<10} {path}")
