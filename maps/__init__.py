"""Floor plans: model, validation and repair, one reader per format, bundled plans."""

from maps.conformance import check_format
from maps.drafting import Door, Room, draft_plan, draft_rooms
from maps.errors import ConformanceError, GeomsimError, PlanError, nearest
from maps.floorplan import FloorPlan, FreeSpace, Label, Repair
from maps.geojson import read_geojson, write_geojson
from maps.making import make_plan
from maps.reading import FORMATS, Format, bundled_names, read_plan, register_format
from maps.writing import write_plan

__all__ = [
    "FORMATS",
    "ConformanceError",
    "Door",
    "FloorPlan",
    "Format",
    "FreeSpace",
    "GeomsimError",
    "Label",
    "PlanError",
    "Repair",
    "Room",
    "bundled_names",
    "check_format",
    "draft_plan",
    "draft_rooms",
    "make_plan",
    "nearest",
    "read_geojson",
    "read_plan",
    "register_format",
    "write_geojson",
    "write_plan",
]
