"""Flags that several commands share, under the same names everywhere."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from maps import GeomsimError

__all__ = ["JsonFlag", "OutFlag", "ScenarioFlags"]

JsonFlag = Annotated[bool, Parameter(name="--json", negative="", help="Print one JSON object and nothing else.")]
OutFlag = Annotated[Path | None, Parameter(name="--out", help="Folder for the files written.")]


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class ScenarioFlags:
    """The keys of a scenario file; a flag overrides the file.

    Attributes
    ----------
    seed
        The same seed gives the same episode, bit for bit.
    pursuers
        Number of robots.
    start
        Numbers of the cells in which they start, as in the picture: one for all, or one each, like 43,44.
    planner
        How they coordinate; `geomsim planners` lists them.
    cost
        Heuristic that the planner minimises: entropy, target-probability, probability, distance-over-probability.
    depth
        Cells that the planner looks ahead.
    capture
        What counts as capture: sight or cell.
    range
        How far a robot sees, metres.
    fov_degrees
        Field of view of a robot, degrees.
    speed
        Speed of the robots, metres a second.
    radius
        Radius of the robots, metres.
    evader
        How the evader moves: centroid-boundary or still.
    evader_start
        Number of the cell in which it starts.
    evader_speed
        Its speed, metres a second.
    evader_radius
        Its radius, metres.
    motion
        How the robots believe it moves: area-speed-degree, uniform or stationary.
    method
        How the plan is cut into cells.
    time_limit
        When to give up, seconds.
    belief_step
        Time between two belief steps, seconds.
    physics_step
        Time between two physics steps, seconds.
    """

    seed: int | None = None
    pursuers: int | None = None
    start: str | None = None
    planner: str | None = None
    cost: str | None = None
    depth: int | None = None
    capture: str | None = None
    range: float | None = None
    fov_degrees: float | None = None
    speed: float | None = None
    radius: float | None = None
    evader: str | None = None
    evader_start: int | None = None
    evader_speed: float | None = None
    evader_radius: float | None = None
    motion: str | None = None
    method: str | None = None
    time_limit: float | None = None
    belief_step: float | None = None
    physics_step: float | None = None

    def given(self) -> dict[str, Any]:
        """Return the keys that were given, with their values as a scenario has them."""
        told = {f.name: getattr(self, f.name) for f in fields(self)}
        if self.start is not None:
            try:
                told["start"] = tuple(int(part) for part in self.start.split(","))
            except ValueError:
                raise GeomsimError(
                    f"--start takes cell numbers with commas between them, not {self.start!r}."
                ) from None
        return {key: value for key, value in told.items() if value is not None}
