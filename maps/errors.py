"""The one family of errors: each message is a sentence that a person can act on."""

import difflib
from collections.abc import Iterable

__all__ = ["GeomsimError", "PlanError", "nearest"]


class GeomsimError(Exception):
    """Base of every error that bad input can raise; the command line prints its sentence and exits with code 2."""


class PlanError(GeomsimError):
    """A floor plan that cannot be read or used; the message names the file and the place in it."""


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
    close = difflib.get_close_matches(name.lower(), [n.lower() for n in names], n=1, cutoff=0.5)
    if close:
        match = next(n for n in names if n.lower() == close[0])
        return f"did you mean {match!r}?"
    return "choose one of " + ", ".join(repr(n) for n in names) + "."
