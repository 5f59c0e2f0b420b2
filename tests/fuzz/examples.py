"""A small file of every kind that geomsim reads, to be damaged."""

import io
import json

import cv2
import ezdxf
import numpy as np
from shapely.geometry import box

from tests.maps import test_drawings as drawings
from tests.maps import test_formats as formats

SVG = drawings.SVG.format(
    '<g transform="rotate(3) scale(2)"><path id="room-a" d="M 0 0 h 400 v 300 h -400 z"/></g>' + drawings.ROOM
)
YAML = "image: map.png\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"


def _room(suffix: str) -> bytes:
    image = np.zeros((60, 80), np.uint8)
    image[5:55, 5:75] = 254
    image[5:30, 40:42] = 0
    return cv2.imencode(suffix, image)[1].tobytes()


def _dxf() -> bytes:
    drawing = ezdxf.new("R2000", units=6)
    drawing.modelspace().add_lwpolyline([(0, 0), (5, 0), (5, 4), (0, 4)], close=True, dxfattribs={"layer": "SPACE"})
    text = io.StringIO()
    drawing.write(text)
    return text.getvalue().encode()


def _json(value: object) -> bytes:
    return json.dumps(value).encode()


_PLAN = {"type": "FeatureCollection", "name": "x", "start": [1], "features": []}
_FEATURES = [
    {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [formats.SQUARE]}},
    {
        "type": "Feature",
        "properties": {"kind": "wall", "width": 0.1},
        "geometry": {"type": "LineString", "coordinates": [[2, 0], [2, 3]]},
    },
    {
        "type": "Feature",
        "properties": {"kind": "label", "name": "a", "number": 1},
        "geometry": {"type": "Point", "coordinates": [1, 1]},
    },
]

#: of each kind: the name of a file, its content, and the options that it is read with
EXAMPLES: dict[str, tuple[str, bytes, dict[str, object]]] = {
    "GeoJSON": ("a.geojson", _json(_PLAN | {"features": _FEATURES}), {}),
    "OpenStreetMap indoor": ("osm.geojson", _json(formats.indoor()), {}),
    "WRLD indoor": (
        "wrld.geojson",
        _json(
            {
                "type": "FeatureCollection",
                "features": [
                    formats.mapped("Polygon", formats.corners(0, 0, 9, 4), type="building_outline"),
                    formats.mapped("Polygon", formats.corners(5, 0, 5.2, 1), type="wall"),
                ],
            }
        ),
        {},
    ),
    "HouseExpo": ("house.json", _json({"verts": formats.SQUARE, "room_category": {"Garage": [[0, 0, 2, 2]]}}), {}),
    "ResPlan": ("flats.json", _json([formats.flat(3, 80)]), {"resolution": 0.05}),
    "PyRoboSim world": ("world.yaml", formats.WORLD.encode(), {}),
    "ROS map": ("map.yaml", YAML.encode(), {}),
    "picture": ("map.png", _room(".png"), {"resolution": 0.05}),
    "picture (PGM)": ("map.pgm", _room(".pgm"), {"resolution": 0.05}),
    "picture (BMP)": ("map.bmp", _room(".bmp"), {"resolution": 0.05}),
    "picture (JPEG)": ("map.jpg", _room(".jpg"), {"resolution": 0.05}),
    "picture (TIFF)": ("map.tiff", _room(".tiff"), {"resolution": 0.05}),
    "well-known text": ("a.wkt", box(0, 0, 5, 4).wkt.encode(), {}),
    "Moving AI map": ("a.map", formats.GRID.encode(), {"resolution": 1.0}),
    "SVG drawing": ("a.svg", SVG.encode(), {"resolution": 0.01}),
    "DXF drawing": ("a.dxf", _dxf(), {}),
    "IndoorGML": ("a.gml", drawings.indoor().encode(), {}),
}

#: a scenario with keys of every type
SCENARIO = b"""plan = "house"
seed = 3
pursuers = 2
start = [1, 7]
planner = "decoupled"
cost = "entropy"
depth = 3
capture = "cell"
range = 9.5
evader = "still"
time_limit = 20.0
physics_step = 0.1
"""
