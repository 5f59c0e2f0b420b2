"""Files that mean no good: each gets one sentence, soon and in little memory."""

import json
import os
import struct
import threading
import time
import zlib

import cv2
import numpy as np
import pytest
import yaml

from maps import PlanError, read_plan
from maps.errors import shown
from maps.picturesizes import picture_size
from maps.texts import LARGEST_FILE, load_yaml

SQUARE = [[0, 0], [5, 0], [5, 4], [0, 4], [0, 0]]
ROOM = {"type": "Polygon", "coordinates": [SQUARE]}
MAP = {
    "image": "map.png",
    "resolution": 0.05,
    "origin": [0, 0, 0],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}
BOM = b"\xef\xbb\xbf"


def feature(geometry, **properties):
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def plan_with(*features):
    return json.dumps({"type": "FeatureCollection", "features": [feature(ROOM), *features]})


def room():
    image = np.zeros((80, 80), np.uint8)
    image[10:70, 10:70] = 254
    return image


def ros(folder, **changes):
    cv2.imwrite(str(folder / "map.png"), room())
    path = folder / "map.yaml"
    path.write_text(yaml.safe_dump({**MAP, **changes}))
    return path


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width, height, rows):
    """A PNG of grey that claims a size and holds so many rows."""
    packed = zlib.compress((b"\0" + b"\xff" * width) * rows)
    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", packed) + chunk(b"IEND", b"")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        pytest.param(
            json.dumps(ROOM).replace("5,", "1" + "0" * 5000 + ",", 1),
            "a number of 5001 digits, 100000000000...",
            id="coordinate of 5000 digits",
        ),
        pytest.param(
            plan_with(feature({"type": "LineString", "coordinates": [[1, 1], [1, 2]]}, kind="wall", width=10**400)),
            "a number of 401 digits",
            id="width of 400 digits",
        ),
        pytest.param(
            plan_with(feature({"type": "LineString", "coordinates": [[1, 1], [1, 2]]}, kind="wall", width=10**200)),
            "'width' must be a thickness, not a whole number of about 201 digits",
            id="width of 200 digits",
        ),
        pytest.param(
            plan_with(feature({"type": "Point", "coordinates": []}, kind="label", number=1)),
            "feature 2 is a label without a place",
            id="label that is nowhere",
        ),
        pytest.param(
            json.dumps({"type": "Polygon", "coordinates": [[[x * 1e154, y * 1e154] for x, y in SQUARE]]}),
            "5e+154 m x 4e+154 m",
            id="larger than the universe",
        ),
        pytest.param(
            '{"name": "\\uD800x", ' + json.dumps(ROOM)[1:], "\\ud800 in it is half a character", id="half a character"
        ),
    ],
)
def test_geojson_gets_one_short_sentence(tmp_path, text, sentence):
    path = tmp_path / "plan.geojson"
    path.write_text(text)
    with pytest.raises(PlanError) as caught:
        read_plan(path)
    assert sentence in str(caught.value)
    assert str(caught.value).startswith(str(path))
    assert len(str(caught.value)) < len(str(path)) + 250


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"origin": [10**400, 0, 0]}, "origin is [a whole number of about 401 digits, 0, 0]; it must be"),
        ({"resolution": 10**400}, "resolution is a whole number of about 401 digits; it must be a finite number"),
        ({"resolution": 1e-300}, "resolution is 1e-300; it must be the size of a pixel in metres, from 1e-06 to 100"),
        ({"image": "a\0b.png"}, "cannot be read (there is a null character in its name)"),
        ({"image": "x" * 300 + ".png"}, "cannot be read (File name too long)"),
        ({"image": "."}, "is a folder"),
        ({"image": "/dev/zero"}, "the file /dev/zero is a pipe or a device and may never end"),
        ({"image": [["a"] * 50] * 50}, "image is [["),
    ],
)
def test_ros_maps_get_one_short_sentence(tmp_path, changes, sentence):
    path = ros(tmp_path, **changes)
    with pytest.raises(PlanError) as caught:
        read_plan(path)
    assert sentence in str(caught.value)
    assert str(caught.value).startswith(str(path))
    assert len(str(caught.value)) < 2 * len(str(path)) + 500


@pytest.mark.parametrize("key", ["resolution", "origin", "negate", "occupied_thresh", "free_thresh"])
def test_a_key_that_is_missing_is_called_missing(tmp_path, key):
    path = ros(tmp_path)
    path.write_text(yaml.safe_dump({k: v for k, v in MAP.items() if k != key}))
    with pytest.raises(PlanError, match=f"the key '{key}' is missing"):
        read_plan(path)


def bomb(last):
    """Nine levels of lists of nine: 400 million values in half a kilobyte."""
    levels = ["a: &a [x, x, x, x, x, x, x, x, x]"]
    levels += [f"{b}: &{b} [{', '.join(['*' + a] * 9)}]" for a, b in zip("abcdefghi", "bcdefghij", strict=True)]
    return "\n".join([*levels, last])


def merges():
    levels = ["a: &a {k: 1}"]
    levels += [f"{b}: &{b} {{<<: [{', '.join(['*' + a] * 9)}]}}" for a, b in zip("abcdefghi", "bcdefghij", strict=True)]
    return "\n".join(levels)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        pytest.param("image: 2001-99-99", "line 1, column 8: '2001-99-99' is no timestamp", id="no such day"),
        pytest.param("a: 1\nresolution: " + "1" * 6000, "line 2, column 13: '1111", id="number of 6000 digits"),
        pytest.param("a: !!bool perhaps", "line 1, column 4: 'perhaps' is no bool", id="no truth"),
        pytest.param("a: !!timestamp soon", "'soon' is no timestamp", id="no time"),
        pytest.param(bomb("image: *j"), "its aliases stand for too much", id="aliases of aliases"),
        pytest.param(merges(), "its aliases stand for too much", id="merges of merges"),
        pytest.param("a: &a [*a]", "a value holds itself", id="list in itself"),
        pytest.param("a: &a {b: {c: *a}}", "a value holds itself", id="mapping in itself"),
    ],
)
def test_yaml_gets_one_short_sentence(tmp_path, text, sentence):
    path = tmp_path / "map.yaml"
    path.write_text(text)
    with pytest.raises(PlanError) as caught:
        read_plan(path)
    assert sentence in str(caught.value)
    assert len(str(caught.value)) < len(str(path)) + 200


def test_a_few_aliases_are_welcome(tmp_path):
    path = tmp_path / "map.yaml"
    path.write_text("pose: &pose [1, 2, 3]\na: {pose: *pose}\nb: {pose: *pose}\n")
    assert load_yaml(path, "x") == {"pose": [1, 2, 3], "a": {"pose": [1, 2, 3]}, "b": {"pose": [1, 2, 3]}}


def test_text_may_begin_with_a_byte_order_mark(tmp_path):
    path = tmp_path / "plan.geojson"
    path.write_bytes(BOM + json.dumps(ROOM).encode())
    assert read_plan(path).area == 20.0
    path = tmp_path / "plan.wkt"
    path.write_bytes(BOM + b"POLYGON ((0 0, 5 0, 5 4, 0 4, 0 0))\r\n")
    assert read_plan(path).area == 20.0
    path = ros(tmp_path)
    path.write_bytes(BOM + path.read_bytes().replace(b"\n", b"\r\n"))
    assert read_plan(path).area == 9.0
    path = tmp_path / "world.yaml"
    path.write_bytes(BOM + b"rooms:\r\n- name: a\r\n  footprint: {type: box, dims: [5, 4]}\r\n")
    assert read_plan(path).area == 20.0


def test_a_character_in_two_halves_is_one(tmp_path):
    path = tmp_path / "plan.geojson"
    path.write_text('{"name": "\\ud83d\\ude00", ' + json.dumps(ROOM)[1:])
    assert read_plan(path).name == "\U0001f600"


@pytest.mark.parametrize("suffix", ["geojson", "yaml", "png", "wkt", "map", "dxf", "svg", "ifc", "gml"])
def test_what_may_never_end_is_not_opened(tmp_path, suffix):
    path = tmp_path / f"pipe.{suffix}"
    os.mkfifo(path)
    with pytest.raises(PlanError, match="is a pipe or a device and may never end"):
        read_plan(path)


def test_a_picture_that_may_never_end_is_not_opened(tmp_path):
    os.mkfifo(tmp_path / "pipe.png")
    path = ros(tmp_path, image="pipe.png")
    with pytest.raises(PlanError, match=r"the file .*pipe\.png is a pipe or a device"):
        read_plan(path)


def test_a_file_beyond_all_measure_is_not_read(tmp_path):
    path = tmp_path / "plan.geojson"
    with path.open("wb") as file:
        file.truncate(LARGEST_FILE + 1)
    with pytest.raises(PlanError, match=f"has {LARGEST_FILE + 1} bytes; at most {LARGEST_FILE} are possible"):
        read_plan(path)


def test_a_link_to_itself_is_called_that(tmp_path):
    path = tmp_path / "loop.geojson"
    path.symlink_to(path)
    with pytest.raises(PlanError, match="it is a symbolic link that leads to itself"):
        read_plan(path)
    dangling = tmp_path / "dangling.geojson"
    dangling.symlink_to(tmp_path / "nowhere")
    with pytest.raises(PlanError, match="There is no file"):
        read_plan(dangling)


@pytest.mark.parametrize(
    "damaged",
    [
        pytest.param(png(300, 300, 100), id="rows are missing"),
        pytest.param(png(60, 60, 60).replace(zlib.compress(b"\0")[:2], b"\xff\xff", 1), id="not compressed"),
    ],
)
def test_a_damaged_png_gets_our_sentence_only(tmp_path, damaged, capfd):
    path = ros(tmp_path)
    (tmp_path / "map.png").write_bytes(damaged)
    with pytest.raises(PlanError, match=r"map\.png is not an image that can be read"):
        read_plan(path)
    assert capfd.readouterr() == ("", "")
    os.write(2, b"still there")
    assert capfd.readouterr().err == "still there"


def test_pictures_are_read_by_several_threads_and_standard_error_survives(tmp_path, capfd):
    path = ros(tmp_path)
    areas = []
    threads = [threading.Thread(target=lambda: areas.append(read_plan(path).area)) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert areas == [9.0] * 8
    os.write(2, b"still there")
    assert capfd.readouterr().err == "still there"


@pytest.mark.parametrize(
    "giant",
    [
        pytest.param(png(30_000, 30_000, 1), id="PNG"),
        pytest.param(b"P5\n# made by hand\n30000 30000\n255\n", id="PGM"),
        pytest.param(b"P2 30000 30000 255 0", id="PGM in ASCII"),
        pytest.param(b"BM" + bytes(12) + struct.pack("<Iii", 40, 30_000, -30_000) + bytes(40), id="BMP"),
        pytest.param(
            b"\xff\xd8\xff\xe0\0\x04ab\xff\xc0\0\x0b\x08" + struct.pack(">HH", 30_000, 30_000) + bytes(9), id="JPEG"
        ),
        pytest.param(
            b"II*\0" + struct.pack("<IHHHIIHHII", 8, 2, 256, 4, 1, 30_000, 257, 3, 1, 30_000) + bytes(9), id="TIFF"
        ),
    ],
)
def test_a_giant_is_refused_before_it_is_decoded(tmp_path, giant, monkeypatch):
    path = ros(tmp_path)
    (tmp_path / "map.png").write_bytes(giant)
    monkeypatch.setattr(cv2, "imdecode", None)
    with pytest.raises(PlanError, match=r"has 30000 x 30000 pixels; at most 40000000 are possible"):
        read_plan(path)


@pytest.mark.parametrize("side", [1500, 2500])
def test_a_picture_of_noise_is_refused_soon(tmp_path, side):
    noise = (np.random.default_rng(0).random((side, side)) < 0.6).astype(np.uint8) * 254
    cv2.imwrite(str(tmp_path / "noise.png"), noise)
    before = time.process_time()
    with pytest.raises(PlanError, match="this is noise") as caught:
        read_plan(tmp_path / "noise.png", resolution=0.05)
    assert time.process_time() - before < 5
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("suffix", [".png", ".pgm", ".bmp", ".jpg", ".tiff"])
def test_sizes_of_pictures_are_read_from_their_heads(suffix):
    data = cv2.imencode(suffix, np.zeros((37, 91), np.uint8))[1].tobytes()
    assert picture_size(data) == (91, 37)
    for cut in range(0, 200, 7):
        assert picture_size(data[:cut]) in (None, (91, 37))


@pytest.mark.parametrize("data", [b"", b"hello", b"P5 x", b"\xff\xd8\xff", b"II*\0\xff\xff\xff\xff", bytes(100)])
def test_what_has_no_size_has_none(data):
    assert picture_size(data) is None


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ("a", "'a'"),
        ([0, 0.5], "[0, 0.5]"),
        (None, "None"),
        (10**19, "1" + "0" * 19),
        pytest.param(-(10**5000), "a whole number of about 5001 digits", id="5001 digits"),
    ],
)
def test_values_are_shown(value, text):
    assert shown(value) == text


def test_values_are_shown_in_short():
    deep = "x" * 1000
    for _ in range(30):
        deep = [deep] * 9
    assert len(shown(deep)) < 300
