from itertools import combinations

import numpy as np
import pytest
import shapely

from maps import Door, PlanError, Room, draft_plan, draft_rooms, read_plan
from maps.drafts import DRAFTS, write_drafts
from maps.reading import bundled_names

HOUSE = {(1, 4), (1, 8), (2, 8), (2, 9), (3, 4), (4, 5), (4, 6), (4, 9), (5, 7), (6, 7)}


def touching(cells, segments):
    """Pairs of cells, by number, that share a segment; and whether all they share is door segments."""
    pairs = set()
    for (a, p), (b, q) in combinations(cells.items(), 2):
        shared = p.intersection(q)
        if shared.length > 0:
            pairs.add((min(a, b), max(a, b)))
            assert any(shared.equals(s) for s in segments), (a, b, shared)
        assert shared.area == 0
    return pairs


def turns(ring):
    """Cross products at the corners of a ring, in square millimetres, exactly."""
    xy = np.round(np.array(ring.coords[:-1]) * 1000).astype(np.int64)
    a, b = xy - np.roll(xy, 1, axis=0), np.roll(xy, -1, axis=0) - xy
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


@pytest.fixture(params=sorted(DRAFTS))
def sketch(request, monkeypatch):
    """The rooms and doors of a bundled sketch, and its plan."""
    taken = {}

    def record(rooms, doors, *, wall=0.03):
        taken["rooms"], taken["doors"] = rooms, doors
        taken["cells"], taken["segments"] = draft_rooms(rooms, doors, wall=wall)
        return taken["cells"], taken["segments"]

    monkeypatch.setattr("maps.drafting.draft_rooms", record)
    taken["plan"] = DRAFTS[request.param]()
    return taken


def test_every_room_is_exactly_convex(sketch):
    for number, cell in sketch["cells"].items():
        turn = turns(shapely.orient_polygons(cell).exterior)
        assert (turn > 0).all(), number
        assert not cell.interiors


def test_rooms_touch_exactly_along_their_doors(sketch):
    wanted = {tuple(sorted(door.rooms)) for door in sketch["doors"]}
    assert touching(sketch["cells"], sketch["segments"]) == wanted


def test_plan_is_the_union_of_its_rooms(sketch):
    plan, cells = sketch["plan"], list(sketch["cells"].values())
    assert isinstance(plan.space, shapely.Polygon)
    assert plan.repairs == ()
    assert plan.area == pytest.approx(sum(c.area for c in cells), abs=1e-6)
    assert plan.space.symmetric_difference(shapely.union_all(cells)).area < 1e-6
    assert {label.number for label in plan.labels} == set(sketch["cells"])
    assert all(sketch["cells"][label.number].contains(shapely.Point(label.point)) for label in plan.labels)
    assert plan.start
    assert set(plan.start) <= set(sketch["cells"])


def test_house_has_the_graph_of_the_paper(monkeypatch):
    doors = []
    monkeypatch.setattr("maps.drafts.house.draft_plan", lambda *args, **_: doors.extend(args[2]))
    DRAFTS["house"]()
    assert {tuple(sorted(d.rooms)) for d in doors} == HOUSE
    assert all(0.9 <= d.width <= 1.0 for d in doors)


def test_drafts_are_the_files_that_are_shipped(tmp_path):
    from importlib import resources

    shipped = resources.files("maps") / "bundled"
    written = write_drafts(tmp_path)
    assert {p.stem for p in written} <= set(bundled_names())
    for path in written:
        assert path.read_bytes() == (shipped / path.name).read_bytes()


@pytest.mark.parametrize("name", sorted(DRAFTS))
def test_bundled_plan_reads_as_it_was_drawn(name):
    assert read_plan(name) == DRAFTS[name]()


def test_slanted_rooms_touch_along_their_door():
    rooms = [
        Room(1, "", ((0, 0), (3, 0), (4.7, 5.1), (0, 4))),
        Room(2, "", ((3, 0), (8, 1), (4.7, 5.1))),
    ]
    cells, segments = draft_rooms(rooms, [Door((1, 2))])
    assert touching(cells, segments) == {(1, 2)}


BOX = Room(1, "", ((0, 0), (4, 4)))


@pytest.mark.parametrize(
    ("rooms", "doors", "sentence"),
    [
        ([BOX, Room(3, "", ((4, 0), (8, 4)))], [], "must be 1 to 2, each once"),
        ([Room(1, "", ((0, 0), (4, 0), (1, 1), (0, 4)))], [], "Room 1 is not convex"),
        ([BOX, Room(2, "", ((3, 0), (8, 4)))], [], "Rooms 1 and 2 overlap"),
        ([BOX, Room(2, "", ((4, 3.2), (8, 8)))], [Door((1, 2))], "share 0.8 m of wall, too little for a door of 0.9 m"),
        ([BOX, Room(2, "", ((5, 0), (8, 4)))], [Door((1, 2))], "share 0 m of wall"),
    ],
)
def test_a_sketch_that_cannot_be_built_is_refused(rooms, doors, sentence):
    with pytest.raises(PlanError, match=sentence):
        draft_plan("sketch", rooms, doors)
