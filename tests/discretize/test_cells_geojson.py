"""Cells written as GeoJSON, edited and read back."""

import json

import numpy as np
import pytest
import shapely

from discretize import DiscretizeError, check_cells, convex_cells, read_cells, write_cells
from tests.discretize.plans import grid_of_rooms


@pytest.fixture
def plan():
    return grid_of_rooms(3, 2)


@pytest.fixture
def file(plan, tmp_path):
    path = tmp_path / "cells.geojson"
    write_cells(convex_cells(plan), path)
    return path


def edit(path, change):
    document = json.loads(path.read_text())
    change(document["features"])
    path.write_text(json.dumps(document))


def cells_of(features):
    return [f for f in features if f["geometry"]["type"] == "Polygon"]


def test_round_trip_keeps_everything(plan, file):
    before, after = convex_cells(plan), read_cells(file, plan)
    assert [c.wkb for c in after.cells] == [c.wkb for c in before.cells]
    assert after.edges == before.edges
    assert after.names == before.names
    np.testing.assert_array_equal(after.checkpoints, before.checkpoints)
    assert check_cells(after).problems == ()


def test_properties(plan, file):
    cellmap = convex_cells(plan)
    features = json.loads(file.read_text())["features"]
    cells = cells_of(features)
    assert [f["properties"]["number"] for f in cells] == list(range(1, len(cellmap) + 1))
    assert sum(f["properties"]["area"] for f in cells) == pytest.approx(plan.area, abs=1e-4)
    pairs = {tuple(sorted((f["properties"]["number"], n))) for f in cells for n in f["properties"]["neighbours"]}
    assert pairs == {(a + 1, b + 1) for a, b in cellmap.edges}
    lines = [f for f in features if f["geometry"]["type"] == "LineString"]
    assert {tuple(f["properties"]["cells"]) for f in lines} == pairs


def test_a_person_renames_and_renumbers(plan, file):
    def change(features):
        cells = cells_of(features)
        for f in cells:
            f["properties"]["number"] = len(cells) + 1 - f["properties"]["number"]
        cells[0]["properties"]["name"] = "pantry"

    edit(file, change)
    after = read_cells(file, plan)
    assert after.names[-1] == "pantry"
    assert after.cells[-1].wkb == convex_cells(plan).cells[0].wkb


def test_a_person_joins_two_cells(plan, file):
    before = convex_cells(plan)
    a, b = before.edges[0]

    def change(features):
        cells = cells_of(features)
        whole = shapely.union(before.cells[a], before.cells[b])
        cells[a]["geometry"] = json.loads(shapely.to_geojson(whole))
        features.remove(cells[b])

    edit(file, change)
    after = read_cells(file, plan)
    assert len(after) == len(before) - 1
    assert check_cells(after).problems == ()


def test_a_person_splits_a_cell(plan, file):
    before = convex_cells(plan)
    k = int(np.argmax(before.areas))
    x0, y0, x1, y1 = before.cells[k].bounds
    halves = [before.cells[k].intersection(shapely.box(x0, y0, (x0 + x1) / 2, y1))]
    halves.append(before.cells[k].difference(halves[0]))

    def change(features):
        features.remove(cells_of(features)[k])
        for half in halves:
            features.append({"type": "Feature", "properties": {}, "geometry": json.loads(shapely.to_geojson(half))})

    edit(file, change)
    after = read_cells(file, plan)
    assert len(after) == len(before) + 1
    assert check_cells(after).problems == ()


def broken(kind):
    def change(features):
        first = cells_of(features)[0]
        if kind == "removed":
            features.remove(first)
        elif kind == "doubled":
            features.append(first)
        elif kind == "bow tie":
            first["geometry"]["coordinates"] = [[[0, 0], [1, 1], [1, 0], [0, 1], [0, 0]]]
        elif kind == "hole":
            ring = shapely.Polygon(first["geometry"]["coordinates"][0])
            hole = ring.centroid.buffer(0.01, quad_segs=1)
            first["geometry"] = shapely.geometry.mapping(ring.difference(hole))
        elif kind == "two polygons":
            first["geometry"] = {
                "type": "MultiPolygon",
                "coordinates": [[[[0, 0], [1, 0], [1, 1], [0, 0]]], [[[3, 3], [4, 3], [4, 4], [3, 3]]]],
            }
        elif kind == "no geometry":
            first["geometry"] = None
        elif kind == "text for a number":
            first["properties"]["number"] = "one"
        elif kind == "number for a name":
            first["properties"]["name"] = 7
        elif kind == "no feature":
            features[0] = "cell"
        elif kind == "no cells":
            features.clear()

    return change


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("removed", "lie in no cell, the most of it at ("),
        ("doubled", "lie in two cells"),
        ("bow tie", "feature 1: not a simple polygon (Self-intersection"),
        ("hole", "lie in no cell, the most of it at ("),
        ("two polygons", "feature 1: a cell is one polygon, not MultiPolygon"),
        ("no geometry", "feature 1: its geometry cannot be read"),
        ("text for a number", "feature 1: its number must be a whole number, not 'one'"),
        ("number for a name", "feature 1: its name must be text, not 7"),
        ("no feature", "feature 1: not a GeoJSON feature"),
        ("no cells", "has no polygon"),
    ],
)
def test_broken_files_are_refused_in_a_sentence(plan, file, kind, words):
    edit(file, broken(kind))
    with pytest.raises(DiscretizeError) as caught:
        read_cells(file, plan)
    message = str(caught.value)
    assert words in message
    assert str(file) in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("text", "words"), [("{", "not valid JSON"), ("[]", "FeatureCollection"), (None, "cannot be read")]
)
def test_files_of_another_kind(plan, tmp_path, text, words):
    path = tmp_path / "cells.geojson"
    if text is not None:
        path.write_text(text)
    with pytest.raises(DiscretizeError, match=words):
        read_cells(path, plan)


def test_folder_that_does_not_exist(plan, tmp_path):
    with pytest.raises(DiscretizeError, match="Cannot write"):
        write_cells(convex_cells(plan), tmp_path / "none" / "cells.geojson")
