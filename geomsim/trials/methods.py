"""Methods by names that say what they are: ``stationary``, ``decoupled-entropy-5``."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import MISSING, dataclass, fields
from typing import Any

from maps import GeomsimError, nearest
from planners import COSTS, PLANNERS, Planner, PlannerEntry, make_planner

__all__ = ["Method", "default_methods", "make_methods", "parse_method"]


@dataclass(frozen=True, slots=True)
class Method:
    """A planner under its name.

    Attributes
    ----------
    name : str
        What tables call it.
    planner : Planner
        How the team coordinates.
    belief : {"cells", "places"}
        What it plans on.
    """

    name: str
    planner: Planner
    belief: str = "cells"


def parse_method(name: str) -> Method:
    """Make a method from its name: a planner, then its cost heuristic, then how far it looks ahead.

    What is left out has the planner's default, and is added to the name: ``decoupled`` is ``decoupled-entropy-5``. A
    last part ``-places`` lets it plan on a belief over places instead of cells.

    Raises
    ------
    GeomsimError
        If there is no such planner or heuristic, or the planner does not take one.
    """
    if name.endswith(_ON_PLACES):
        rest = name.removesuffix(_ON_PLACES)
        made = parse_method(rest + _FURTHER.get(rest, ""))
        return Method(made.name + _ON_PLACES, made.planner, "places")
    known = [p for p in PLANNERS if name == p or name.startswith(f"{p}-")]
    if not known:
        raise GeomsimError(f"There is no method {name!r}; {nearest(name.rstrip('0123456789-'), PLANNERS)}")
    entry = PLANNERS[max(known, key=len)]
    rest = name[len(entry.name) + 1 :]
    told: dict[str, Any] = {}
    number = _number(entry)
    digits = re.search(r"(?:^|-)(\d+)$", rest)
    if digits is not None:
        if number is None:
            raise GeomsimError(f"The method {name!r} ends in a number, but the planner {entry.name!r} takes none.")
        told[number] = int(digits[1])
        rest = rest[: digits.start()]
    if rest:
        if "cost" not in entry.parameters or rest not in COSTS:
            what = nearest(rest, COSTS) if "cost" in entry.parameters else f"the planner {entry.name!r} takes no cost."
            raise GeomsimError(f"There is no method {name!r}: {rest!r} is no cost heuristic; {what}")
        told["cost"] = rest
    planner = make_planner(entry.name, **told)
    parts = [entry.name, *(getattr(planner, key) for key in ("cost", number) if key in entry.parameters)]
    return Method("-".join(str(part) for part in parts), planner)


def make_methods(methods: Iterable[str] | Mapping[str, Planner]) -> tuple[Method, ...]:
    """Make methods from names, or from a user's own planners by the names that they shall have.

    Raises
    ------
    GeomsimError
        If there is none, one is named twice, or a name is not known.
    """
    if isinstance(methods, Mapping):
        made = tuple(Method(name, planner) for name, planner in methods.items())
    else:
        names = [methods] if isinstance(methods, str) else list(methods)
        made = tuple(parse_method(name) for name in names)
        for k, method in enumerate(made):
            if method.name in [m.name for m in made[:k]]:
                raise GeomsimError(f"The method {method.name!r} is named twice.")
    if not made:
        raise GeomsimError("There is no method to be tried; name one, such as 'decoupled-entropy-5'.")
    return made


def default_methods() -> tuple[str, ...]:
    """Return the methods of the paper's Fig. 5, as far as there are planners for them, and the planners since."""
    names = ["stationary", "random"]
    for planner, depth in (("coupled", 1), ("decoupled", 1), ("decoupled", 5)):
        if planner in PLANNERS:
            names += [f"{planner}-{cost}-{depth}" for cost in _FIGURE_5]
    later = [p for p in PLANNERS if p not in ("stationary", "random", "coupled", "decoupled")]
    return (*names, *(parse_method(p + _FURTHER.get(p, "")).name for p in later))


_ON_PLACES = "-places"

#: planners over a fixed time whose own horizon is made for graphs with hops of one step: here it is in seconds, and a
#: hop takes five to thirty
_FURTHER = {"sequential": "-60", "best-response": "-60", "branch-and-bound": "-30"}

_FIGURE_5 = ("distance-over-probability", "probability", "target-probability", "entropy")


def _number(entry: PlannerEntry) -> str | None:
    """Return the planner's parameter that is a whole number, the depth before others."""
    whole = [
        f.name
        for f in fields(entry.make)  # type: ignore[arg-type]  # every planner is a dataclass
        if f.default is not MISSING and isinstance(f.default, int) and not isinstance(f.default, bool)
    ]
    return "depth" if "depth" in whole else next(iter(whole), None)
