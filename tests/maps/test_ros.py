from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml
from shapely import box

from maps import PlanError, read_plan
from maps.pictures import read_picture

MAPS = Path(__file__).parents[2].parent / "shared" / "floorplans"
REAL = sorted([*MAPS.glob("ros/*.yaml"), *MAPS.glob("bwi_gdc/gdc?.yaml"), *MAPS.glob("bwi_gdc/gdc3ne.yaml")])

GOOD = {
    "image": "map.pgm",
    "resolution": 0.05,
    "origin": [-1.0, 2.0, 0.0],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}
WALL, UNKNOWN, FREE = 0, 205, 254


def picture():
    """A room of 100 x 60 pixels, 10 from the left and 20 from below, with a wall around it."""
    image = np.full((100, 160), UNKNOWN, np.uint8)
    image[19:81, 9:111] = WALL
    image[20:80, 10:110] = FREE
    return image


def save(folder, pixels=None, **changes):
    data = {key: value for key, value in {**GOOD, **changes}.items() if value is not None}
    (folder / "map.yaml").write_text(yaml.safe_dump(data))
    pixels = picture() if pixels is None else pixels
    name = str(data.get("image", "map.pgm"))
    if name.endswith((".pgm", ".png")) and "/" not in name:
        cv2.imwrite(str(folder / name), pixels)
    return folder / "map.yaml"


def coloured(image, alpha=None):
    layers = [image] * 3 + ([] if alpha is None else [alpha])
    return np.dstack(layers)


def transparent():
    alpha = np.full((100, 160), 255, np.uint8)
    alpha[:, 60:] = 0
    return alpha


@pytest.mark.parametrize(
    ("image", "changes", "columns"),
    [
        pytest.param(picture(), {}, 100, id="pgm"),
        pytest.param(picture(), {"image": "map.png"}, 100, id="png"),
        pytest.param(coloured(picture()), {"image": "map.png"}, 100, id="colour"),
        pytest.param(picture().astype(np.uint16) * 257, {"image": "map.png"}, 100, id="16 bits"),
        pytest.param(coloured(picture(), transparent()), {"image": "map.png"}, 50, id="alpha"),
        pytest.param(255 - picture(), {"negate": 1}, 100, id="negate"),
        pytest.param(255 - picture(), {"negate": True}, 100, id="negate as a truth"),
        pytest.param(picture(), {"mode": "scale"}, 100, id="scale"),
        pytest.param(
            np.where(picture() == FREE, 0, np.where(picture() == WALL, 100, 255)), {"mode": "raw"}, 100, id="raw"
        ),
        pytest.param(np.where(picture() == FREE, 15, 80).astype(np.uint8), {"mode": "raw"}, 100, id="raw in percent"),
    ],
)
def test_every_mode_and_kind_of_image_gives_the_room(tmp_path, image, changes, columns):
    plan = read_plan(save(tmp_path, image.astype(image.dtype if image.dtype == np.uint16 else np.uint8), **changes))
    assert plan.space.equals(box(-0.5, 3.0, -0.5 + columns * 0.05, 6.0))
    assert plan.name == "map"
    assert plan.repairs == ()


def test_what_map_saver_wrote_for_unknown_is_not_free(tmp_path):
    plan = read_plan(save(tmp_path, free_thresh=0.25))
    assert plan.space.equals(box(-0.5, 3.0, 4.5, 6.0))
    assert plan.repairs[0].kind == "unknown pixels"
    shaded = picture()
    shaded[50, 50] = 206
    assert read_plan(save(tmp_path, shaded, free_thresh=0.25)).area > 20


def test_image_is_found_from_the_folder_of_the_yaml(tmp_path, monkeypatch):
    path = save(tmp_path)
    monkeypatch.chdir(tmp_path.parent)
    assert read_plan(Path(tmp_path.name) / path.name).area == pytest.approx(15.0)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"image": None}, "not a ROS map; it has no key 'image'"),
        ({"image": 3}, "image is 3; it must be the name of a file"),
        ({"image": "nowhere.pgm"}, None),
        ({"resolution": None}, "the key 'resolution' is missing"),
        ({"resolution": None, "resoluton": 0.05}, "'resolution' is missing; is it 'resoluton'"),
        ({"resolution": "0.05 m"}, "resolution is '0.05 m'; it must be a finite number"),
        ({"resolution": float("nan")}, "resolution is nan; it must be a finite number"),
        ({"resolution": 0}, "resolution is 0.0; it must be the size of a pixel"),
        ({"resolution": 100}, "resolution is 100.0; it must be the size of a pixel"),
        ({"resolution": -0.05}, "resolution is -0.05; it must be the size of a pixel"),
        ({"resolution": True}, "resolution is True"),
        ({"origin": None}, r"origin is None; it must be a list \[x, y, yaw\]"),
        ({"origin": [0, 0]}, r"origin is \[0, 0\]"),
        ({"origin": [0, 0, float("inf")]}, "three finite numbers"),
        ({"negate": None}, "negate is None; it must be 0 or 1"),
        ({"negate": 2}, "negate is 2; it must be 0 or 1"),
        ({"free_thresh": None}, "the key 'free_thresh' is missing"),
        ({"free_thresh": 25}, "free_thresh is 25.0; it must be between 0 and 1"),
        ({"free_thresh": 0.9}, "free_thresh 0.9 is larger than occupied_thresh 0.65"),
        ({"mode": "trinery"}, "mode is 'trinery'; did you mean 'trinary'"),
    ],
)
def test_wrong_keys_are_refused_with_a_sentence(tmp_path, changes, sentence):
    path = save(tmp_path, **changes)
    if sentence is None:
        (tmp_path / "nowhere.pgm").unlink()
        sentence = "nowhere.pgm cannot be read"
    with pytest.raises(PlanError, match=sentence) as caught:
        read_plan(path)
    assert str(caught.value).startswith(str(path))


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("a: [1", "not valid YAML at line"),
        ("- 1", "keys and values, not a list"),
        ("", "keys and values, not a NoneType"),
        (b"\xff\xfe\x00", "not text"),
    ],
)
def test_files_that_are_no_yaml_are_refused(tmp_path, text, sentence):
    path = tmp_path / "map.yaml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(PlanError, match=sentence):
        read_plan(path)


def encoded(suffix, image):
    return cv2.imencode(suffix, image)[1].tobytes()


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        pytest.param(b"", "is not an image", id="empty"),
        pytest.param(b"hello", "is not an image", id="text"),
        pytest.param(encoded(".png", picture())[:-30], "corrupt; its end is missing", id="PNG cut short"),
        pytest.param(encoded(".pgm", picture())[:-30], "corrupt; its end is missing", id="PGM cut short"),
        pytest.param(b"P5\nten 10\n255\n", "corrupt", id="PGM without size"),
        pytest.param(b"\x89PNG\r\n\x1a\n" + b"x" * 40 + b"IEND\xaeB`\x82", "is not an image", id="PNG without content"),
    ],
)
def test_images_that_are_corrupt_are_refused(tmp_path, data, sentence, capfd):
    path = save(tmp_path)
    (tmp_path / "map.pgm").write_bytes(data)
    with pytest.raises(PlanError, match=sentence):
        read_plan(path)
    assert capfd.readouterr() == ("", "")


def test_a_picture_is_bright_where_it_is_white(tmp_path):
    cv2.imwrite(str(tmp_path / "a.png"), np.array([[0, 51, 255]], np.uint8))
    brightness, opaque = read_picture(tmp_path / "a.png", "a")
    np.testing.assert_allclose(brightness, [[0, 0.2, 1.0]])
    assert opaque.all()


def mask_area(path):
    data = yaml.safe_load(path.read_text())
    image = cv2.imread(str(path.parent / data["image"]), cv2.IMREAD_GRAYSCALE)
    free = ((255 - image) / 255 < min(data["free_thresh"], 0.196)).astype(np.uint8)
    largest = cv2.connectedComponentsWithStats(free, connectivity=4)[2][1:, cv2.CC_STAT_AREA].max()
    return largest * data["resolution"] ** 2


@pytest.mark.parametrize("path", REAL, ids=lambda p: p.stem)
def test_real_maps_keep_their_area(path):
    """Nearly all of the largest connected part of the mask is there; rays and slits are what is missing."""
    plan = read_plan(path)
    assert plan.space.is_valid
    assert 0.85 * mask_area(path) < plan.area
    assert plan.repairs
