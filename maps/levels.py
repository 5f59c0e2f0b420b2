"""Buildings of several storeys: which one is meant, and what is said about the others."""

from __future__ import annotations

from collections.abc import Mapping

import shapely

from maps.errors import PlanError, nearest
from maps.floorplan import Repair

__all__ = ["choose_level"]


def choose_level(areas: Mapping[str, float], level: str | int | None, where: str) -> tuple[str, list[Repair]]:
    """Choose a storey: the one asked for, or else the largest, and then name the others.

    Parameters
    ----------
    areas : mapping of str to float
        Names of the storeys, and the floor area of each, square metres.
    level : str, int or None
        The one asked for.
    where : str
        What error sentences begin with.

    Raises
    ------
    PlanError
        If there is no storey of this name.
    """
    if not areas:
        raise PlanError(f"{where}: there is no free space in it, no room at all.")
    if level is not None:
        if str(level) not in areas:
            raise PlanError(f"{where}: there is no level {str(level)!r}; {nearest(str(level), areas)}")
        return str(level), []
    chosen = max(areas, key=lambda name: areas[name])
    if len(areas) == 1:
        return chosen, []
    others = ", ".join(repr(name) for name in areas if name != chosen)
    message = f"Level {chosen!r}, the largest with {areas[chosen]:.0f} square metres, is used; the others are {others}."
    return chosen, [Repair("other levels", message, shapely.GeometryCollection())]
