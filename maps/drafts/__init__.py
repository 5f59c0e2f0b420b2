"""The bundled plans as sketches; :func:`write_drafts` turns them into the files in ``maps/bundled``."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from maps.drafts.house import draft_house
from maps.drafts.museum import draft_museum
from maps.drafts.office import draft_office
from maps.drafts.school import draft_school
from maps.floorplan import FloorPlan
from maps.geojson import write_geojson

__all__ = ["DRAFTS", "write_drafts"]

DRAFTS: dict[str, Callable[[], FloorPlan]] = {
    "house": draft_house,
    "museum": draft_museum,
    "office": draft_office,
    "school": draft_school,
}
"""The bundled plans that are drawn here, by name."""


def write_drafts(folder: Path) -> list[Path]:
    """Write every draft as GeoJSON into a folder; ``maps/bundled`` holds what this writes."""
    return [write_geojson(draft(), folder / f"{name}.geojson") for name, draft in DRAFTS.items()]
