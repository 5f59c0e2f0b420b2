import json
import math

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely import LineString, box

from maps import Label, PlanError, make_plan, read_geojson, read_plan, write_geojson
from maps.geojson import geojson_text

SQUARE = [[0, 0], [5, 0], [5, 4], [0, 4], [0, 0]]
ROOM = {"type": "Polygon", "coordinates": [SQUARE]}


def feature(geometry, **properties):
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def collection(*features, **members):
    return {"type": "FeatureCollection", **members, "features": list(features)}


def read(tmp_path, data):
    path = tmp_path / "plan.geojson"
    path.write_text(data if isinstance(data, str) else json.dumps(data))
    return read_plan(path)


@pytest.mark.parametrize(
    ("data", "area"),
    [
        pytest.param(ROOM, 20.0, id="bare polygon"),
        pytest.param({"type": "Polygon", "coordinates": [SQUARE[:-1]]}, 20.0, id="ring not closed"),
        pytest.param({"type": "Polygon", "coordinates": [SQUARE, [[1, 1], [2, 1], [2, 2], [1, 2]]]}, 19.0, id="hole"),
        pytest.param({"type": "MultiPolygon", "coordinates": [[SQUARE], [[[5, 0], [9, 0], [9, 4]]]]}, 28.0, id="multi"),
        pytest.param({"type": "GeometryCollection", "geometries": [ROOM]}, 20.0, id="collection of geometries"),
        pytest.param({"type": "Feature", "geometry": ROOM, "properties": None}, 20.0, id="feature"),
        pytest.param(collection(feature(ROOM), feature(None)), 20.0, id="feature without geometry"),
        pytest.param({"type": "Polygon", "coordinates": [[[x, y, 7] for x, y in SQUARE]]}, 20.0, id="with heights"),
        pytest.param({**ROOM, "units": "ft"}, 20.0 * 0.3048**2, id="feet"),
        pytest.param({**ROOM, "units": "Metres"}, 20.0, id="metres"),
        pytest.param(
            collection(
                feature(ROOM, kind="room"),
                feature({"type": "Polygon", "coordinates": [[[1, 1], [2, 1], [2, 2], [1, 2]]]}, kind="obstacle"),
                feature({"type": "LineString", "coordinates": [[3, 0], [3, 3]]}, kind="wall", width=0.1),
            ),
            20.0 - 1.0 - 0.1 * 3.05,
            id="walls and obstacles",
        ),
    ],
)
def test_what_a_person_would_write_is_read(tmp_path, data, area):
    plan = read(tmp_path, data)
    assert plan.area == pytest.approx(area, rel=1e-3)
    assert plan.name == "plan"
    assert plan.source == str(tmp_path / "plan.geojson")
    assert plan.repairs == ()


def test_millimetres_are_metres_over_a_thousand(tmp_path):
    big = {"type": "Polygon", "coordinates": [[[x * 1000, y * 1000] for x, y in SQUARE]], "units": "mm"}
    assert read(tmp_path, big).space.equals(box(0, 0, 5, 4))


def test_doors_labels_start_and_name_are_read(tmp_path):
    other = {"type": "Polygon", "coordinates": [[[5, 0], [9, 0], [9, 4], [5, 4]]]}
    data = collection(
        feature(ROOM, name="kitchen", number=1),
        feature(other, kind="room"),
        feature({"type": "LineString", "coordinates": [[5, 1], [5, 2]]}, kind="door"),
        feature({"type": "Point", "coordinates": [7, 2]}, name="hall", number=2),
        name="flat",
        start=[2],
    )
    plan = read(tmp_path, data)
    assert plan.name == "flat"
    assert plan.start == (2,)
    assert [list(d.coords) for d in plan.doors] == [[(5, 1), (5, 2)]]
    assert {(label.name, label.number) for label in plan.labels} == {("kitchen", 1), ("hall", 2)}


@pytest.mark.parametrize("units", [{}, {"units": "degrees"}])
def test_longitude_and_latitude_become_metres_and_that_is_said(tmp_path, units):
    """At 60 degrees north a degree of longitude is 55.8 km, one of latitude 111.4 km."""
    ring = [[13.7 + x / 55_800, 60.0 + y / 111_412] for x, y in SQUARE]
    plan = read(tmp_path, {"type": "Polygon", "coordinates": [ring], **units})
    x0, y0, x1, y1 = plan.bounds
    assert (x1 - x0, y1 - y0) == (pytest.approx(5, abs=0.01), pytest.approx(4, abs=0.01))
    assert [r.kind for r in plan.repairs] == ["projected"]
    assert "13.70" in plan.repairs[0].message


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        ("", "not valid JSON at line 1"),
        ("{" * 100_000, "not valid JSON"),
        ("[1]", "one object, not a list"),
        ('{"type": "Polygon", "coordinates": [[[0, NaN]]]}', "there is a NaN in it"),
        ({}, "'type' is None, so this is not GeoJSON"),
        ({"type": "Polygn"}, "'Polygn', so this is not GeoJSON; did you mean 'Polygon'"),
        ({"type": "FeatureCollection"}, "needs a list 'features', not NoneType"),
        (collection(), "no polygon of kind 'free' or 'room'"),
        (collection(ROOM), "feature 1 is not an object of type 'Feature'"),
        (collection(feature(ROOM), 3), "feature 2 is not an object of type 'Feature'"),
        (collection({"type": "Feature", "properties": [], "geometry": ROOM}), None),
        (
            collection({"type": "Feature", "properties": [1], "geometry": ROOM}),
            "properties that are no object",
        ),
        (collection(feature({"type": "Circle"})), "feature 1 has the geometry type 'Circle'"),
        (collection(feature([])), "feature 1 has the geometry type"),
        ({"type": "Polygon"}, "is a Polygon whose coordinates are not as GeoJSON says"),
        ({"type": "Polygon", "coordinates": [[[0, 0], "x"]]}, "is a Polygon whose coordinates are not as"),
        ({"type": "Polygon", "coordinates": [3]}, "is a Polygon whose coordinates are not as"),
        ({"type": "Polygon", "coordinates": [[[0, 0], [1, 1]]]}, "no free space in it for a person"),
        ({"type": "Polygon", "coordinates": []}, "no polygon at all"),
        ({"type": "Polygon", "coordinates": [[[0, 0], [1e999, 0], [1, 1]]]}, "must be finite|not as GeoJSON says"),
        ({"type": "Point", "coordinates": [0, 0]}, "no polygon of kind 'free' or 'room'"),
        ({"type": "LineString", "coordinates": [[0, 0], [1, 1]]}, "is a LineString of kind 'free'"),
        (collection(feature(ROOM, kind="rooms")), "kind 'rooms'; did you mean 'room'"),
        (collection(feature(ROOM, kind=7)), "kind 7; choose one of"),
        (collection(feature(ROOM, number="2a")), "number '2a'; room numbers are whole numbers"),
        ({**ROOM, "units": "parsec"}, "unit 'parsec' is not known"),
        ({**ROOM, "units": 3}, "units is 3; it must be the name of a unit"),
        ({**ROOM, "name": 3}, "'name' is 3; it must be a text"),
        ({**ROOM, "start": 3}, "start is a list of cell numbers from 1, not 3"),
        ({**ROOM, "start": ["a"]}, "'a' is not one"),
        (
            collection(feature(ROOM), feature({"type": "LineString", "coordinates": [[0, 0], [1, 1]]}, kind="wall")),
            "feature 2 is a wall drawn as a line; .* not None",
        ),
        (
            collection(feature(ROOM), feature({"type": "Point", "coordinates": [0, 0]}, kind="wall")),
            "is a Point; walls",
        ),
        (collection(feature(ROOM), feature(ROOM, kind="door")), "a door is a LineString .* not a Polygon"),
        ({"type": "Polygon", "coordinates": [[[x * 1e5, y] for x, y in SQUARE]]}, "at most 10 km"),
    ],
)
def test_what_is_wrong_is_refused_with_a_sentence(tmp_path, data, sentence):
    if sentence is None:
        assert read(tmp_path, data).area == 20.0
        return
    with pytest.raises(PlanError, match=sentence) as caught:
        read(tmp_path, data)
    assert str(caught.value).startswith(str(tmp_path / "plan.geojson"))
    assert str(caught.value).endswith((".", "?"))


def test_files_that_cannot_be_read_are_refused(tmp_path):
    with pytest.raises(PlanError, match=r"cannot be read \(No such file"):
        read_geojson(tmp_path / "nowhere.geojson")
    (tmp_path / "picture.geojson").write_bytes(b"\x89PNG\xff\xfe")
    with pytest.raises(PlanError, match="not text"):
        read_geojson(tmp_path / "picture.geojson")


millimetres = st.integers(-5000, 5000).map(lambda n: n / 1000)
boxes = st.builds(lambda x, y, w, h: box(x, y, x + w, y + h), millimetres, millimetres, st.just(1.5), st.floats(1, 4))


@given(st.lists(boxes, min_size=1, max_size=5), st.lists(boxes, max_size=2), st.text(max_size=8))
def test_written_plan_reads_back_the_same(tmp_path_factory, rooms, walls, name):
    try:
        plan = make_plan(rooms, name=name or "plan", solid=walls)
    except PlanError:
        return
    path = tmp_path_factory.getbasetemp() / "round.geojson"
    again = read_geojson(write_geojson(plan, path))
    assert again.space.equals(plan.space)
    assert again.name == plan.name
    assert geojson_text(again) == geojson_text(plan)


def test_everything_a_plan_holds_reads_back(tmp_path):
    plan = make_plan(
        [box(0, 0, 5, 4), box(5, 0, 9, 4), box(20, 20, 22, 22)],
        name="Büro №1",
        doors=[LineString([(5, 1), (5, 1.9)])],
        labels=[Label((1, 1), "kitchen", 1), Label((6, 1), "", 2), Label((21, 21), "shed")],
        start=[1, 2],
    )
    again = read_geojson(write_geojson(plan, tmp_path / "all.geojson"), source=plan.source)
    assert (again.name, again.space, again.doors, again.labels, again.start) == (
        plan.name,
        plan.space,
        plan.doors,
        plan.labels,
        plan.start,
    )
    assert again.repairs == ()
    assert math.isclose(shapely.area(again.space), 40.0)
