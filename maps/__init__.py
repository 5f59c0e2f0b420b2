"""Floor plans: model, validation and repair, one reader per format, bundled plans."""

from maps.errors import GeomsimError, PlanError, nearest
from maps.floorplan import FloorPlan, FreeSpace, Label, Repair

__all__ = ["FloorPlan", "FreeSpace", "GeomsimError", "Label", "PlanError", "Repair", "nearest"]
