"""Readers that need the ``formats`` extra."""

import sys
from pathlib import Path

import numpy as np
import pytest
import shapely
from shapely import box

from maps import PlanError, read_plan
from maps.linework import enclosed

SHARED = Path(__file__).parents[2].parent / "shared" / "floorplans"


def kinds(plan):
    return [repair.kind for repair in plan.repairs]


def save(folder, name, text):
    (folder / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    return folder / name


# What walls enclose


def house(door=1.0):
    """Outer walls of a house of 8 m x 6 m with an entrance in the south, and a wall with a door between two rooms."""
    outer = [[(3 + door, 0), (8, 0), (8, 6), (0, 6), (0, 0), (3, 0)]]
    inner = [[(4, 6), (4, 3.9)], [(4, 3), (4, 1.5), (0, 1.5)]]
    return [shapely.LineString(line) for line in outer + inner]


@pytest.mark.parametrize(("entrance", "expected"), [(0.0, []), (1.0, ["closed entrance"]), (2.0, ["closed entrance"])])
def test_entrances_are_closed_and_inner_doors_stay_open(entrance, expected):
    parts, repairs = enclosed(house(entrance), "house")
    assert [r.kind for r in repairs] == expected
    large = [part for part in parts if part.area > 1]
    assert len(large) == 1
    assert sum(part.area for part in large) == pytest.approx(48, rel=0.03)


def test_walls_that_enclose_nothing_are_refused():
    with pytest.raises(PlanError, match="its walls enclose none"):
        enclosed([shapely.LineString([(0, 0), (8, 0), (8, 6)])], "corner")


# DXF


@pytest.fixture
def drawing():
    return pytest.importorskip("ezdxf").new(units=6)


def polyline(drawing, xy, layer, close=True):
    drawing.modelspace().add_lwpolyline(xy, close=close, dxfattribs={"layer": layer})


def corners(x0, y0, x1, y1):
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


def test_a_drawing_with_a_layer_for_walkable_space_is_read(drawing, tmp_path):
    polyline(drawing, corners(0, 0, 8, 6), "walkablearea")
    polyline(drawing, corners(1, 1, 2, 2), "jps-obstacles")
    polyline(drawing, corners(3, 3, 4, 4), "notes")
    drawing.saveas(tmp_path / "plan.dxf")
    plan = read_plan(tmp_path / "plan.dxf")
    assert plan.area == pytest.approx(47)
    assert plan.repairs == ()


def test_a_drawing_of_walls_is_read_without_doors_and_furniture(drawing, tmp_path):
    drawing.header["$INSUNITS"] = 4
    block = drawing.blocks.new("leaf")
    block.add_line((0, 0), (900, 0), dxfattribs={"layer": "0"})
    for line in house(0.0):
        polyline(drawing, [(1000 * x, 1000 * y) for x, y in line.coords], "A-WALL", close=False)
    drawing.modelspace().add_blockref("leaf", (4000, 3000), dxfattribs={"layer": "A-DOOR", "rotation": 90})
    drawing.modelspace().add_circle((6000, 3000), 500, dxfattribs={"layer": "A-FURN"})
    drawing.saveas(tmp_path / "plan.dxf")
    plan = read_plan(tmp_path / "plan.dxf")
    assert plan.area == pytest.approx(48, rel=0.03)
    assert len(plan.parts) == 1
    assert not [ring for part in plan.parts for ring in part.interiors]


def test_curves_and_blocks_are_walls_too(drawing, tmp_path):
    block = drawing.blocks.new("tower")
    block.add_circle((0, 0), 3, dxfattribs={"layer": "0"})
    drawing.modelspace().add_blockref("tower", (10, 10), dxfattribs={"layer": "walls"})
    drawing.saveas(tmp_path / "plan.dxf")
    assert read_plan(tmp_path / "plan.dxf").area == pytest.approx(np.pi * 2.99**2, rel=0.01)


def test_a_drawing_without_unit_needs_one(drawing, tmp_path):
    drawing.header["$INSUNITS"] = 0
    polyline(drawing, corners(0, 0, 800, 600), "walkable")
    drawing.saveas(tmp_path / "plan.dxf")
    with pytest.raises(PlanError, match=r"does not say its unit \(\$INSUNITS is 0\)"):
        read_plan(tmp_path / "plan.dxf")
    assert read_plan(tmp_path / "plan.dxf", units="cm").area == pytest.approx(48)
    with pytest.raises(PlanError, match="the unit 'furlong' is not known"):
        read_plan(tmp_path / "plan.dxf", units="furlong")


def test_an_empty_drawing_is_refused(drawing, tmp_path):
    drawing.saveas(tmp_path / "plan.dxf")
    with pytest.raises(PlanError, match="no lines that could be walls"):
        read_plan(tmp_path / "plan.dxf")


@pytest.mark.parametrize(
    "text", ["", "hello\nworld\n", b"\x00\xff\xfe" * 9, "  0\nSECTION\n  2\nENTITIES\n  0\nLINE\n 10\nx\n"]
)
def test_what_is_no_dxf_is_refused(text, tmp_path):
    pytest.importorskip("ezdxf")
    with pytest.raises(PlanError, match="DXF drawing"):
        read_plan(save(tmp_path, "plan.dxf", text))


# SVG

SVG = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 800 600">{}</svg>'
ROOM = '<rect id="room-1" x="10" y="20" width="500" height="400"/>'


@pytest.fixture
def needs_svg():
    pytest.importorskip("svgpathtools")
    pytest.importorskip("defusedxml")


@pytest.mark.usefixtures("needs_svg")
@pytest.mark.parametrize(
    ("content", "area"),
    [
        (ROOM, 20),
        (ROOM + '<circle class="column" cx="200" cy="200" r="50"/>', 20 - np.pi / 4),
        ('<g id="rooms"><polygon points="0,0 500,0 500,400 0,400"/></g>', 20),
        ('<path id="free" d="M0 0h500v400h-500z"/>', 20),
        ('<path id="free" d="M0 200a200 200 0 0 1 400 0a200 200 0 0 1 -400 0z"/>', np.pi * 4),
        ('<g transform="scale(2)"><path class="walk" transform="rotate(30)" d="M0 0H250V200H0Z"/></g>', 20),
        ('<g id="walls"><path d="M0 0H500V400H0Z M250 0V150"/></g><path id="door" d="M250 150V400"/>', 20),
        ('<path d="M0 0H500V400H0Z"/><text id="note">5 m</text><defs><rect width="9000" height="9"/></defs>', 20),
        (ROOM + '<rect class="obstacle" style="display: none" x="50" y="50" width="100" height="100"/>', 20),
    ],
)
def test_a_drawing_in_svg_is_read(content, area, tmp_path):
    plan = read_plan(save(tmp_path, "plan.svg", SVG.format(content)), resolution=0.01)
    assert plan.area == pytest.approx(area, rel=0.015)
    assert plan.bounds[:2] == pytest.approx((0, 0), abs=0.02)


@pytest.mark.usefixtures("needs_svg")
def test_svg_is_turned_upright(tmp_path):
    shape = '<polygon class="room" points="0,0 800,0 800,200 300,200 300,600 0,600"/>'
    plan = read_plan(save(tmp_path, "plan.svg", SVG.format(shape)), units="cm")
    assert plan.space.equals(shapely.union_all([box(0, 0, 3, 6), box(0, 4, 8, 6)]))


@pytest.mark.usefixtures("needs_svg")
@pytest.mark.parametrize(
    ("text", "options", "sentence"),
    [
        (SVG.format(ROOM), {}, "does not say its scale; give the resolution"),
        (SVG.format(""), {"resolution": 0.01}, "nothing is drawn in it"),
        (
            SVG.format('<path id="p" d="M0 0 L x"/>'),
            {"resolution": 0.01},
            "the shape 'path p' has coord|nothing is",
        ),
        (SVG.format('<rect id="r" x="a"/>'), {"resolution": 0.01}, "the shape 'rect r' has coordinates"),
        (SVG.format('<polygon points="1 2 3"/>'), {"resolution": 0.01}, "the shape 'polygon' has coordinates"),
        ("<html/>", {"resolution": 0.01}, "not SVG; its root is 'html'"),
        ("<svg", {"resolution": 0.01}, "not valid XML"),
        ('<!DOCTYPE a [<!ENTITY b "c">]><svg>&b;</svg>', {"resolution": 0.01}, "not valid XML"),
    ],
)
def test_what_is_no_plan_in_svg_is_refused(text, options, sentence, tmp_path):
    with pytest.raises(PlanError, match=sentence):
        read_plan(save(tmp_path, "plan.svg", text), **options)


# IndoorGML


def cell(name, x0, y0, x1, y1, z=0.0):
    ring = " ".join(f"{x} {y} {z}" for x, y in [*corners(x0, y0, x1, y1), (x0, y0)])
    roof = " ".join(f"{x} {y} {z + 3}" for x, y in [*corners(x0, y0, x1, y1), (x0, y0)])
    rings = "".join(f"<LinearRing><posList>{r}</posList></LinearRing>" for r in (roof, ring))
    return f"<CellSpace><name>{name}</name><Solid>{rings}</Solid></CellSpace>"


def transition(*points, z=1.0):
    return "<Transition>" + "".join(f"<pos>{x} {y} {z}</pos>" for x, y in points) + "</Transition>"


def indoor(*more):
    rooms = [cell("A", 0, 0, 4, 4), cell("B", 4.2, 0, 8, 4), cell("C", 0, 0, 4, 4, z=3.2)]
    door = [transition((2, 2), (4.1, 1), (6, 2)), transition((6, 2), (4.1, 1), (2, 2))]
    return "<IndoorFeatures>" + "".join([*rooms, *door, *more]) + "</IndoorFeatures>"


def test_a_storey_of_indoorgml_is_read(tmp_path):
    pytest.importorskip("defusedxml")
    path = save(tmp_path, "plan.gml", indoor())
    plan = read_plan(path)
    assert len(plan.parts) == 1
    assert plan.area == pytest.approx(16 + 15.2 + 0.18, abs=0.02)
    assert [door.length for door in plan.doors] == [pytest.approx(0.9)]
    assert {label.name for label in plan.labels} == {"A", "B"}
    assert kinds(plan) == ["other levels", "assumed width"]
    assert read_plan(path, level="3.2").space.equals(box(0, 0, 4, 4))
    with pytest.raises(PlanError, match=r"no level '9'; choose one of '0\.0', '3\.2'"):
        read_plan(path, level=9)


def test_cells_without_walls_between_them_get_some(tmp_path):
    pytest.importorskip("defusedxml")
    rooms = cell("A", 0, 0, 4, 4) + cell("B", 4, 0, 8, 4) + transition((2, 2), (4, 1), (6, 2))
    plan = read_plan(save(tmp_path, "plan.gml", f"<IndoorFeatures>{rooms}</IndoorFeatures>"))
    assert len(plan.parts) == 1
    assert "thickened walls" in kinds(plan)
    assert plan.area == pytest.approx(2 * 3.9**2 + 0.09, abs=0.02)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("<svg/>", "not IndoorGML; its root is 'svg'"),
        ("<IndoorFeatures>", "not valid XML"),
        ("<IndoorFeatures/>", "no room at all"),
        (indoor("<CellSpace><LinearRing><pos>1 2</pos></LinearRing></CellSpace>"), "position is not three numbers"),
        (indoor("<CellSpace><LinearRing><pos>1 2 x</pos></LinearRing></CellSpace>"), "position is not three numbers"),
    ],
)
def test_what_is_no_indoorgml_is_refused(text, sentence, tmp_path):
    pytest.importorskip("defusedxml")
    with pytest.raises(PlanError, match=sentence):
        read_plan(save(tmp_path, "plan.gml", text))


# IFC

NO_SPACE = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','',(''),(''),'','','');
FILE_SCHEMA(('IFC4'));
ENDSEC;
DATA;
ENDSEC;
END-ISO-10303-21;
"""


@pytest.mark.skipif(not SHARED.exists(), reason="needs building models")
def test_storeys_of_a_building_model_are_read():
    pytest.importorskip("ifcopenshell")
    plan = read_plan(SHARED / "ifc" / "Duplex_A.ifc")
    assert "'Level 1'" in plan.repairs[0].message
    upper = read_plan(SHARED / "ifc" / "Duplex_A.ifc", level="Level 2")
    assert len(upper.doors) == 8
    assert len(upper.parts) == 2
    with pytest.raises(PlanError, match="no level 'Level 9'; did you mean 'Level"):
        read_plan(SHARED / "ifc" / "Duplex_A.ifc", level="Level 9")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("hello", "does not begin with ISO-10303-21"),
        ("ISO-10303-21;\nnonsense", "damaged or of a schema that is not known|no IfcSpace"),
        (NO_SPACE, "no IfcSpace with a shape"),
    ],
)
def test_what_is_no_building_model_is_refused(text, sentence, tmp_path):
    pytest.importorskip("ifcopenshell")
    with pytest.raises(PlanError, match=sentence):
        read_plan(save(tmp_path, "plan.ifc", text))


@pytest.mark.parametrize(
    ("name", "module", "options"),
    [
        ("plan.dxf", "ezdxf", {}),
        ("plan.svg", "defusedxml.ElementTree", {"resolution": 1.0}),
        ("plan.ifc", "ifcopenshell", {}),
        ("plan.gml", "defusedxml.ElementTree", {}),
    ],
)
def test_without_the_extra_the_way_to_get_it_is_said(name, module, options, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(PlanError, match=r"needs the package .*pip install 'geomsim\[formats\]'"):
        read_plan(save(tmp_path, name, ""), **options)
