"""A made-up episode: four rooms around a hall, two robots and an evader on fixed ways."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import shapely

from discretize import CellMap, Portal
from geomsim.episode import Episode, Outcome, Status
from maps import FloorPlan

DOOR = 1.0


def four_rooms() -> CellMap:
    """Return rooms of 5 m x 4 m above and below a hall of 10.2 m x 2 m, walls of 0.2 m, doors of 1 m in the walls."""
    boxes = [
        shapely.box(0, 2.2, 5, 6.2),
        shapely.box(5.2, 2.2, 10.2, 6.2),
        shapely.box(0, -4.2, 5, -0.2),
        shapely.box(5.2, -4.2, 10.2, -0.2),
        shapely.box(0, 0, 10.2, 2),
    ]
    # The wall's thickness in a doorway belongs to the room behind it.
    doorways = [(2.5, 2.0), (7.7, 2.0), (2.5, -0.2), (7.7, -0.2)]
    cells = [b.union(shapely.box(x - 0.5, y, x + 0.5, y + 0.2)) for b, (x, y) in zip(boxes, doorways, strict=False)]
    cells.append(boxes[4])
    checkpoints = np.array([b.centroid.coords[0] for b in boxes])
    portals = []
    for room, (x, y) in enumerate(doorways):
        edge = 2.0 if y > 0 else 0.0
        inside = np.array([x, edge + (0.5 if y > 0 else -0.5)])
        hall = np.array([x, edge - (0.5 if y > 0 else -0.5)])
        point = np.array([x, edge])
        legs = (np.array([checkpoints[room], inside, point]), np.array([checkpoints[4], hall, point]))
        segment = np.array([[x - DOOR / 2, edge], [x + DOOR / 2, edge]])
        portals.append(Portal((room, 4), segment, point, legs))
    plan = FloorPlan("four rooms", shapely.union_all(cells))
    return CellMap(plan, tuple(cells), tuple(portals), checkpoints, 0.25, "by hand", ("",) * 5)


def walk(cells: CellMap, stops: list[int], times: np.ndarray) -> np.ndarray:
    """Return positions at 1 m/s along the legs from checkpoint to checkpoint."""
    legs = {p.cells[::s]: (p.legs[::s][0], p.legs[::s][1][::-1]) for p in cells.portals for s in (1, -1)}
    way = np.vstack([cells.checkpoints[stops[0]][None], *(x for a, b in pairwise(stops) for x in legs[a, b])])
    along = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(way, axis=0).T))])
    return np.stack([np.interp(times, along, way[:, k]) for k in (0, 1)], axis=1)


def made_up_episode(cells: CellMap, seconds: float = 12.0) -> Episode:
    times = np.arange(0, seconds + 1e-9, 0.1)
    robots = np.stack([walk(cells, [0, 4, 1], times), walk(cells, [2, 4, 3], times)], axis=1)
    evader = walk(cells, [1, 4, 0], times)
    moves = np.gradient(robots, axis=0)
    headings = np.arctan2(moves[..., 1], moves[..., 0])
    belief_times = np.arange(0, seconds + 1e-9, 1.0)
    rise, fall = np.linspace(0.1, 0.5, len(belief_times)), np.linspace(0.2, 0.05, len(belief_times))
    share = np.stack([rise, fall, fall, fall], axis=1)
    share = np.column_stack([share, 1 - share.sum(axis=1)])
    caught = np.linspace(0, 0.8, len(belief_times))
    last = float(times[-1])
    place = (float(evader[-1, 0]), float(evader[-1, 1]))
    return Episode(
        scenario={"capture": "sight"},
        plan=cells.plan,
        cells=cells,
        times=times,
        pursuers=robots,
        headings=headings,
        pursuer_cells=np.stack([cells.locate(robots[:, r]) for r in (0, 1)], axis=1).astype(np.int32),
        evaders=evader[:, np.newaxis],
        evaders_cells=cells.locate(evader).astype(np.int32)[:, np.newaxis],
        belief_times=belief_times,
        beliefs=np.column_stack([caught, (1 - caught)[:, None] * share]),
        own_beliefs=np.empty((len(belief_times), 0, len(cells) + 1)),
        decision_times=np.zeros(2),
        decision_pursuers=np.array([0, 1], dtype=np.int32),
        decision_paths=(np.array([4, 1], np.int32), np.array([4, 3], np.int32)),
        outcome=Outcome(Status.CAPTURED, last, 1, place, 4, 0.8),
    )


@pytest.fixture(scope="session")
def cells() -> CellMap:
    return four_rooms()


@pytest.fixture(scope="session")
def episode(cells: CellMap) -> Episode:
    return made_up_episode(cells)


@pytest.fixture(scope="session")
def shared() -> Path:
    folder = Path(__file__).parents[3] / "shared"
    if not folder.is_dir():
        pytest.skip("the sample floor plans are not beside this checkout")
    return folder
