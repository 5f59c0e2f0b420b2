"""Episodes at the edge of what there is: over at once, never captured, one robot or many, a long name."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from discretize import CellMap
from geomsim.drawing import FrameDrawer, FrameStyle, draw_cells, draw_frame
from geomsim.drawing.text import cut_text, text_width
from geomsim.episode import Episode, Outcome, Status
from geomsim.replay.page import replay_page
from geomsim.snapshots import draw_snapshots, snapshot_times, write_snapshots
from geomsim.video import write_video


def over_at_once(episode: Episode) -> Episode:
    """Return the episode as if the evader had been in sight from the start."""
    arrays = ["times", "pursuers", "headings", "pursuer_cells", "evaders", "evaders_cells", "belief_times", "beliefs"]
    first = {key: getattr(episode, key)[:1] for key in arrays}
    out = Outcome(Status.CAPTURED, 0.0, 0, tuple(episode.evader[0].tolist()), 1, 0.0)
    none = np.empty(0)
    return dataclasses.replace(
        episode,
        **first,
        decision_times=none,
        decision_pursuers=none.astype(np.int32),
        decision_paths=(),
        outcome=out,
    )


def never(episode: Episode) -> Episode:
    out = Outcome(Status.TIME_LIMIT, float(episode.times[-1]), None, None, None, 0.8)
    return dataclasses.replace(episode, outcome=out)


def alone(episode: Episode) -> Episode:
    return dataclasses.replace(
        episode,
        pursuers=episode.pursuers[:, :1],
        headings=episode.headings[:, :1],
        pursuer_cells=episode.pursuer_cells[:, :1],
        decision_times=episode.decision_times[:1],
        decision_pursuers=episode.decision_pursuers[:1],
        decision_paths=episode.decision_paths[:1],
        outcome=dataclasses.replace(episode.outcome, pursuer=0),
    )


def crowd(episode: Episode) -> Episode:
    """Return twelve robots, more than there are colours, and two digits on some."""
    return dataclasses.replace(
        episode,
        pursuers=np.tile(episode.pursuers, (1, 6, 1)) + np.linspace(0, 0.5, 12)[:, None],
        headings=np.tile(episode.headings, (1, 6)),
        pursuer_cells=np.tile(episode.pursuer_cells, (1, 6)),
    )


def sure(episode: Episode) -> Episode:
    """Return a belief that is certain of the capture: nothing is left to share among cells."""
    beliefs = episode.beliefs.copy()
    beliefs[5:] = 0.0
    beliefs[5:, 0] = 1.0
    return dataclasses.replace(episode, beliefs=beliefs)


def long_named(episode: Episode) -> Episode:
    plan = dataclasses.replace(episode.plan, name="a building whose name goes on " * 10)
    return dataclasses.replace(episode, plan=plan)


@pytest.mark.parametrize("change", [over_at_once, never, alone, crowd, sure, long_named])
def test_everything_can_be_drawn(episode: Episode, tmp_path: Path, change: object) -> None:
    changed = change(episode)
    drawer = FrameDrawer(changed, FrameStyle(size=(640, 360)))
    for time in (-1.0, 0.0, 6.0, 12.0, 99.0):
        assert drawer.draw(time).std() > 10
    assert draw_snapshots(changed, width=700).std() > 10
    assert write_snapshots(changed, tmp_path / "s.svg", panels=2).stat().st_size > 1000
    assert write_video(changed, tmp_path / "v.mp4", size=(320, 240), fps=5).stat().st_size > 1000
    assert len(replay_page(changed)) > 1000


def test_a_pursuit_that_is_over_at_once_has_one_panel(episode: Episode) -> None:
    assert snapshot_times(over_at_once(episode), None, 6) == [0.0]


def test_times_outside_the_episode_show_its_ends(episode: Episode) -> None:
    assert np.array_equal(draw_frame(episode, -5.0), draw_frame(episode, 0.0))
    assert np.array_equal(draw_frame(episode, 500.0), draw_frame(episode, 12.0))


def test_a_cell_that_no_body_can_enter_is_drawn_grey(cells: CellMap) -> None:
    checkpoints = cells.checkpoints.copy()
    checkpoints[1] = np.nan
    shut = dataclasses.replace(cells, checkpoints=checkpoints, portals=cells.portals[:1] + cells.portals[2:])
    image = draw_cells(shut, width=800).astype(int)
    room = image[100:140, 700:740].reshape(-1, 3)
    assert np.ptp(room.mean(axis=0)) < 3
    assert np.ptp(draw_cells(cells, width=800)[100:140, 700:740].reshape(-1, 3).mean(axis=0)) > 10


@pytest.mark.parametrize("width", [0, 40, 100, 1000])
def test_text_is_cut_to_its_room(width: int) -> None:
    cut = cut_text("a rather long name", width, 16)
    assert cut == "..." or text_width(cut, 16) <= width
    assert (cut == "a rather long name") == (text_width("a rather long name", 16) <= width)
