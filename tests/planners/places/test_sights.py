"""Which places are in sight, and how that is kept on disk."""

from pathlib import Path

import numpy as np
import pytest
import shapely

from discretize import CellMap, WallGrid, convex_cells
from discretize.raycast import seen_pairs
from maps import FloorPlan, read_plan
from planners import LineOfSight, Roads, SearchGraph
from planners.places import Places, cache_folder, sight_of_places
from planners.places.keeping import sight_among


@pytest.fixture(scope="module")
def house() -> CellMap:
    return convex_cells(read_plan("house"))


@pytest.fixture
def folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    monkeypatch.setenv("GEOMSIM_CACHE", str(tmp_path / "kept"))
    return tmp_path / "kept"


@pytest.mark.parametrize("reach", [np.inf, 3.0])
def test_a_place_is_seen_where_no_wall_is_between(house: CellMap, folder: Path, reach: float) -> None:
    roads = Roads.of(house)
    places = Places.of(roads, 0.8)
    sights = sight_of_places(house, roads, places, 1.0, reach)
    shape = (len(sights.places), len(places))
    expected = np.zeros(shape, dtype=bool)
    eye, place = np.indices(shape).reshape(2, -1)
    a, b = sights.places[eye], places.points[place]
    near = np.hypot(*(b - a).T) <= reach
    expected[eye, place] = seen_pairs(WallGrid.of(house.plan.walls), a, b) & near
    found = np.zeros(shape, dtype=bool)
    found[sights.station, sights.part] = True
    # a place and a station at the same spot are laid out to a micrometre, which a wall's end may part
    assert (found != expected).mean() < 2e-4
    assert (np.diff(sights.station) >= 0).all()


def test_stations_stand_where_robots_are_after_each_step(house: CellMap, folder: Path) -> None:
    roads, graph = Roads.of(house), SearchGraph.from_cells(house)
    sights = sight_of_places(house, roads, Places.of(roads, 1.0), 1.0)
    capture = LineOfSight(sights)
    for edge in range(len(graph.indices)):
        steps = max(1, round(graph.length[edge]))
        way = graph.length[edge] * np.arange(1, steps + 1) / steps
        views = capture.viewpoints(graph, edge, way)
        line = shapely.LineString(roads.lines[edge])
        at = shapely.get_coordinates([line.interpolate(w) for w in way])
        assert np.allclose(sights.places[views], at, atol=1e-6)


def test_a_pillar_hides(folder: Path) -> None:
    cells = convex_cells(FloorPlan("pillar", shapely.box(0, 0, 12, 12).difference(shapely.box(4, 4, 8, 8))))
    roads = Roads.of(cells)
    places = Places.of(roads, 1.0)
    table = LineOfSight(sight_of_places(cells, roads, places, 1.0)).table(roads.graph).toarray()
    for k, point in enumerate(places.points):
        hidden = shapely.LineString([cells.checkpoints[0], point]).crosses(shapely.box(4.01, 4.01, 7.99, 7.99))
        assert not (hidden and table[0, k])
    assert 0 < table[0].sum() < len(places)


def test_an_entry_is_kept_and_read(folder: Path, monkeypatch: pytest.MonkeyPatch, house: CellMap) -> None:
    walls, points = house.plan.walls, house.checkpoints
    first = sight_among(walls, points, points, np.inf)
    assert [path.suffix for path in folder.iterdir()] == [".npz"]
    monkeypatch.setattr("discretize.raycast.seen_among", lambda *_: pytest.fail("found anew"))
    again = sight_among(walls, points, points, np.inf)
    assert all(np.array_equal(a, b) for a, b in zip(first, again, strict=True))


@pytest.mark.parametrize("change", ["walls", "eyes", "targets", "reach"])
def test_an_entry_serves_nothing_else(folder: Path, house: CellMap, change: str) -> None:
    given = {"walls": house.plan.walls, "eyes": house.checkpoints, "targets": house.checkpoints, "reach": 5.0}
    sight_among(**given)
    moved = {key: value + 1e-3 if key == change else value for key, value in given.items()}
    sight_among(**moved)
    assert len(list(folder.iterdir())) == 2


@pytest.mark.parametrize("damage", ["cut off", "empty", "no archive", "other numbers", "bits"])
def test_a_damaged_entry_is_made_anew(folder: Path, house: CellMap, damage: str) -> None:
    given = (house.plan.walls, house.checkpoints, house.checkpoints, np.inf)
    expected = sight_among(*given)
    path = next(folder.iterdir())
    data = path.read_bytes()
    if damage == "other numbers":
        np.savez(path, indptr=expected[0], indices=expected[1] + 1000)
    elif damage == "bits":
        path.write_bytes(data[:400] + bytes(b ^ 0xFF for b in data[400:500]) + data[500:])
    else:
        path.write_bytes({"cut off": data[: len(data) // 2], "empty": b"", "no archive": b"words"}[damage])
    found = sight_among(*given)
    assert all(np.array_equal(a, b) for a, b in zip(found, expected, strict=True))
    assert path.read_bytes() == data


def test_a_folder_that_cannot_be_only_costs_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, house: CellMap
) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("GEOMSIM_CACHE", str(tmp_path / "file" / "below"))
    indptr, _ = sight_among(house.plan.walls, house.checkpoints, house.checkpoints, np.inf)
    assert len(indptr) == len(house) + 1


@pytest.mark.parametrize(
    ("platform", "variable", "rest"),
    [
        ("linux", "XDG_CACHE_HOME", "geomsim"),
        ("win32", "LOCALAPPDATA", "geomsim/Cache"),
    ],
)
def test_the_folder_is_the_systems(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, platform: str, variable: str, rest: str
) -> None:
    monkeypatch.delenv("GEOMSIM_CACHE", raising=False)
    monkeypatch.setattr("sys.platform", platform)
    monkeypatch.setenv(variable, str(tmp_path))
    assert cache_folder() == tmp_path / rest
