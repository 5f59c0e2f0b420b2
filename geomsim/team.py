"""Who takes part in a pursuit: the team of pursuers and the evaders."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from discretize import CellMap
from geomsim.communication import Communication
from geomsim.evaders import CentroidBoundary, EvaderModel
from geomsim.sensing import Sensor
from maps import GeomsimError, nearest
from planners import CHECKPOINTS, Decoupled, Planner

__all__ = ["BELIEFS", "BELIEVED_CAPTURES", "Evader", "Team", "place_evader", "place_team"]

BELIEVED_CAPTURES = {
    "cell": "a pursuer catches whoever is in its own cell (the paper's assumption)",
    "sight": "a pursuer catches whoever it sees, within its range and field of view",
}

BELIEFS = {
    "cells": "in which cell the evader is (the paper's belief)",
    "places": "in which place on the routes between checkpoints it is, and which way it goes; caught is who is seen",
    "particles": "a hundred thousand of them, for predictions by sight only",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Team:
    """A team of pursuers.

    Attributes
    ----------
    pursuers : int
        How many.
    planner : Planner
        How they coordinate.
    start : tuple of int
        Numbers of the cells in which they start, from 1; one number is for all of them, none leaves the choice to the
        plan (its own start cells, taken in turn; without any, all start in the cell of lowest number in the largest
        connected part).
    speed : float or tuple of float
        Of all of them, or of each; metres a second.
    radius : float
        Of a body, metres.
    sensor : Sensor or tuple of Sensor
        What all of them see, or each of them.
    communication : Communication
        Whether one planner plans for all, or each for itself, and who hears whom.
    checkpoints : {"centroids", "boundaries"}
        Where they decide anew: at the centroids of cells, or also where they pass from cell to cell.
    believes : {"cell", "sight", "places", "particles"}
        What they count on to catch, see ``BELIEVED_CAPTURES``; or that they believe in places or particles, see
        ``BELIEFS``.
    range_noise : float or None
        Standard deviation of the distance to each evader that every robot measures at each belief step, also through
        walls, metres; None if they measure none.

    Raises
    ------
    GeomsimError
        If a value is impossible, or there are several speeds or sensors, but not one for each.
    """

    pursuers: int = 2
    planner: Planner = field(default_factory=Decoupled)
    start: tuple[int, ...] = ()
    speed: float | tuple[float, ...] = 1.0
    radius: float = 0.2
    sensor: Sensor | tuple[Sensor, ...] = field(default_factory=Sensor)
    communication: Communication = field(default_factory=Communication)
    checkpoints: str = "centroids"
    believes: str = "cell"
    range_noise: float | None = None

    def __post_init__(self) -> None:
        if self.pursuers < 1:
            raise GeomsimError(f"A team needs at least one pursuer, but {self.pursuers} were asked for.")
        for what, given in (("speeds", self.speeds), ("sensors", self.sensors)):
            if len(given) != self.pursuers:
                raise GeomsimError(
                    f"{len(given)} {what} are given for {self.pursuers} pursuers: give one, or one each."
                )
        for speed in self.speeds:
            _check_body("pursuer", speed, self.radius)
        if self.range_noise is not None and not 0 < self.range_noise < float("inf"):
            raise GeomsimError(f"The noise of ranges must be positive and finite, but is {self.range_noise:g} m.")
        for what, name, known in (
            ("kind of checkpoints", self.checkpoints, CHECKPOINTS),
            ("believed capture", self.believes, (*BELIEVED_CAPTURES, "places", "particles")),
        ):
            if name not in known:
                raise GeomsimError(f"There is no {what} {name!r}; {nearest(name, known)}")

    @property
    def belief(self) -> str:
        """What they believe in, see ``BELIEFS``."""
        return self.believes if self.believes in BELIEFS else "cells"

    @property
    def speeds(self) -> tuple[float, ...]:
        """Speed of each pursuer, metres a second."""
        return self.speed if isinstance(self.speed, tuple) else (self.speed,) * self.pursuers

    @property
    def sensors(self) -> tuple[Sensor, ...]:
        """What each pursuer sees."""
        return self.sensor if isinstance(self.sensor, tuple) else (self.sensor,) * self.pursuers


@dataclass(frozen=True, slots=True, kw_only=True)
class Evader:
    """The one who is searched for, or several of a kind, who know nothing of each other.

    Attributes
    ----------
    model : EvaderModel
        How each moves.
    start : int or None
        Number of the cell in which each starts, from 1; None for a uniformly random one that the pursuers can reach
        and in which none of them starts.
    speed : float
        Metres a second.
    radius : float
        Of a body, metres.
    count : int
        How many there are.
    """

    model: EvaderModel = field(default_factory=CentroidBoundary)
    start: int | None = None
    speed: float = 1.0
    radius: float = 0.2
    count: int = 1

    def __post_init__(self) -> None:
        _check_body("evader", self.speed, self.radius)
        if self.count < 1:
            raise GeomsimError(f"There must be at least one evader, but {self.count} were asked for.")


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
