"""Who takes part in a pursuit: the team of pursuers and the evader."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from discretize import CellMap
from geomsim.evaders import CentroidBoundary, EvaderModel
from geomsim.sensing import Sensor
from maps import GeomsimError
from planners import Decoupled, Planner

__all__ = ["Evader", "Team", "place_evader", "place_team"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Team:
    """A team of like pursuers.

    Attributes
    ----------
    pursuers : int
        How many.
    planner : Planner
        How they coordinate.
    start : tuple of int
        Numbers of the cells in which they start, from 1; one number is for all of them, none leaves the choice to the
        plan (its own start cells, or the lowest number of the largest connected part).
    speed : float
        Metres a second.
    radius : float
        Of a body, metres.
    sensor : Sensor
        What each of them sees.
    """

    pursuers: int = 2
    planner: Planner = field(default_factory=Decoupled)
    start: tuple[int, ...] = ()
    speed: float = 1.0
    radius: float = 0.2
    sensor: Sensor = field(default_factory=Sensor)

    def __post_init__(self) -> None:
        if self.pursuers < 1:
            raise GeomsimError(f"A team needs at least one pursuer, but {self.pursuers} were asked for.")
        _check_body("pursuer", self.speed, self.radius)


@dataclass(frozen=True, slots=True, kw_only=True)
class Evader:
    """The one who is searched for.

    Attributes
    ----------
    model : EvaderModel
        How it moves.
    start : int or None
        Number of the cell in which it starts, from 1; None for a uniformly random one that the pursuers can reach and
        in which none of them starts.
    speed : float
        Metres a second.
    radius : float
        Of its body, metres.
    """

    model: EvaderModel = field(default_factory=CentroidBoundary)
    start: int | None = None
    speed: float = 1.0
    radius: float = 0.2

    def __post_init__(self) -> None:
        _check_body("evader", self.speed, self.radius)


def _check_body(who: str, speed: float, radius: float) -> None:
    for what, value, unit in (("speed", speed, "m/s"), ("radius", radius, "m")):
        if not 0 < value < float("inf"):
            raise GeomsimError(f"The {what} of the {who} must be positive and finite, but is {value:g} {unit}.")


def place_team(cells: CellMap, team: Team) -> tuple[int, ...]:
    """Return the cell, counted from 0, in which each pursuer starts.

    Raises
    ------
    GeomsimError
        If a start cell does not exist, cannot be entered, or lies apart from the others.
    """
    numbers = team.start or cells.plan.start
    if not numbers:
        reachable = np.flatnonzero(cells.components == 0)
        if not len(reachable):
            raise GeomsimError(f"No body of radius {cells.radius:g} m fits into any cell of {cells.plan.name!r}.")
        numbers = (int(reachable[0]) + 1,)
    if team.start and len(numbers) not in (1, team.pursuers):
        raise GeomsimError(f"{len(numbers)} start cells are given for {team.pursuers} pursuers: give one, or one each.")
    # a plan's own start cells serve a team of any size, taken in turn
    chosen = tuple(_existing(cells, numbers[k % len(numbers)], "start cell") for k in range(team.pursuers))
    apart = next((c for c in chosen if cells.components[c] != cells.components[chosen[0]]), None)
    if apart is not None:
        raise GeomsimError(
            f"Start cell {apart + 1} is in a part of the building that cannot be reached from start cell "
            f"{chosen[0] + 1}, so that the evader could reach only one of them."
        )
    return chosen


def place_evader(cells: CellMap, evader: Evader, pursuers: Sequence[int], rng: np.random.Generator) -> int:
    """Return the cell, counted from 0, in which the evader starts.

    Raises
    ------
    GeomsimError
        If its start cell does not exist or lies apart from the pursuers, or no cell is left for it.
    """
    if evader.start is not None:
        cell = _existing(cells, evader.start, "evader's start cell")
        if cells.components[cell] != cells.components[pursuers[0]]:
            raise GeomsimError(
                f"The evader's start cell {evader.start} is in a part of the building that cannot be reached from the "
                f"pursuers' start cell {pursuers[0] + 1}."
            )
        return cell
    reachable = np.flatnonzero(cells.components == cells.components[pursuers[0]])
    free = reachable[~np.isin(reachable, pursuers)]
    if not len(free):
        raise GeomsimError(
            f"The pursuers start in every cell of {cells.plan.name!r} that they can reach; "
            "no cell is left for the evader."
        )
    return int(rng.choice(free))


def _existing(cells: CellMap, number: int, what: str) -> int:
    if not 1 <= number <= len(cells):
        raise GeomsimError(
            f"There is no {what} {number}: the cells of {cells.plan.name!r} are numbered from 1 to {len(cells)}."
        )
    if cells.components[number - 1] < 0:
        raise GeomsimError(f"No body of radius {cells.radius:g} m fits into {what} {number}.")
    return number - 1
