"""The error of this package."""

from maps import GeomsimError

__all__ = ["DiscretizeError"]


class DiscretizeError(GeomsimError):
    """A plan, method, body or file of cells that cannot be used; the message says which and why."""
