"""Planners by name: which there are, what each takes, and where it comes from."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from types import MappingProxyType
from typing import Any

from maps import nearest
from planners.baselines import Random, Stationary
from planners.lookahead import Decoupled, PlannerError
from planners.policy import Planner

__all__ = ["PLANNERS", "PlannerEntry", "make_planner"]


@dataclass(frozen=True, slots=True)
class PlannerEntry:
    """One method of coordination.

    Attributes
    ----------
    name : str
        Its name on the command line.
    make : callable
        Makes a planner from keyword arguments.
    summary : str
        One line about it.
    source : str
        Where it comes from.
    """

    name: str
    make: Callable[..., Planner]
    summary: str
    source: str

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of what it takes besides nothing: none, or some of ``cost`` and ``depth``."""
        return tuple(f.name for f in fields(self.make))  # type: ignore[arg-type]  # every planner is a dataclass


def _table(*entries: PlannerEntry) -> Mapping[str, PlannerEntry]:
    return MappingProxyType({entry.name: entry for entry in entries})


PLANNERS: Mapping[str, PlannerEntry] = _table(
    PlannerEntry(
        "decoupled",
        Decoupled,
        "each robot searches all its paths to a depth while the others stand still",
        "the paper, Algorithm 1 and Section IV-E",
    ),
    PlannerEntry("random", Random, "each robot goes to a random neighbouring cell", "the paper, Section V-A"),
    PlannerEntry("stationary", Stationary, "each robot stays in its starting cell", "the paper, Section V-A"),
)
"""Every planner by its name."""


def make_planner(name: str, **parameters: Any) -> Planner:
    """Make a planner by its name.

    Parameters
    ----------
    name : str
        A name in :data:`PLANNERS`.
    **parameters
        What the planner takes, such as ``cost`` and ``depth``. A parameter that is None counts as not given, and
        the planner's own default holds; so a command line can pass all its flags to any planner.

    Raises
    ------
    PlannerError
        If there is no planner of this name, or it does not take a parameter that was given, or not this value.
    CostError
        If there is no cost heuristic of the given name.
    """
    if name not in PLANNERS:
        raise PlannerError(f"There is no planner {name!r}; {nearest(name, PLANNERS)}")
    entry = PLANNERS[name]
    given = {key: value for key, value in parameters.items() if value is not None}
    for key, value in given.items():
        if key not in entry.parameters:
            takes = " and ".join(entry.parameters) or "no parameter"
            raise PlannerError(f"The planner {name!r} takes {takes}; got {key} = {value!r}.")
    return entry.make(**given)
