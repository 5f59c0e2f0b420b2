"""What other programs read: waypoints, the YAML of Nav2, a ROS map, GeoJSON, GraphML."""

import csv
import io
import json
import math
from dataclasses import replace
from pathlib import Path

import networkx as nx
import numpy as np
import pytest
import shapely
import yaml

import geomsim as gs
from discretize import CellMap
from geomsim.graphml import graphml_text
from geomsim.waypoints import nav2_text, plan_waypoints, record_waypoints, waypoints_text
from maps import read_plan
from planners import SearchGraph

TEAM = gs.Team(pursuers=2)


@pytest.mark.parametrize("seed", [3, 4])
def test_waypoints_are_where_the_robots_were(office: CellMap, seed: int) -> None:
    episode = gs.run_episode(office.plan, office, TEAM, seed=seed, timing=gs.Timing(limit=90.0))
    for who, row in enumerate(record_waypoints(episode)):
        times = np.array([w.time for w in row])
        assert (np.diff(times) > 0).all()
        known = episode.times <= times[-1]
        for axis, name in enumerate("xy"):
            meant = np.interp(episode.times, times, [getattr(w, name) for w in row])
            assert np.abs(meant - episode.pursuers[:, who, axis])[known].max() < 1e-9
        cells = office.locate(np.array([[w.x, w.y] for w in row]))
        assert all(w.cell == cell for w, cell in zip(row, cells, strict=True) if w.checkpoint)


@pytest.mark.parametrize("planner", [gs.Decoupled(), gs.Random(), gs.Stationary()], ids=lambda p: type(p).__name__)
def test_a_plan_is_what_every_pursuit_of_its_seed_does(office: CellMap, planner) -> None:
    team = gs.Team(pursuers=2, planner=planner)
    planned = plan_waypoints(office, team, duration=60.0, seed=5)
    episode = gs.run_episode(office.plan, office, team, seed=5, timing=gs.Timing(limit=60.0))
    for meant, done in zip(planned, record_waypoints(episode), strict=True):
        assert meant[: len(done) - 1] == done[:-1]  # the heading of the last depends on what comes after
        assert 40.0 < meant[-1].time <= 60.0


def test_csv_counts_from_one(house: CellMap) -> None:
    rows = plan_waypoints(house, TEAM, duration=20.0)
    table = list(csv.DictReader(io.StringIO(waypoints_text(rows))))
    assert len(table) == sum(map(len, rows))
    assert {line["robot"] for line in table} == {"1", "2"}
    first, told = rows[0][0], table[0]
    assert (int(told["cell"]), float(told["x"])) == (first.cell + 1, pytest.approx(first.x, abs=1e-3))
    assert {line["kind"] for line in table} == {"checkpoint", "way"}


def load_as_nav2_does(text: str) -> list[tuple[float, float, float]]:
    """Poses (x, y, yaw) as the panel makes them: pose is x y z, orientation w x y z."""
    poses = []
    for name, waypoint in yaml.safe_load(text)["waypoints"].items():
        assert isinstance(name, str)
        x, y, z = (float(value) for value in waypoint["pose"])
        w, qx, qy, qz = (float(value) for value in waypoint["orientation"])
        assert z == qx == qy == 0
        assert math.hypot(w, qz) == pytest.approx(1, abs=1e-5)
        poses.append((x, y, 2 * math.atan2(qz, w)))
    return poses


@pytest.mark.parametrize("checkpoints_only", [True, False])
def test_nav2_is_given_the_places_in_order(house: CellMap, checkpoints_only: bool) -> None:
    (row,) = plan_waypoints(house, gs.Team(pursuers=1), duration=40.0)
    wanted = [w for w in row if w.checkpoint or not checkpoints_only]
    poses = load_as_nav2_does(nav2_text(row, checkpoints_only=checkpoints_only))
    assert len(poses) == len(wanted) > 5
    for (x, y, yaw), w in zip(poses, wanted, strict=True):
        assert (x, y) == pytest.approx((w.x, w.y), abs=1e-4)
        assert math.remainder(yaw - w.heading, math.tau) == pytest.approx(0, abs=1e-4)


def test_a_robot_that_stays_has_one_waypoint_for_nav2(house: CellMap) -> None:
    (row,) = plan_waypoints(house, gs.Team(pursuers=1, planner=gs.Stationary()), duration=10.0)
    assert len(row) > 5
    assert len(load_as_nav2_does(nav2_text(row))) == 1


@pytest.mark.parametrize("name", ["house", "office", "museum"])
@pytest.mark.parametrize("pixel", [0.02, 0.05])
def test_a_ros_map_read_back_is_the_same_within_a_pixel(name: str, pixel: float, tmp_path: Path) -> None:
    plan = read_plan(name)
    gs.write_plan(plan, tmp_path / "map.yaml", resolution=pixel)
    again = read_plan(tmp_path / "map.yaml")
    assert shapely.hausdorff_distance(plan.space.boundary, again.space.boundary, densify=0.1) < math.sqrt(2) * pixel
    # what one of them has and the other lacks is nowhere thicker than a pixel on each side of a wall
    assert plan.space.symmetric_difference(again.space).buffer(-pixel).area < 1e-6


@pytest.mark.parametrize("name", ["house", "museum"])
def test_networkx_reads_the_same_graph(name: str) -> None:
    cells = gs.convex_cells(gs.load_plan(name))
    graph = nx.parse_graphml(graphml_text(cells), node_type=int)
    assert {tuple(sorted(edge)) for edge in graph.edges} == {(i + 1, j + 1) for i, j in cells.edges}
    ours = SearchGraph.from_cells(cells)
    for i, j, length in graph.edges(data="length"):
        assert length == pytest.approx(ours.length[ours.edge(i - 1, j - 1)])
    for number, data in graph.nodes(data=True):
        assert (data["x"], data["y"]) == pytest.approx(tuple(cells.checkpoints[number - 1]))
        assert data["area"] == pytest.approx(cells.areas[number - 1])
        assert data["name"] == cells.names[number - 1]


def test_names_that_xml_cannot_hold_are_written_without_what_it_cannot(house: CellMap) -> None:
    names = ("a\0b", "<&>\x1b", *house.names[2:])
    graph = nx.parse_graphml(graphml_text(replace(house, names=names)), node_type=int)
    assert [graph.nodes[k]["name"] for k in (1, 2)] == ["ab", "<&>"]


def test_a_cell_that_no_robot_can_enter_has_no_place(house: CellMap) -> None:
    checkpoints = house.checkpoints.copy()
    checkpoints[4] = np.nan
    graph = nx.parse_graphml(graphml_text(replace(house, checkpoints=checkpoints)), node_type=int)
    assert "x" not in graph.nodes[5]
    assert "x" in graph.nodes[4]


def test_export_of_a_plan_and_of_a_record(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from geomsim.cli import main

    def call(*arguments: str) -> dict:
        with pytest.raises(SystemExit) as stop:
            main([*arguments, "--json"])
        out, err = capsys.readouterr()
        assert (stop.value.code, err) == (0, "")
        return json.loads(out)

    kinds = {"waypoints", "robot 1", "robot 2", "map", "image", "cells", "graph"}
    told = call("export", "house", "--duration", "30", "--out", str(tmp_path / "plan"))
    assert set(told["files"]) == kinds
    assert all(Path(path).stat().st_size > 100 for path in told["files"].values())
    run = call("run", "house", "--no-video", "--no-replay", "--no-snapshots", "--out", str(tmp_path / "run"))
    told = call("export", run["files"]["record"])
    assert set(told["files"]) == kinds
    assert {Path(path).parent for path in told["files"].values()} == {tmp_path / "run"}
