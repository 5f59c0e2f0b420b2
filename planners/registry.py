"""Planners by name: which there are, what each takes, and where it comes from."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, is_dataclass
from types import MappingProxyType
from typing import Any

from maps import nearest
from maps.errors import enter
from planners.baselines import Random, Stationary
from planners.beam import Beam
from planners.costs import find_cost
from planners.coupled import Coupled
from planners.horizon import BestResponse, BranchAndBound, Sequential
from planners.lookahead import Decoupled
from planners.policy import Planner
from planners.refining import Refined
from planners.rollout import Rollout
from planners.team import PlannerError

__all__ = ["PLANNERS", "PlannerEntry", "make_planner", "parse_method", "register_planner"]


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
        """Names of what it takes, such as ``cost`` and ``depth``."""
        return tuple(f.name for f in fields(self.make))  # type: ignore[arg-type]  # every planner is a dataclass


def _table(*entries: PlannerEntry) -> dict[str, PlannerEntry]:
    return {entry.name: entry for entry in entries}


_PLANNERS = _table(
    PlannerEntry(
        "decoupled",
        Decoupled,
        "each robot searches all its paths to a depth while the others stand still",
        "the paper, Algorithm 1 and Section IV-E",
    ),
    PlannerEntry(
        "coupled",
        Coupled,
        "the team searches all its joint paths to a depth",
        "the paper, Algorithm 1 and Section IV-D",
    ),
    PlannerEntry(
        "rollout",
        Rollout,
        "runs several planners to the end in the cell model and follows the best, never worse than any of them",
        "Bertsekas, Castanon: Rollout algorithms for stochastic scheduling problems, 1999",
    ),
    PlannerEntry(
        "beam",
        Beam,
        "the team plans jointly for a long time ahead, by beam search on its expected time to capture",
        "after the paper; judged against sequential allocation and branch and bound in the benchmark",
    ),
    PlannerEntry(
        "refined",
        Refined,
        "beam search, then each robot's path improved window by window, the rest kept; slow, for the best plans",
        "local search over whole plans; each window by branch and bound",
    ),
    PlannerEntry(
        "sequential",
        Sequential,
        "one robot after another takes its best path over a fixed time",
        "Hollinger, Singh, Djugash, Kehagias: Efficient multi-robot search for a moving target, 2009",
    ),
    PlannerEntry(
        "best-response",
        BestResponse,
        "sequential allocation, then each robot answers the others' paths until nobody can improve",
        "coordinate ascent on the same aim",
    ),
    PlannerEntry(
        "branch-and-bound",
        BranchAndBound,
        "the best joint plan over a fixed time, with a proof or a proven gap",
        "after the MEAN bound of the optimal searcher path problem: Martins 1993; Lau, Huang, Dissanayake 2008",
    ),
    PlannerEntry("random", Random, "each robot goes to a random neighbouring cell", "the paper, Section V-A"),
    PlannerEntry("stationary", Stationary, "each robot stays in its starting cell", "the paper, Section V-A"),
)
PLANNERS: Mapping[str, PlannerEntry] = MappingProxyType(_PLANNERS)
"""Every planner by its name."""


def register_planner(
    name: str, *, summary: str = "", source: str = "our own"
) -> Callable[[Callable[..., Planner]], Callable[..., Planner]]:
    """Give a planner of one's own a name, under which the command line finds it; a decorator of a dataclass.

    Parameters
    ----------
    name : str
        Its name; ``name-cost-depth`` then names it with a heuristic and a depth, if those are among its fields.
    summary, source : str
        What ``geomsim planners`` tells of it.

    Raises
    ------
    GeomsimError
        If the name is none, or there is another one of it.
    PlannerError
        If the planner is no dataclass, whose fields are its parameters.
    """

    def register(make: Callable[..., Planner]) -> Callable[..., Planner]:
        if not _has_fields(make):
            raise PlannerError(f"The planner {name!r} must be a dataclass, whose fields are its parameters.")
        enter(_PLANNERS, "planner", name, PlannerEntry(name, make, summary or _first_line(make), source))
        return make

    return register


def _has_fields(thing: object) -> bool:
    return isinstance(thing, type) and is_dataclass(thing)


def _first_line(thing: object) -> str:
    return (thing.__doc__ or "").strip().partition("\n")[0]


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
            *others, last = entry.parameters or ("no parameter",)
            takes = f"{', '.join(others)} and {last}" if others else last
            raise PlannerError(f"The planner {name!r} takes {takes}; got {key} = {value!r}.")
    return entry.make(**given)


def parse_method(method: str) -> Planner:
    """Make a planner from one name that says all: ``planner``, ``planner-cost`` or ``planner-cost-depth``.

    Such as ``stationary``, ``decoupled-entropy-5`` or ``coupled-distance-over-probability-1``; what is left out is
    the planner's own default.

    Raises
    ------
    PlannerError
        If it begins with no planner's name, or the planner takes no cost or depth, or not this depth.
    CostError
        If it names no cost heuristic.
    """
    names = [name for name in PLANNERS if method == name or method.startswith(name + "-")]
    if not names:
        raise PlannerError(f"There is no method {method!r}; {nearest(method, PLANNERS)}")
    name = max(names, key=len)
    cost, depth = method[len(name) + 1 :], None
    head, _, tail = cost.rpartition("-")
    if tail.isdecimal():
        cost, depth = head, int(tail)
    if cost and "cost" in PLANNERS[name].parameters:
        find_cost(cost)
    return make_planner(name, cost=cost or None, depth=depth)
