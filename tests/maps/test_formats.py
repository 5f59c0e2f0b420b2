"""Readers for the formats that need nothing but the package itself."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
import shapely
from shapely import box

from maps import PlanError, read_plan

SHARED = Path(__file__).parents[2].parent / "shared" / "floorplans"
SQUARE = [[0, 0], [5, 0], [5, 4], [0, 4], [0, 0]]


def kinds(plan):
    return [repair.kind for repair in plan.repairs]


def save(folder, name, content):
    path = folder / name
    if isinstance(content, bytes):
        path.write_bytes(content)
    else:
        path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


# Pictures


def drawing(outside=255):
    image = np.full((120, 200), outside, np.uint8)
    image[20:100, 20:180] = 0
    image[24:96, 24:98] = 255
    image[24:96, 102:176] = 255
    image[50:70, 98:102] = 255
    return image


@pytest.mark.parametrize(("outside", "expected"), [(255, ["dropped outside"]), (180, []), (0, [])])
@pytest.mark.parametrize("suffix", [".png", ".bmp", ".jpg", ".pgm", ".tiff"])
def test_a_picture_is_read_with_its_resolution(tmp_path, suffix, outside, expected):
    cv2.imwrite(str(tmp_path / f"plan{suffix}"), drawing(outside), [cv2.IMWRITE_JPEG_QUALITY, 100])
    plan = read_plan(tmp_path / f"plan{suffix}", resolution=0.05)
    assert plan.bounds == pytest.approx((1.2, 1.2, 8.8, 4.8), abs=0.06)
    assert plan.area == pytest.approx((2 * 72 * 74 + 20 * 4) * 0.05**2, rel=0.02)
    assert kinds(plan) == expected


def test_a_building_open_to_the_paper_around_it_is_kept(tmp_path):
    image = drawing()
    image[50:70, 176:180] = 255
    cv2.imwrite(str(tmp_path / "plan.png"), image)
    assert kinds(read_plan(tmp_path / "plan.png", resolution=0.05)) == []


@pytest.mark.parametrize(
    ("image", "options", "sentence"),
    [
        (drawing(), {}, "does not say how large it is; give its resolution"),
        (drawing(), {"resolution": -1}, "resolution is -1; it must be the size of a pixel"),
        (drawing(), {"resolution": 0.05, "level": 1}, "level is 1, but a picture has no use for it"),
        (np.zeros((5, 5), np.uint8), {"resolution": 0.05}, "none of its 25 pixels is free"),
        (np.full((5, 5), 255, np.uint8), {"resolution": 0.05}, "all of its 25 pixels are free"),
        (np.full((1, 1), 255, np.uint8), {"resolution": 0.05}, "all of its 1 pixels are free"),
        (drawing(), {"resolution": 0.0005}, "free space"),
    ],
)
def test_pictures_that_are_no_plan_are_refused(tmp_path, image, options, sentence):
    cv2.imwrite(str(tmp_path / "plan.png"), image)
    with pytest.raises(PlanError, match=sentence):
        read_plan(tmp_path / "plan.png", **options)


# Well-known text


@pytest.mark.parametrize(
    ("text", "options", "area"),
    [
        ("POLYGON ((0 0, 5 0, 5 4, 0 4, 0 0), (1 1, 2 1, 2 2, 1 2, 1 1))", {}, 19),
        ("GEOMETRYCOLLECTION (POLYGON ((0 0, 5 0, 5 4, 0 4, 0 0)))", {}, 20),
        ("POLYGON ((0 0, 5 0, 5 4, 0 4, 0 0))\n\nPOLYGON ((5 0, 6 0, 6 4, 5 4, 5 0))\n", {}, 24),
        ("POLYGON Z ((0 0 1, 5 0 1, 5 4 1, 0 4 1, 0 0 1))", {}, 20),
        ("POLYGON ((0 0, 5000 0, 5000 4000, 0 4000, 0 0))", {"units": "mm"}, 20),
    ],
)
def test_well_known_text_is_read(tmp_path, text, options, area):
    plan = read_plan(save(tmp_path, "plan.wkt", text), **options)
    assert plan.area == pytest.approx(area)
    assert plan.repairs == ()


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "the file is empty"),
        ("POLYGON ((0 0, 5 0, 5 4, 0 4, 0 0))\nhello", "line 2 is not well-known text; it begins with 'hello'"),
        ("LINESTRING (0 0, 1 1)", "made of polygons, not of LineString"),
        (b"\xff\xfe\x00", "not text"),
    ],
)
def test_what_is_no_well_known_text_is_refused(tmp_path, text, sentence):
    with pytest.raises(PlanError, match=sentence):
        read_plan(save(tmp_path, "plan.wkt", text))


# Moving AI grids

GRID = "type octile\nheight 3\nwidth 4\nmap\n@@@@\n@.G@\n@ST@\n"


def test_a_grid_map_is_read_cell_by_cell(tmp_path):
    plan = read_plan(save(tmp_path, "grid.map", GRID))
    assert plan.space.equals(shapely.union_all([box(1, 1, 3, 2), box(1, 0, 2, 1)]))
    assert kinds(plan) == ["assumed size"]
    half = read_plan(tmp_path / "grid.map", resolution=0.5)
    assert half.area == pytest.approx(0.75)
    assert kinds(half) == []


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("hello", "this is no Moving AI map"),
        ("type octile\nheight x\nwidth 4\nmap\n....", "this is no Moving AI map"),
        ("type octile\nheight 2\nmap\n....", "this is no Moving AI map"),
        (GRID.replace("@ST@\n", ""), "must have 3 rows of 4 signs; row 3 is not so"),
        (GRID.replace("@.G@", "@.G"), "must have 3 rows of 4 signs; row 2 is not so"),
        (GRID.replace("G", "?"), r"the sign '\?' in the grid has no meaning"),
        (GRID.replace(".", "@").replace("G", "@").replace("S", "@"), "none of its 12 pixels is free"),
    ],
)
def test_what_is_no_grid_is_refused(tmp_path, text, sentence):
    with pytest.raises(PlanError, match=sentence):
        read_plan(save(tmp_path, "grid.map", text))


# HouseExpo and ResPlan


def test_a_house_of_houseexpo_is_read(tmp_path):
    data = {"verts": SQUARE, "room_category": {"Living_Room": [[0, 0, 2, 2]], "Garage": [[20, 20, 22, 22]]}}
    plan = read_plan(save(tmp_path, "house.json", data))
    assert plan.space.equals(box(0, 0, 5, 4))
    assert [label.name for label in plan.labels] == ["living room"]


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        ({"verts": 3}, "verts must be a list of pairs"),
        ({"verts": [[0, 0], [1, 1]]}, "verts has 2 vertices"),
        ({"verts": SQUARE, "room_category": [1]}, "room_category must give"),
    ],
)
def test_a_broken_house_is_refused(tmp_path, data, sentence):
    with pytest.raises(PlanError, match=sentence):
        read_plan(save(tmp_path, "house.json", data))


def flat(number, size):
    return {
        "id": number,
        "geometries": {
            "living": [shapely.to_wkt(box(0, 0, size, 80))],
            "bedroom": [shapely.to_wkt(box(size + 2, 0, size + 80, 80))],
            "door": [shapely.to_wkt(box(size, 10, size + 2, 28))],
            "wall": [shapely.to_wkt(box(size, 28, size + 2, 80))],
        },
    }


def test_a_flat_of_resplan_is_read(tmp_path):
    path = save(tmp_path, "flats.json", [flat(3, 80), flat(7, 100)])
    plan = read_plan(path, resolution=0.05)
    assert plan.bounds == (0, 0, 9.0, 4.0)
    assert len(plan.parts) == 1
    assert [door.length for door in plan.doors] == [pytest.approx(0.9)]
    assert plan.repairs[0].kind == "other levels"
    assert "'3'" in plan.repairs[0].message
    assert read_plan(path, resolution=0.05, level=3).bounds == (0, 0, 8.0, 4.0)
    with pytest.raises(PlanError, match="no level '5'; choose one of '3', '7'"):
        read_plan(path, resolution=0.05, level=5)
    with pytest.raises(PlanError, match="coordinates have no unit; give the resolution"):
        read_plan(path)


@pytest.mark.parametrize(
    "data", [[{"geometries": {"living": ["POLYGN"]}}], [{"geometries": {"wall": 3}}], [3, {"geometries": {}}]]
)
def test_a_broken_flat_is_refused(tmp_path, data):
    with pytest.raises(PlanError, match="a flat needs 'geometries'"):
        read_plan(save(tmp_path, "flats.json", json.dumps(data)), resolution=0.05)


# PyRoboSim

WORLD = """
rooms:
  - name: kitchen
    footprint: {type: polygon, coords: [[0, 0], [4, 0], [4, 3], [0, 3]]}
  - name: bedroom
    footprint: {type: box, dims: [4, 3]}
    pose: {position: {x: 10, y: 1.5}}
hallways:
  - {room_start: kitchen, room_end: bedroom, width: 1.0}
"""


def test_a_world_of_pyrobosim_is_read(tmp_path):
    plan = read_plan(save(tmp_path, "world.yaml", WORLD))
    assert plan.space.equals(shapely.union_all([box(0, 0, 4, 3), box(8, 0, 12, 3), box(3, 1, 9, 2)]))
    assert {label.name for label in plan.labels} == {"kitchen", "bedroom"}
    assert plan.repairs == ()


@pytest.mark.parametrize(
    ("more", "area"),
    [
        ("conn_method: points, conn_points: [[2, 1], [10, 1]]", 28.0),
        ("conn_method: angle, conn_angle: 0.0, offset: -1.0", 28.0),
        ("conn_method: auto, offset: 0.5", 28.0),
    ],
)
def test_hallways_of_every_kind_join_their_rooms(tmp_path, more, area):
    plan = read_plan(save(tmp_path, "world.yaml", WORLD.replace("width: 1.0", f"width: 1.0, {more}")))
    assert len(plan.parts) == 1
    assert plan.area == pytest.approx(area, abs=1.0)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("type: box", "type: bxo", "room 'bedroom' has a footprint of type 'bxo'; did you mean 'box'"),
        ("dims: [4, 3]", "dims: [4]", "room 'bedroom' has a footprint or a pose whose numbers are missing"),
        (
            "room_end: bedroom",
            "room_end: bedrom",
            "room 'bedrom', which is not there; did you mean 'bedroom'",
        ),
        ("width: 1.0", "width: x", "hallway 1 has numbers that are missing or wrong"),
        ("width: 1.0", "width: 0", "hallway 1 does not reach"),
        ("width: 1.0", "width: 1, conn_method: curved", "the conn_method 'curved'"),
        ("width: 1.0", "width: 1, conn_method: angle, conn_angle: 3.0", "does not reach from the room 'kitchen'"),
        ("hallways:\n  - {", "hallways:\n  {", "hallways must be a list"),
    ],
)
def test_a_broken_world_is_refused(tmp_path, old, new, sentence):
    with pytest.raises(PlanError, match=sentence):
        read_plan(save(tmp_path, "world.yaml", WORLD.replace(old, new)))


def test_a_world_without_rooms_is_refused(tmp_path):
    with pytest.raises(PlanError, match="no room at all"):
        read_plan(save(tmp_path, "world.yaml", "rooms: []"))


# OpenStreetMap and WRLD


def degrees(xy):
    return [[13.7 + x / 70_000, 51.0 + y / 111_250] for x, y in xy]


def mapped(kind, xy, **tags):
    coordinates = {"Point": lambda: degrees(xy)[0], "LineString": lambda: degrees(xy), "Polygon": lambda: [degrees(xy)]}
    return {
        "type": "Feature",
        "properties": tags,
        "geometry": {"type": kind, "coordinates": coordinates[kind]()},
    }


def corners(x0, y0, x1, y1):
    return [[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]]


def indoor(*more):
    return {
        "type": "FeatureCollection",
        "features": [
            mapped("Polygon", corners(0, 0, 5, 4), indoor="room", level="0", name="Kitchen"),
            mapped("Polygon", corners(5, 0, 9, 4), indoor="room", level="0", ref="2"),
            mapped("Polygon", corners(0, 4, 9, 6), indoor="corridor", level="0"),
            mapped("Polygon", corners(0, 0, 5, 4), indoor="room", level="1"),
            mapped("Point", [[5, 2]], door="hinged", level="0"),
            mapped("Point", [[2, 4]], door="yes", width="1.2 m", level="0;1"),
            mapped("Point", [[0, 2]], door="yes", level="-1-2"),
            *more,
        ],
    }


def test_a_storey_of_openstreetmap_is_read(tmp_path):
    plan = read_plan(save(tmp_path, "indoor.geojson", indoor()))
    assert len(plan.parts) == 1
    assert kinds(plan) == ["projected", "other levels", "thickened walls", "assumed width", "left out"]
    assert sorted(round(door.length, 2) for door in plan.doors) == [0.9, 1.2]
    assert plan.area == pytest.approx(4.9 * 3.9 + 3.9 * 3.9 + 18 + 0.9 * 0.1 + 1.2 * 0.05, rel=0.01)
    assert {label.name for label in plan.labels} == {"Kitchen", "2"}


def test_another_storey_is_read_if_asked_for(tmp_path):
    path = save(tmp_path, "indoor.geojson", indoor())
    assert read_plan(path, level=1).area == pytest.approx(4.9 * 3.9, rel=0.01)
    with pytest.raises(PlanError, match="no level '7'; choose one of '0', '1'"):
        read_plan(path, level=7)


def test_walls_and_columns_of_openstreetmap_are_solid(tmp_path):
    more = [
        mapped("LineString", [[1, 0], [1, 3]], indoor="wall", level="0"),
        mapped("Polygon", corners(2, 1, 3, 2), indoor="column", level="0"),
    ]
    with_walls = read_plan(save(tmp_path, "a.geojson", indoor(*more)))
    without = read_plan(save(tmp_path, "b.geojson", indoor()))
    assert without.area - with_walls.area == pytest.approx(1.0 + 0.1 * 2.95, rel=0.02)


def test_a_map_without_rooms_is_refused(tmp_path):
    data = {"type": "FeatureCollection", "features": [mapped("Point", [[0, 0]], indoor="door", level="0")]}
    with pytest.raises(PlanError, match="no polygon with indoor = room, corridor or area"):
        read_plan(save(tmp_path, "indoor.geojson", data))


def test_a_storey_of_wrld_is_read(tmp_path):
    data = {
        "type": "FeatureCollection",
        "features": [
            mapped("Polygon", corners(0, 0, 9, 4), type="building_outline"),
            mapped("Polygon", corners(5, 0, 5.2, 1), type="wall"),
            mapped("Polygon", corners(5, 1, 5.2, 2), type="door"),
            mapped("Polygon", corners(5, 2, 5.2, 4), type="wall"),
            mapped("Polygon", corners(0, 0, 5, 4), type="room", name="Kitchen"),
        ],
    }
    plan = read_plan(save(tmp_path, "storey.geojson", data))
    assert len(plan.parts) == 1
    assert plan.area == pytest.approx(36 - 0.6, rel=0.01)
    assert [round(door.length, 2) for door in plan.doors] == [1.0]
    assert [label.name for label in plan.labels] == ["Kitchen"]
    data["features"][0]["properties"] = {"type": "building_outlin", "note": "building_outline"}
    with pytest.raises(PlanError, match="no feature of type 'building_outline'"):
        read_plan(save(tmp_path, "storey.geojson", json.dumps(data)))


@pytest.mark.parametrize("options", [{"resolution": 0.1}, {"level": "1"}, {"units": "m"}])
@pytest.mark.parametrize("name", ["house", "plan.yaml"])
def test_options_that_mean_nothing_are_refused(tmp_path, name, options):
    given = str(save(tmp_path, name, "image: x")) if "." in name else name
    with pytest.raises(PlanError, match="has no use for it; leave it out"):
        read_plan(given, **options)


# Plans from elsewhere


def manifest():
    path = SHARED / "MANIFEST.json"
    entries = json.loads(path.read_text())["entries"] if path.exists() else []
    return [entry for entry in entries if entry["role"] == "plan"]


@pytest.mark.parametrize("entry", manifest(), ids=lambda entry: entry["id"])
def test_every_plan_of_the_manifest_is_read(entry):
    path = SHARED / entry.get("yaml", entry["file"])
    options = {}
    if entry["format"] == "ros_map_server":
        path = path.with_suffix(".yaml")
    elif entry["format"] == "image":
        known = entry["resolution_m_per_px"]
        options["resolution"] = known if isinstance(known, float) else 0.05
    elif entry["category"] == "resplan":
        options["resolution"] = 0.05
    if entry["category"] in ("dxf", "ifc", "indoorgml"):
        pytest.importorskip("defusedxml")
    plan = read_plan(path, **options)
    assert plan.space.is_valid
    assert plan.area > 10
    assert all(repair.message.endswith(".") for repair in plan.repairs)
