"""The one family of errors: each message is a sentence that a person can act on."""

import difflib
import math
import re
import reprlib
from collections.abc import Iterable
from typing import Any

__all__ = ["ConformanceError", "GeomsimError", "PlanError", "enter", "nearest", "shortened", "shown"]


class GeomsimError(Exception):
    """Base of every error that bad input can raise; the command line prints its sentence and exits with code 2."""


class PlanError(GeomsimError):
    """A floor plan that cannot be read or used; the message names the file and the place in it."""


class ConformanceError(GeomsimError):
    """A planner, heuristic, evader model or reader that breaks a rule; the message says which one, and where."""


class _Short(reprlib.Repr):
    """Bounded in depth and length, so that no value that a file can hold makes a sentence long."""

    def repr_int(self, x: int, level: int) -> str:  # noqa: ARG002 the signature is given
        """Write out numbers of up to 20 digits; Python refuses to do it for one of thousands."""
        digits = int(abs(x).bit_length() * math.log10(2)) + 1
        return repr(x) if digits <= 20 else f"a whole number of about {digits} digits"


_SHORT = _Short()
_SHORT.maxlevel, _SHORT.maxstring, _SHORT.maxother = 2, 80, 80


def shown(value: object) -> str:
    """Write a value that was received into an error sentence: in full if it is short, else the beginning of it."""
    return _SHORT.repr(value)


def shortened(name: str, most: int = 200) -> str:
    """Cut off the end of a name that would fill the screen."""
    return name if len(name) <= most else f"{name[:most]}..."


def nearest(name: str, valid: Iterable[str]) -> str:
    """Return the end of an error sentence that offers the nearest valid name, or all of them.

    Parameters
    ----------
    name : str
        What was given.
    valid : iterable of str
        What would have been accepted.
    """
    names = list(valid)
    close = difflib.get_close_matches(name[:80].lower(), [n.lower() for n in names], n=1, cutoff=0.5)
    if close:
        match = next(n for n in names if n.lower() == close[0])
        return f"did you mean {match!r}?"
    return "choose one of " + ", ".join(repr(n) for n in names) + "."


def enter(table: dict[str, Any], what: str, name: str, thing: Any) -> None:
    """Enter what a user made into a table of names; GeomsimError if the name is none or is taken."""
    if not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z][a-z0-9]*)*", name):
        raise GeomsimError(f"A {what} cannot be called {name!r}: small letters and digits, with dashes between words.")
    if name in table:
        raise GeomsimError(f"There is a {what} {name!r} already; choose another name.")
    table[name] = thing
