"""The scenario: everything that a run depends on, as a TOML file, as flags, and as it is given back."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from discretize import DEFAULT_METHOD, CellMap, convex_cells, read_cells
from geomsim.communication import LINKS, Communication
from geomsim.evaders import EVADERS, make_evader_model
from geomsim.pursuit import CAPTURE_RULES, Timing
from geomsim.sensing import Sensor
from geomsim.team import BELIEFS, BELIEVED_CAPTURES, Evader, Team
from maps import FloorPlan, GeomsimError, bundled_names, nearest, read_plan
from maps.texts import read_text
from planners import (
    CHECKPOINTS,
    PLANNERS,
    AreaSpeedDegree,
    DwellTime,
    MotionModel,
    Planner,
    StationaryMotion,
    UniformMotion,
    make_planner,
)

__all__ = ["Scenario", "ScenarioError", "describe", "read_scenario"]


class ScenarioError(GeomsimError):
    """A scenario that cannot be read or used; the message names the file and the key."""


#: what a team may believe of the evader's motion, by name
MOTIONS: dict[str, Callable[[float], MotionModel]] = {
    "area-speed-degree": AreaSpeedDegree,
    "dwell-time": DwellTime,
    "uniform": lambda _: UniformMotion(),
    "stationary": lambda _: StationaryMotion(),
}

_Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
_Reach = Annotated[float, Field(gt=0)]
_Degrees = Annotated[float, Field(gt=0, le=360)]
_Share = Annotated[float, Field(gt=0, le=1)]


class Scenario(BaseModel):
    """Everything that a run depends on. Each key is also a flag of the command line, with dashes.

    Lengths in metres, times in seconds, cell numbers as in the pictures, from 1. Where a robot's quantity is a list, it
    has one value for each robot.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    plan: str = "office"
    resolution: _Positive | None = None
    level: str | None = None
    units: str | None = None
    structure: bool | None = None
    seed: Annotated[int, Field(ge=0)] = 0
    pursuers: Annotated[int, Field(ge=1, le=1000)] = 2
    start: tuple[int, ...] = ()
    planner: str = "decoupled"
    cost: str | None = None
    depth: Annotated[int, Field(ge=1)] | None = None
    options: dict[str, bool | int | float | str] = {}
    checkpoints: str = "centroids"
    communication: str = "central"
    communication_range: _Positive | None = None
    capture: str = "sight"
    belief: str = "cells"
    belief_capture: str = "cell"
    range: _Reach | tuple[_Reach, ...] = math.inf
    fov_degrees: _Degrees | tuple[_Degrees, ...] = 360.0
    detection: _Share | tuple[_Share, ...] = 1.0
    speed: _Positive | tuple[_Positive, ...] = 1.0
    range_noise: _Positive | None = None
    radius: _Positive = 0.2
    evaders: Annotated[int, Field(ge=1, le=100)] = 1
    evader: str = "centroid-boundary"
    evader_start: int | None = None
    evader_speed: _Positive = 1.0
    evader_radius: _Positive = 0.2
    motion: str = "area-speed-degree"
    motion_speed: _Positive | None = None
    method: str = DEFAULT_METHOD
    cells: str | None = None
    clearance: _Positive | None = None
    time_limit: _Positive = 1800.0
    belief_step: _Positive = 1.0
    physics_step: _Positive = 0.1

    @field_validator("start", mode="before")
    @classmethod
    def _listed(cls, value: object) -> object:
        if isinstance(value, int) and not isinstance(value, bool):
            return (value,)
        return tuple(value) if isinstance(value, list) else value

    @field_validator("range", "fov_degrees", "detection", "speed", mode="before")
    @classmethod
    def _for_all_or_each(cls, value: object, info: Any) -> object:
        if isinstance(value, list | tuple):
            return tuple(cls._for_all_or_each(one, info) for one in value)
        return math.inf if value is None and info.field_name == "range" else value

    @field_validator("capture", "belief", "belief_capture", "evader", "motion", "checkpoints", "communication")
    @classmethod
    def _known(cls, value: str, info: Any) -> str:
        known: dict[str, Iterable[str]] = {
            "capture": CAPTURE_RULES,
            "belief": BELIEFS,
            "belief_capture": BELIEVED_CAPTURES,
            "evader": EVADERS,
            "motion": MOTIONS,
            "checkpoints": CHECKPOINTS,
            "communication": LINKS,
        }
        valid = tuple(known[info.field_name])
        if value not in valid:
            raise ValueError(f"is not {value!r}: {nearest(value, valid)}")
        return value

    def team(self) -> Team:
        """Make the team of pursuers."""
        return Team(
            pursuers=self.pursuers,
            planner=self.method_of_planning(),
            start=self.start,
            speed=self.speed,
            radius=self.radius,
            sensor=self._sensors(),
            communication=Communication(self.communication, self.communication_range or math.inf),
            checkpoints=self.checkpoints,
            believes=self.belief_capture if self.belief == "cells" else self.belief,
            range_noise=self.range_noise,
        )

    def _sensors(self) -> Sensor | tuple[Sensor, ...]:
        kinds = (self.range, self.fov_degrees, self.detection)
        for name, values in zip(("range", "fov_degrees", "detection"), kinds, strict=True):
            if isinstance(values, tuple) and len(values) != self.pursuers:
                raise ScenarioError(
                    f"{name} has {len(values)} values for {self.pursuers} pursuers: give one, or one each."
                )
        each = [values if isinstance(values, tuple) else (values,) * self.pursuers for values in kinds]
        sensors = tuple(Sensor(reach, math.radians(field), share) for reach, field, share in zip(*each, strict=True))
        return sensors if any(isinstance(values, tuple) for values in kinds) else sensors[0]

    def method_of_planning(self) -> Planner:
        """Make the planner, with its parameters."""
        clash = next((key for key in ("cost", "depth") if key in self.options), None)
        if clash is not None:
            raise ScenarioError(f"{clash} is a key of its own, not one of the planner's options.")
        return make_planner(self.planner, cost=self.cost, depth=self.depth, **self.options)

    def quarry(self) -> Evader:
        """Make the evader."""
        return Evader(
            model=make_evader_model(self.evader),
            start=self.evader_start,
            speed=self.evader_speed,
            radius=self.evader_radius,
            count=self.evaders,
        )

    def belief_motion(self) -> MotionModel:
        """Make the motion model that the pursuers believe in."""
        return MOTIONS[self.motion](self.motion_speed or self.evader_speed)

    def timing(self) -> Timing:
        """Make the clocks."""
        return Timing(self.time_limit, self.belief_step, self.physics_step)

    def place(self) -> tuple[FloorPlan, CellMap]:
        """Read the plan, and cut it or read its cells."""
        plan = read_plan(
            self.plan, resolution=self.resolution, level=self.level, units=self.units, structure=self.structure
        )
        radius = self.clearance or max(self.radius, self.evader_radius)
        if self.cells is not None:
            return plan, read_cells(Path(self.cells), plan, radius=radius)
        return plan, convex_cells(plan, method=self.method, radius=radius)

    def as_dict(self) -> dict[str, Any]:
        """Return what a scenario file would hold: plain values, a planner's defaults told, no keys that mean "none"."""
        told = self.model_dump(mode="python") | _planner_keys(self.method_of_planning())
        return _told(told)

    def as_toml(self) -> str:
        """Return the text of a scenario file that repeats the run."""
        import tomli_w

        return tomli_w.dumps(self.as_dict())


def read_scenario(path: Path | None, flags: dict[str, Any]) -> Scenario:
    """Read a scenario file and let flags override its keys.

    Parameters
    ----------
    path : Path or None
        A TOML file; None for the defaults. A relative plan file in it is looked for beside it first. The scenario
        returned has a plan file's whole path, so that what is written of it holds in any folder.
    flags : dict
        Keys and values that were given on the command line.

    Raises
    ------
    ScenarioError
        If the file cannot be read, or a key or value is wrong; the message names it and the nearest valid one.
    """
    told = {} if path is None else _load(path)
    for key in ("plan", "cells"):
        if path is not None and key in told and key not in flags:
            beside = path.parent / str(told[key])
            if beside.is_file():
                told[key] = str(beside)
    for key in told:
        if key not in Scenario.model_fields:
            raise ScenarioError(f"{path}: unknown key {key!r}; {nearest(key, Scenario.model_fields)}")
    try:
        scenario = Scenario.model_validate(told | flags)
    except ValidationError as exc:
        raise ScenarioError(_sentence(exc, path, flags)) from exc
    if scenario.plan.endswith(".toml"):
        raise ScenarioError(f"{scenario.plan} is a scenario, not a floor plan: give it with --scenario.")
    named = bundled_names()
    told_files = {"plan": scenario.plan, "cells": scenario.cells}
    files = {key: Path(told) for key, told in told_files.items() if told is not None and told not in named}
    return scenario.model_copy(update={key: str(file.resolve()) for key, file in files.items() if file.is_file()})


def _load(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(read_text(path, str(path), ScenarioError))
    except (ValueError, RecursionError) as exc:  # wrong syntax, no text, a number of thousands of digits, or too deep
        raise ScenarioError(f"{path} is not valid TOML: {exc}.") from exc


def _sentence(exc: ValidationError, path: Path | None, flags: dict[str, Any]) -> str:
    error = max(exc.errors(), key=lambda one: isinstance(one["input"], int | float))  # the value, not its whole list
    key = str(error["loc"][0])
    where = f"--{key.replace('_', '-')}" if key in flags or path is None else f"{path}: {key}"
    if error["type"] == "value_error":
        return f"{where} {error['ctx']['error']}"
    reason = error["msg"].removeprefix("Input ")
    return f"{where} {reason}, but is {error['input']!r}."


def describe(
    plan: FloorPlan,
    cells: CellMap,
    team: Team,
    evader: Evader,
    seed: int,
    capture: str,
    motion: MotionModel | None,
    timing: Timing,
) -> dict[str, Any]:
    """Tell a run made from Python in the keys of a scenario file.

    What is registered under a name is told by it; a user's own class by the class's name.
    """
    kinds: dict[type, str] = {kind: name for name, kind in EVADERS.items()}
    motions = {type(make(1.0)): name for name, make in MOTIONS.items()}
    told: dict[str, Any] = {
        "plan": plan.name if plan.source == "bundled" else plan.source or plan.name,
        "seed": seed,
        "pursuers": team.pursuers,
        "start": list(team.start),
        **_planner_keys(team.planner),
        "checkpoints": team.checkpoints,
        "communication": team.communication.links,
        "communication_range": team.communication.range,
        "capture": capture,
        "belief": team.belief,
        "belief_capture": team.believes if team.belief == "cells" else "cell",
        "range": _each([sensor.range for sensor in team.sensors]),
        "fov_degrees": _each([math.degrees(sensor.field_of_view) for sensor in team.sensors]),
        "detection": _each([sensor.detection for sensor in team.sensors]),
        "speed": _each(team.speeds),
        "range_noise": team.range_noise,
        "radius": team.radius,
        "evaders": evader.count,
        "evader": kinds.get(type(evader.model), type(evader.model).__name__),
        "evader_start": evader.start,
        "evader_speed": evader.speed,
        "evader_radius": evader.radius,
        "motion": "area-speed-degree" if motion is None else motions.get(type(motion), type(motion).__name__),
        "motion_speed": None if (believed := getattr(motion, "speed", None)) == evader.speed else believed,
        "method": cells.method,
        "clearance": None if cells.radius == max(team.radius, evader.radius) else cells.radius,
        "time_limit": timing.limit,
        "belief_step": timing.belief_step,
        "physics_step": timing.physics_step,
    }
    return _told(told)


def _planner_keys(planner: Planner) -> dict[str, Any]:
    """Tell a planner by its registered name, a user's own by its class's, and its parameters."""
    names = {entry.make: name for name, entry in PLANNERS.items()}
    told = {key: getattr(planner, key) for key in getattr(planner, "__dataclass_fields__", ())}
    own = {key: told.pop(key) for key in ("cost", "depth") if key in told}
    return {"planner": names.get(type(planner), type(planner).__name__), **own, "options": _told(told)}


def _each(values: Sequence[float]) -> float | list[float]:
    """Return one value if it is the same for all robots, else all."""
    return values[0] if len(set(values)) == 1 else list(values)


def _told(keys: dict[str, Any]) -> dict[str, Any]:
    plain = {key: list(value) if isinstance(value, tuple) else value for key, value in keys.items()}
    return {key: value for key, value in plain.items() if value not in (None, math.inf, [], {})}
