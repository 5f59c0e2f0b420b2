"""A team guided step by step does what the episode loop does, and messages may be late, missing or repeated."""

import numpy as np
import pytest

import geomsim as gs
from discretize import CellMap
from geomsim.guide import Guide, GuideError, Report
from geomsim.walking import Routes

TEAM = gs.Team(pursuers=2)


def replay(guide: Guide, episode: gs.Episode, shift: float = 0.0):
    """Tell a guide what the robots of an episode would have told; returns all new orders and the last answer."""
    given, orders = [], None
    for k, time in enumerate(episode.times):
        reports = [Report(i, time + shift, tuple(episode.pursuers[k, i])) for i in range(episode.pursuers.shape[1])]
        orders = guide.step(time + shift, reports)
        given += [(orders.time, i, next(o.path for o in orders.orders if o.robot == i)) for i in orders.new]
    return given, orders


def decisions(episode: gs.Episode):
    paths = [tuple(path.tolist()) for path in episode.decision_paths]
    return list(zip(episode.decision_times.tolist(), episode.decision_pursuers.tolist(), paths, strict=True))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("planner", [gs.Decoupled(), gs.Random(), gs.Stationary()], ids=lambda p: type(p).__name__)
@pytest.mark.parametrize("shift", [0.0, 1.7e9])
def test_guided_robots_do_what_the_episode_did(office: CellMap, seed: int, planner, shift: float) -> None:
    team = gs.Team(pursuers=2, planner=planner)
    timing = gs.Timing(limit=120.0)
    episode = gs.run_episode(office.plan, office, team, seed=seed, timing=timing)
    # the loop decides two physics steps before a robot is there
    guide = Guide(office, team, seed=seed, arrival=0.2 + 1e-6)
    given, last = replay(guide, episode, shift=shift)
    expected = decisions(episode)
    ended = episode.times[-1]
    assert [(i, path) for t, i, path in given if t < ended] == [(i, path) for t, i, path in expected if t < ended]
    assert np.allclose([t for t, *_ in given if t < ended], [t for t, *_ in expected if t < ended], atol=1e-6)
    assert last.belief == pytest.approx(episode.beliefs[-1], abs=1e-12)


def test_the_same_call_again_changes_nothing(house: CellMap) -> None:
    guide = Guide(house, TEAM)
    here = tuple(house.checkpoints[0])
    reports = [Report(0, 5.0, here), Report(1, 5.0, here)]
    first = guide.step(5.0, reports)
    again = guide.step(5.0, reports)
    assert first.new == (0, 1)
    assert again.new == ()
    assert again.orders == first.orders
    assert np.array_equal(again.belief, first.belief)


@pytest.fixture
def chase(house: CellMap) -> gs.Episode:
    timing = gs.Timing(limit=20.0)
    evader = gs.Evader(start=9, model=gs.Still())
    return gs.run_episode(house.plan, house, gs.Team(pursuers=2, start=(1,)), evader, capture="cell", timing=timing)


def silent_guide(house: CellMap, **options) -> Guide:
    return Guide(house, gs.Team(pursuers=2, start=(1,), planner=gs.Stationary()), **options)


def test_late_messages_count_as_if_in_time(house: CellMap, chase: gs.Episode) -> None:
    in_time, late = silent_guide(house), silent_guide(house)
    reports = [
        Report(i, float(chase.times[k]), tuple(chase.pursuers[k, i]))
        for k in range(0, len(chase.times), 5)
        for i in range(2)
    ]
    end = float(chase.times[-1])
    for report in reports:
        in_time.step(report.time, [report])
    late.step(0.0)
    held_back = late.step(end)
    assert held_back.belief[0] == 0  # nobody has looked so far
    shuffled = np.random.default_rng(3).permutation(len(reports))
    caught_up = late.step(end, [reports[k] for k in shuffled])
    assert caught_up.belief == pytest.approx(in_time.step(end).belief, abs=1e-15)
    assert caught_up.belief[0] > 0


def test_one_late_message_after_another(house: CellMap, chase: gs.Episode) -> None:
    one_by_one, at_once = silent_guide(house), silent_guide(house)
    end = float(chase.times[-1])
    reports = [Report(0, float(t), tuple(p[0])) for t, p in zip(chase.times[::7], chase.pursuers[::7], strict=True)]
    at_once.step(0.0)
    one_by_one.step(0.0)
    for report in reversed(reports):
        one_by_one.step(end, [report, report])
    assert at_once.step(end, reports).belief == pytest.approx(one_by_one.belief, abs=1e-15)


def test_messages_older_than_the_memory_count_for_sightings_only(house: CellMap) -> None:
    guide = silent_guide(house, memory=3.0)
    guide.step(0.0)
    before = guide.step(10.0).belief
    here = tuple(house.checkpoints[4])
    assert np.array_equal(guide.step(10.0, [Report(0, 2.0, here)]).belief, before)
    seen = guide.step(10.0, [Report(0, 2.5, here, seen=(1.0, 1.0))])
    assert np.array_equal(seen.belief, before)
    assert seen.seen is not None
    assert seen.seen.time == 2.5


def test_a_late_position_moves_nobody_back(house: CellMap) -> None:
    guide = Guide(house, gs.Team(pursuers=2, start=(1,)))
    start = tuple(house.checkpoints[0])
    first = guide.step(0.0, [Report(0, 0.0, start), Report(1, 0.0, start)])
    goal = first.orders[0]
    arrived = guide.step(10.0, [Report(0, 10.0, tuple(house.checkpoints[goal.cell]))])
    assert arrived.new == (0,)
    assert guide.step(10.1, [Report(0, 9.0, start)]).new == ()


def test_who_is_missing_has_not_looked_and_is_called_silent(house: CellMap) -> None:
    guide, alone = silent_guide(house), Guide(house, gs.Team(pursuers=1, start=(1,), planner=gs.Stationary()))
    here = tuple(house.checkpoints[0])
    for k in range(12):
        answer = guide.step(k, [Report(0, k, here)])
        assert answer.silent == ((1,) if k > 5 else ())
        assert answer.belief == pytest.approx(alone.step(k, [Report(0, k, here)]).belief, abs=1e-15)
    assert guide.step(12.0, [Report(1, 12.0, here)]).silent == ()


def test_orders_lead_through_the_door_and_are_followed(house: CellMap) -> None:
    """A robot that goes its polyline at the speed asked for is there when it is due, and told to go on."""
    guide = Guide(house, gs.Team(pursuers=1, start=(1,)))
    position, time = tuple(house.checkpoints[0]), 100.0
    for _ in range(6):
        answer = guide.step(time, [Report(0, time, position)])
        assert answer.new == (0,)
        (order,) = answer.orders
        assert order.way[0] == pytest.approx(np.array(position), abs=1e-9)
        assert order.way[-1] == pytest.approx(house.checkpoints[order.cell])
        length = float(np.hypot(*np.diff(order.way, axis=0).T).sum())
        assert order.due - order.given == pytest.approx(max(length, 1.0 if length == 0 else 0.0))
        middle = order.way[len(order.way) // 2]
        assert guide.step(order.due - 0.5, [Report(0, order.due - 0.5, tuple(middle))]).new == ()
        position, time = tuple(house.checkpoints[order.cell]), order.due


def test_who_has_gone_astray_is_sent_to_the_nearest_checkpoint(house: CellMap) -> None:
    guide = Guide(house, gs.Team(pursuers=1, start=(1,)))
    guide.step(0.0, [Report(0, 0.0, tuple(house.checkpoints[0]))])
    away = house.checkpoints[8] + (0.4, 0.3)
    answer = guide.step(3.0, [Report(0, 3.0, tuple(away))])
    assert answer.new == (0,)
    assert answer.orders[0].cell == 8
    assert answer.orders[0].way == pytest.approx(np.stack([away, house.checkpoints[8]]))
    answer = guide.step(4.0, [Report(0, 4.0, tuple(house.checkpoints[8]))])
    assert answer.orders[0].cell in Routes(house).neighbours[8]


def test_a_position_in_a_wall_is_taken_as_the_nearest_cell(house: CellMap) -> None:
    x0, y0, _, _ = house.plan.bounds
    guide = Guide(house, gs.Team(pursuers=1))
    assert guide.step(0.0, [Report(0, 0.0, (x0 - 1.0, y0 - 1.0))]).orders


def test_a_sighting_ends_the_orders(house: CellMap) -> None:
    guide = Guide(house, TEAM)
    here = tuple(house.checkpoints[0])
    answer = guide.step(0.0, [Report(0, 0.0, here), Report(1, 0.0, here, seen=(2.0, 3.0))])
    assert answer.seen == Report(1, 0.0, here, seen=(2.0, 3.0))
    assert answer.new == ()


def test_time_does_not_go_back(house: CellMap) -> None:
    guide = silent_guide(house)
    guide.step(50.0)
    assert guide.step(53.0).time == 3.0
    assert guide.step(51.0).time == 3.0
    assert guide.step(54.0).time == 4.0


@pytest.mark.parametrize(
    ("report", "sentence"),
    [
        (Report(2, 0.0, (1.0, 1.0)), "no robot 2"),
        (Report(0, 0.0, (float("nan"), 1.0)), "not finite"),
        (Report(0, 0.0, (1.0, 1.0), seen=(1.0, float("inf"))), "not finite"),
        (Report(0, 9.0, (1.0, 1.0)), "9 s in the future"),
    ],
)
def test_impossible_messages_are_refused_and_change_nothing(house: CellMap, report: Report, sentence: str) -> None:
    guide = Guide(house, TEAM)
    with pytest.raises(GuideError, match=sentence):
        guide.step(0.0, [Report(0, 0.0, tuple(house.checkpoints[0])), report])
    assert guide.step(0.0).orders == ()


@pytest.mark.parametrize("option", ["arrival", "patience", "memory", "leeway"])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
def test_impossible_options_are_refused(house: CellMap, option: str, value: float) -> None:
    with pytest.raises(GuideError, match=option):
        Guide(house, **{option: value})
