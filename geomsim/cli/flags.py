"""Flags that several commands share, under the same names everywhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter, Token

from maps import FloorPlan, GeomsimError

__all__ = ["JsonFlag", "OutFlag", "PlanFlags", "ScenarioFlags"]


def _whole(kind: type, tokens: Sequence[Token]) -> int:  # noqa: ARG001 the signature that cyclopts calls
    """Read a whole number; of 1.5, cyclopts itself would drop the half in silence."""
    try:
        return int(tokens[0].value)
    except ValueError:
        raise ValueError(f"{tokens[0].value!r} is no whole number.") from None


WholeNumber = Annotated[int | None, Parameter(converter=_whole)]

JsonFlag = Annotated[bool, Parameter(name="--json", negative="", help="Print one JSON object and nothing else.")]
OutFlag = Annotated[
    Path | None,
    Parameter(
        name="--out",
        help="Folder for the files written; without it a folder in geomsim-output (render: the record's own).",
    ),
]


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class PlanFlags:
    """What a floor plan's file may leave open.

    Attributes
    ----------
    resolution
        Size of a pixel, grid cell or drawing unit in metres, for a plan that does not say it.
    level
        Storey, of a plan that has several. [default: the largest]
    units
        Unit of the coordinates, like mm or ft, for a plan that does not say it.
    structure
        Take the furniture out of a scanned map and keep its walls. [default: if it is plainly a scan]
    """

    resolution: float | None = None
    level: str | None = None
    units: str | None = None
    structure: bool | None = None

    def read(self, plan: str) -> FloorPlan:
        """Read a floor plan with what was given."""
        from maps import read_plan

        return read_plan(plan, resolution=self.resolution, level=self.level, units=self.units, structure=self.structure)


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class ScenarioFlags(PlanFlags):
    """The keys of a scenario file; a flag overrides the file. Defaults are those of :class:`geomsim.scenario.Scenario`.

    Attributes
    ----------
    seed
        The same seed gives the same episode, bit for bit. [default: 0]
    pursuers
        Number of robots. [default: 2]
    start
        Numbers of the cells in which they start, as in the picture: one for all, or one each, like
        43,44. [default: the plan's own]
    planner
        How they coordinate; `geomsim planners` lists them. [default: decoupled]
    cost
        Heuristic that the planner minimises: entropy, target-probability, probability, distance-over-probability.
        [default: entropy]
    depth
        Cells that the planner looks ahead. [default: 5]
    option
        Another parameter of the planner, as NAME=VALUE; may be given several times.
    checkpoints
        Where robots decide anew: centroids, of cells, or boundaries, where they pass from cell to cell as well.
        [default: centroids]
    communication
        Who plans: central, one planner for all; full, every robot for itself, hearing all others; range or sight,
        every robot for itself, hearing those within a range or in sight. [default: central]
    communication_range
        How far robots hear each other, metres. [default: without limit]
    capture
        What counts as capture: sight, a free line of sight to the evader, or cell, being in its cell. [default:
        sight]
    belief
        What the robots believe in: cells, in which of them the evader is, or places, where on the routes between
        checkpoints it is, which is true of what they see; particles for `geomsim predict`. [default: cells]
    belief_capture
        What the belief counts on: cell, catching whoever is in the same cell, or sight, whoever is seen. [default:
        cell]
    range
        How far a robot sees, metres; one for all or one each, like 5,8. [default: without limit]
    fov_degrees
        Field of view of a robot, degrees; one for all or one each. [default: 360]
    detection
        Probability that a robot notices, within a second, an evader that stays in view; one for all or one each.
        [default: 1]
    speed
        Speed of the robots, metres a second; one for all or one each. [default: 1]
    range_noise
        Let every robot measure how far each evader is, every belief step and through walls, with Gaussian noise of
        this standard deviation, metres. [default: they measure nothing]
    radius
        Radius of the robots, metres. [default: 0.2]
    evaders
        How many there are to be found. [default: 1]
    evader
        How the evader moves: centroid-boundary, still, shortest-paths, hiding or fleeing. [default:
        centroid-boundary]
    evader_start
        Number of the cell in which it starts. [default: a random one]
    evader_speed
        Its speed, metres a second. [default: 1]
    evader_radius
        Its radius, metres. [default: 0.2]
    motion
        How the robots believe it moves: area-speed-degree, dwell-time, uniform or stationary. [default:
        area-speed-degree]
    motion_speed
        How fast they believe it to be, metres a second. [default: as fast as it is]
    method
        How the plan is cut into cells. [default: rooms]
    cells
        GeoJSON of cells that `geomsim discretize` wrote and a person may have changed, instead of a method.
    clearance
        Radius of the body for which portals and routes are made, metres. [default: the largest radius]
    time_limit
        When to give up, seconds. [default: 1800]
    belief_step
        Time between two belief steps, seconds. [default: 1]
    physics_step
        Time between two physics steps, seconds. [default: 0.1]
    """

    seed: WholeNumber = None
    pursuers: WholeNumber = None
    start: str | None = None
    planner: str | None = None
    cost: str | None = None
    depth: WholeNumber = None
    option: tuple[str, ...] = ()
    checkpoints: str | None = None
    communication: str | None = None
    communication_range: float | None = None
    capture: str | None = None
    belief: str | None = None
    belief_capture: str | None = None
    range: str | None = None
    fov_degrees: str | None = None
    detection: str | None = None
    speed: str | None = None
    range_noise: float | None = None
    radius: float | None = None
    evaders: WholeNumber = None
    evader: str | None = None
    evader_start: WholeNumber = None
    evader_speed: float | None = None
    evader_radius: float | None = None
    motion: str | None = None
    motion_speed: float | None = None
    method: str | None = None
    cells: str | None = None
    clearance: float | None = None
    time_limit: float | None = None
    belief_step: float | None = None
    physics_step: float | None = None

    def given(self) -> dict[str, Any]:
        """Return the keys that were given, with their values as a scenario has them."""
        told = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "option"}
        if self.start is not None:
            try:
                told["start"] = tuple(int(part) for part in self.start.split(","))
            except ValueError:
                raise GeomsimError(
                    f"--start takes cell numbers with commas between them, not {self.start!r}."
                ) from None
        for name in ("range", "fov_degrees", "detection", "speed"):
            if told[name] is not None:
                told[name] = _numbers(name, told[name])
        if self.option:
            told["options"] = dict(_option(text) for text in self.option)
        return {key: value for key, value in told.items() if value is not None}


def _numbers(name: str, text: str) -> float | tuple[float, ...]:
    """Read one number for all robots, or one for each."""
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        raise GeomsimError(
            f"--{name.replace('_', '-')} takes a number for all robots, or one each with commas between them, "
            f"not {text!r}."
        ) from None
    return numbers[0] if len(numbers) == 1 else numbers


def _option(text: str) -> tuple[str, bool | int | float | str]:
    """Read NAME=VALUE, the value as TOML would where it can."""
    import tomllib

    name, equals, value = text.partition("=")
    if not (name.isidentifier() and equals and value):
        raise GeomsimError(f"--option takes NAME=VALUE, not {text!r}.")
    try:
        read = tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return name, value
    return name, read if isinstance(read, bool | int | float) else value
