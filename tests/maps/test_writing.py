import errno
import os
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from shapely import box

from maps import PlanError, bundled_names, make_plan, read_plan, write_plan
from maps.writing import rasterise


def rooms_without_doors(plan):
    doors = shapely.buffer(shapely.MultiLineString(list(plan.doors)), 0.25, cap_style="square")
    apart = plan.space.difference(doors)
    return [part for part in shapely.get_parts(apart) if part.area > 2.0]


@pytest.mark.parametrize("name", bundled_names())
def test_bundled_plan_survives_geojson_exactly(name, tmp_path):
    plan = read_plan(name)
    (path,) = write_plan(plan, tmp_path / "copy.geojson")
    again = read_plan(path)
    assert (again.space, again.doors, again.labels, again.start) == (plan.space, plan.doors, plan.labels, plan.start)
    assert again.repairs == ()


@pytest.mark.parametrize("name", bundled_names())
def test_bundled_plan_survives_a_ros_map(name, tmp_path):
    """Walls thinner than a pixel are still walls, doors are still doors."""
    plan = read_plan(name)
    files = write_plan(plan, tmp_path / "map.yaml")
    assert [file.name for file in files] == ["map.yaml", "map.png"]
    again = read_plan(files[0])
    assert again.repairs == ()
    assert again.area == pytest.approx(plan.area, rel=0.02)
    assert len(again.parts) == 1
    cut = make_plan(again.space, name="cut", doors=plan.doors)
    assert len(rooms_without_doors(cut)) == len(rooms_without_doors(plan))


@given(
    st.lists(st.tuples(st.integers(0, 30), st.integers(0, 30)), min_size=1, max_size=6),
    st.sampled_from([0.1, 0.25, 0.5]),
)
def test_a_pixel_is_free_where_its_middle_is(corners, resolution):
    space = shapely.union_all([box(x / 7, y / 7, x / 7 + 2, y / 7 + 1.5) for x, y in corners])
    plan = make_plan(space, name="boxes")
    shape = (int(8 / resolution), int(8 / resolution))
    image = rasterise(plan, resolution, (-0.5, -0.5), shape)
    columns, rows = np.meshgrid(np.arange(shape[1]), np.arange(shape[0]))
    x, y = (columns + 0.5) * resolution - 0.5, (shape[0] - rows - 0.5) * resolution - 0.5
    free = shapely.contains_xy(plan.space, x, y)
    clear = shapely.contains_xy(shapely.buffer(plan.space, -1.5 * resolution), x, y)
    far = ~shapely.contains_xy(shapely.buffer(plan.space, 2.5 * resolution), x, y)
    assert (free[image == 254]).all()
    assert (image[clear] == 254).all()
    assert (image[far] == 205).all()


@pytest.mark.parametrize(
    ("name", "more", "sentence"),
    [
        ("plan.pdf", {}, "not written as .pdf; choose one of '.geojson'"),
        ("plan", {}, "not written as a file without suffix"),
        ("plan.yml2", {}, "did you mean '.yml'"),
        ("nowhere/plan.geojson", {}, "cannot be written \\(No such file"),
        ("nowhere/plan.yaml", {}, "cannot be written \\(No such file"),
        ("plan.yaml", {"resolution": 0.0}, "resolution is 0.0"),
        ("plan.yaml", {"resolution": float("nan")}, "resolution is nan"),
        ("plan.yaml", {"resolution": 1e-4}, "at most 40000000 are possible. Choose a coarser"),
    ],
)
def test_what_cannot_be_written_is_refused(name, more, sentence, tmp_path):
    with pytest.raises(PlanError, match=sentence):
        write_plan(read_plan("house"), tmp_path / name, **more)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["plan.geojson", "plan.yaml"])
def test_a_full_disk_leaves_what_was_there(name, tmp_path, monkeypatch):
    def full(path, content):
        with path.open("wb") as file:
            file.write(content[:10])
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    (tmp_path / name).write_text("what was there")
    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(PlanError, match=f"{name}: the file cannot be written .No space left on device"):
        write_plan(read_plan("house"), tmp_path / name)
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert (tmp_path / name).read_text() == "what was there"
