"""What users bring of their own: found by name, checked, and refused with a sentence where it cannot work."""

import json
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import shapely

import geomsim as gs
import geomsim.evaders
import planners.costs
import planners.registry
from discretize import CellMap
from geomsim.cli import main
from geomsim.evaders import EVADERS
from geomsim.plugins import PluginError, load_plugins
from geomsim.scenario import read_scenario
from maps import FORMATS, ConformanceError, GeomsimError, PlanError, make_plan, read_plan
from planners import COSTS, PLANNERS, Hops, find_cost, make_planner

TABLES = (planners.costs._COSTS, planners.registry._PLANNERS, geomsim.evaders._EVADERS)


@pytest.fixture(autouse=True)
def restored() -> Iterator[None]:
    """Take out again what a test registers."""
    kept, formats, modules = [dict(table) for table in TABLES], list(FORMATS), set(sys.modules)
    yield
    for table, before in zip(TABLES, kept, strict=True):
        table.clear()
        table.update(before)
    FORMATS[:] = formats
    for name in set(sys.modules) - modules:
        if getattr(sys.modules[name], "__file__", "") and "idea" in name:
            del sys.modules[name]


@dataclass(frozen=True)
class Wait:
    """Waits."""

    depth: int = 2

    def solve(self, problem, rng):
        return make_planner("stationary").solve(problem, rng)


def test_what_is_registered_is_found_by_name() -> None:
    gs.register_cost("own-cost")(lambda hops: hops.distance)
    assert find_cost("own-cost") is COSTS["own-cost"]
    gs.register_planner("wait")(Wait)
    assert make_planner("wait", depth=3) == Wait(3)
    assert PLANNERS["wait"].summary == "Waits."
    gs.register_evader("own-evader")(gs.Still)
    assert read_scenario(None, {"evader": "own-evader", "planner": "wait"}).quarry().model == gs.Still()


@pytest.mark.parametrize("name", ["entropy", "", "Big", "two words", "-x", "x-", "a--b", "../x"])
@pytest.mark.parametrize("register", [gs.register_cost, gs.register_planner, gs.register_evader])
def test_names_that_are_none_or_taken_are_refused(register, name: str) -> None:
    gs.register_planner("entropy")(Wait)
    gs.register_evader("entropy")(gs.Still)
    with pytest.raises(GeomsimError, match=r"already|cannot be called"):
        register(name)(Wait)


def test_a_planner_without_fields_is_refused() -> None:
    with pytest.raises(GeomsimError, match="must be a dataclass"):
        gs.register_planner("odd")(lambda: None)


def read_square(path: Path):
    side = float(path.read_text())
    return make_plan(shapely.box(0, 0, side, side), name="square", source=str(path))


def test_a_format_is_read_everywhere(tmp_path: Path) -> None:
    (tmp_path / "a.square").write_text("4")
    with pytest.raises(PlanError, match="cannot be read"):
        read_plan(tmp_path / "a.square")
    gs.register_format(gs.Format("square", (".square",), read_square))
    assert read_plan(tmp_path / "a.square").area == pytest.approx(16)


@pytest.mark.parametrize(
    ("kind", "sentence"),
    [
        (gs.Format("GeoJSON", (".x",), read_square), "already"),
        (gs.Format("square", ("square",), read_square), "with a dot"),
        (gs.Format("square", (".SQ",), read_square), "small letters"),
        (gs.Format("square", (), read_square), "needs a suffix"),
        (gs.Format("square", (".json",), read_square), "needs a sign"),
    ],
)
def test_formats_that_cannot_be_told_are_refused(kind: gs.Format, sentence: str) -> None:
    with pytest.raises(PlanError, match=sentence):
        gs.register_format(kind)


def test_a_known_suffix_with_a_sign_is_told_by_its_content(tmp_path: Path) -> None:
    gs.register_format(gs.Format("square", (".json",), read_square, sign=rb"^\d+$"))
    (tmp_path / "a.json").write_text("3")
    assert read_plan(tmp_path / "a.json").area == pytest.approx(9)


# --- the checks ---


@pytest.mark.parametrize("name", list(COSTS))
def test_our_heuristics_conform(name: str) -> None:
    gs.check_cost(COSTS[name], np.random.default_rng(0))


@pytest.mark.parametrize("name", list(EVADERS))
def test_our_evaders_conform(name: str, office: CellMap) -> None:
    gs.check_evader(EVADERS[name](), office, np.random.default_rng(0))


def test_our_readers_conform(tmp_path: Path, house: CellMap) -> None:
    readers = {kind.name: kind for kind in FORMATS}
    gs.write_plan(house.plan, tmp_path / "house.geojson")
    gs.write_plan(house.plan, tmp_path / "house.yaml")
    (tmp_path / "house.wkt").write_text(house.plan.space.wkt)
    (tmp_path / "a.map").write_text("type octile\nheight 4\nwidth 4\nmap\n@@@@\n@..@\n@..@\n@@@@\n")
    rng = np.random.default_rng(0)
    gs.check_format(readers["GeoJSON"], tmp_path / "house.geojson", rng)
    gs.check_format(readers["ROS map"], tmp_path / "house.yaml", rng)
    gs.check_format(readers["picture"], tmp_path / "house.png", rng, resolution=0.05)
    gs.check_format(readers["well-known text"], tmp_path / "house.wkt", rng)
    gs.check_format(readers["Moving AI map"], tmp_path / "a.map", rng, resolution=1.0)


def spoils(hops: Hops):
    hops.before[:] = 0
    return hops.distance


@pytest.mark.parametrize(
    ("cost", "sentence"),
    [
        (lambda hops: hops.distance.sum(), "shape"),
        (lambda hops: -hops.distance, "not below 0"),
        (lambda hops: hops.distance / 0.0 if len(hops.distance) else hops.distance, "finite"),
        (lambda hops: hops.distance - hops.distance.min(), "in a batch"),
        (spoils, "changes the hops"),
    ],
)
def test_heuristics_that_break_a_rule_are_told(cost, sentence: str) -> None:
    with np.errstate(all="ignore"), pytest.raises(ConformanceError, match=sentence):
        gs.check_cost(cost, np.random.default_rng(0))


class Stops:
    def walk(self, routes, cell, rng, lookout):
        yield routes.stay(cell, 1.0)


class Jumps:
    def walk(self, routes, cell, rng, lookout):
        while True:
            yield routes.between(0, routes.neighbours[0][0])


class Freezes:
    def walk(self, routes, cell, rng, lookout):
        while True:
            yield routes.stay(cell, 0.0)


class Forgets:
    chance = np.random.default_rng(8)

    def walk(self, routes, cell, rng, lookout):
        while True:
            to = int(self.chance.choice(routes.neighbours[cell]))
            yield routes.between(cell, to)
            cell = to


@pytest.mark.parametrize(
    ("model", "sentence"),
    [
        (Stops(), "must go on"),
        (Jumps(), "but it is in"),
        (Freezes(), "must be above 0"),
        (Forgets(), "from an equal seed"),
    ],
)
def test_evaders_that_break_a_rule_are_told(model, sentence: str, office: CellMap) -> None:
    with pytest.raises(ConformanceError, match=sentence):
        gs.check_evader(model, office, np.random.default_rng(0))


def test_readers_that_break_a_rule_are_told(tmp_path: Path) -> None:
    (tmp_path / "a.square").write_text("4.25")
    rng = np.random.default_rng(0)
    with pytest.raises(ConformanceError, match="ValueError of an empty file"):
        gs.check_format(gs.Format("square", (".square",), read_square), tmp_path / "a.square", rng)
    with pytest.raises(ConformanceError, match="returns a str"):
        gs.check_format(gs.Format("text", (".x",), Path.read_text), tmp_path / "a.square", rng)


# --- the command line ---

IDEA = """
import geomsim as gs
from dataclasses import dataclass
from planners import make_planner

@gs.register_planner("own-idea")
@dataclass
class OwnIdea:
    def solve(self, problem, rng):
        return make_planner("random").solve(problem, rng)
"""


def call(*arguments: str) -> int:
    with pytest.raises(SystemExit) as stop:
        main(list(arguments))
    return stop.value.code


def test_a_file_is_a_plugin_of_every_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "own_idea.py").write_text(IDEA)
    for arguments in (
        ["planners", "--plugin", str(tmp_path / "own_idea.py")],
        [f"--plugin={tmp_path}/own_idea.py", "planners"],
    ):
        assert call(*arguments, "--json") == 0
        assert "own-idea" in [p["name"] for p in json.loads(capsys.readouterr().out)["planners"]]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("1 / 0", "cannot be imported: ZeroDivisionError"),
        ("import this_is_nowhere", "ModuleNotFoundError"),
        ("def", "SyntaxError"),
        ("import geomsim as gs; gs.register_cost('entropy')(print)", "'entropy' already"),
        (None, "There is no plugin"),
    ],
)
def test_a_plugin_that_fails_is_told(tmp_path: Path, capsys, text: str | None, sentence: str) -> None:
    if text is not None:
        (tmp_path / "bad_idea.py").write_text(text)
    assert call("planners", "--plugin", str(tmp_path / "bad_idea.py")) == 2
    err = capsys.readouterr().err
    assert sentence in err
    assert err.count("\n") == 1


def test_a_plugin_without_a_name_is_refused(capsys) -> None:
    assert call("planners", "--plugin") == 2
    assert "got none" in capsys.readouterr().err


def test_a_plugin_of_another_modules_name_is_refused(tmp_path: Path) -> None:
    (tmp_path / "json.py").write_text(IDEA)
    with pytest.raises(PluginError, match="rename the file"):
        load_plugins([str(tmp_path / "json.py")], installed=False)


def test_an_installed_package_is_found_by_its_entry_point(tmp_path: Path) -> None:
    (tmp_path / "own_idea.py").write_text(IDEA)
    about = tmp_path / "own_idea-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: own-idea\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text("[geomsim.plugins]\nidea = own_idea\n")
    path = ":".join([str(tmp_path), *(p for p in sys.path if p)])
    done = subprocess.run(
        [sys.executable, "-c", "from geomsim.cli import main; main()", "planners", "--json"],
        capture_output=True,
        text=True,
        check=True,
        env={"PYTHONPATH": path, "PATH": "/usr/bin:/bin"},
    )
    assert "own-idea" in [p["name"] for p in json.loads(done.stdout)["planners"]]
