"""How fast trials are, as ratios within one run.

    python tests/benchmarks/trials.py [--out FILE] [--quick] [--only NAME,NAME]

Prints a table and stores it, beside this file unless told otherwise. Times are of the processor, so that other work on
the machine disturbs little; the two of a ratio are measured one after the other. The peers pyrvo and JuPedSim are
measured if they are installed.
"""

from __future__ import annotations

import argparse
import json
import math
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numba
import numpy as np
import pymunk

from discretize import CellMap, WallGrid, convex_cells
from discretize.raycast import free_line
from geomsim import Evader, Random, Sensor, Team, Timing
from geomsim.trials.bank import Bank, meet
from geomsim.trials.episodes import run_episodes
from geomsim.trials.experiment import Experiment
from geomsim.trials.methods import Method
from geomsim.trials.teamruns import TeamRun, run_team
from geomsim.walking import Routes
from maps import read_plan
from planners import AreaSpeedDegree

DT = 0.1


def experiment(cells: CellMap, trials: int, seconds: float, methods: int = 1, blind: bool = False) -> Experiment:
    """Three robots that wander; blind ones look at every step, but never notice."""
    sensor = Sensor(detection=1e-12) if blind else Sensor()
    made = Experiment(
        cells=cells,
        methods=tuple(Method(f"random {m}", Random()) for m in range(methods)),
        team=Team(pursuers=3, sensor=sensor),
        evader=Evader(),
        capture="sight",
        motion=AreaSpeedDegree(1.0),
        timing=Timing(limit=seconds),
        trials=trials,
        team_runs=1,
        seed=1,
    )
    assert made.hideouts
    return made


def spent(work: Callable[[], Any]) -> tuple[float, Any]:
    begun = time.process_time()
    result = work()
    return time.process_time() - begun, result


def share(told: Experiment, runs: list[TeamRun], steps: int) -> float:
    """Seconds for all trials of all methods with one bank, in blocks as the engine makes them."""
    everyone = range(told.trials)

    def work() -> None:
        for first in range(0, told.trials, 500):
            block = list(everyone)[first : first + 500]
            free = dict.fromkeys(range(len(runs)), block)
            meet(told, {m: [run] for m, run in enumerate(runs)}, free, steps)

    return spent(work)[0]


def stroll(routes: Routes, cell: int, rng: np.random.Generator) -> Iterator[tuple[float, float]]:
    """Where a body that wanders should be at each step."""
    way = 0.0
    while True:
        cell, last = int(rng.choice(routes.neighbours[cell])), cell
        route = routes.between(last, cell)
        points, marks, leg = route.points.tolist(), route.marks.tolist(), 0
        while way < marks[-1]:
            while marks[leg + 1] <= way:
                leg += 1
            share = (way - marks[leg]) / (marks[leg + 1] - marks[leg])
            (ax, ay), (bx, by) = points[leg], points[leg + 1]
            yield ax + share * (bx - ax), ay + share * (by - ay)
            way += DT
        way -= marks[-1]


def own_space(told: Experiment, routes: Routes, trial: int, steps: int, stop: bool) -> int:
    """One trial in a pymunk space of its own: three robots and an evader that wander, rays between them."""
    rng = np.random.default_rng(trial)
    space = pymunk.Space()
    space.collision_slop = 0.001
    wall, ray = pymunk.ShapeFilter(categories=2), pymunk.ShapeFilter(mask=2)
    for a, b in told.cells.plan.walls.tolist():
        segment = pymunk.Segment(space.static_body, tuple(a), tuple(b), 0.0)
        segment.filter = wall
        space.add(segment)
    bodies, walks = [], []
    for cell in (*told.starts, told.hideouts[trial]):
        body = pymunk.Body(1.0, float("inf"))
        body.position = tuple(told.cells.checkpoints[cell].tolist())
        disc = pymunk.Circle(body, 0.2)
        disc.filter = pymunk.ShapeFilter(categories=1, mask=2)
        space.add(body, disc)
        bodies.append(body)
        walks.append(stroll(routes, cell, rng))
    for t in range(steps):
        for body, walk in zip(bodies, walks, strict=True):
            (x, y), (px, py), (vx, vy) = next(walk), body.position, body.velocity
            ux, uy = (x - px - vx * DT) / DT, (y - py - vy * DT) / DT
            body.force = (ux - vx) / DT, (uy - vy) / DT
        space.step(DT)
        target = bodies[3].position
        seen = [space.segment_query_first(body.position, target, 0.0, ray) is None for body in bodies[:3]]
        if stop and any(seen):
            return t
    return steps


@numba.njit
def _bare(grid, eyes, lines, marks, ends, ways, count, starts, steps, dice):
    """Trials without physics: points on polylines, the next one at random, and three rays a step."""
    seen, thrown = 0, 0
    for k in range(len(starts)):
        edge = ways[starts[k], dice[thrown % len(dice)] % count[starts[k]]]
        thrown += 1
        way, leg = 0.0, 0
        for t in range(steps):
            way += 0.1
            last = marks[edge, -1]
            if way >= last:
                way -= last
                edge = ways[ends[edge], dice[thrown % len(dice)] % count[ends[edge]]]
                thrown += 1
                leg = 0
            while marks[edge, leg + 1] <= way:
                leg += 1
            share = (way - marks[edge, leg]) / (marks[edge, leg + 1] - marks[edge, leg])
            x = lines[edge, leg, 0] + share * (lines[edge, leg + 1, 0] - lines[edge, leg, 0])
            y = lines[edge, leg, 1] + share * (lines[edge, leg + 1, 1] - lines[edge, leg, 1])
            for i in range(3):
                ex, ey = eyes[t, i, 0], eyes[t, i, 1]
                if math.hypot(x - ex, y - ey) < np.inf and free_line(grid, ex, ey, x, y):
                    seen += 1
    return seen


def bare(told: Experiment, run: TeamRun, steps: int) -> float:
    """Seconds for the same trials by a compiled loop without a physics engine."""
    cells = told.cells
    routes = Routes(cells)
    pairs = [(i, j) for i, row in enumerate(routes.neighbours) for j in row]
    longest = max(len(routes.between(*pair).marks) for pair in pairs)
    lines, marks = np.zeros((len(pairs), longest, 2)), np.zeros((len(pairs), longest))
    for e, pair in enumerate(pairs):
        route = routes.between(*pair)
        lines[e], marks[e] = route.points[-1], route.marks[-1]
        lines[e, : len(route.marks)], marks[e, : len(route.marks)] = route.points, route.marks
    ways = np.zeros((len(cells), max(map(len, routes.neighbours))), dtype=np.int64)
    for e, (i, j) in enumerate(pairs):
        ways[i, routes.neighbours[i].index(j)] = e
    count = np.array([len(row) for row in routes.neighbours])
    ends, starts = np.array([j for _, j in pairs]), np.array(told.hideouts)
    grid = WallGrid.of(cells.plan.walls)
    dice = np.random.default_rng(1).integers(0, 2**31, 1_000_000)
    rest = (run.eyes, lines, marks, ends, ways, count)
    _bare(grid, *rest, starts[:2], 5, dice)
    return spent(lambda: _bare(grid, *rest, starts, steps, dice))[0]


def rvo(told: Experiment, agents: int, steps: int) -> float | None:
    """Seconds for as many agents of pyrvo among the same walls."""
    try:
        import pyrvo
    except ImportError:
        return None
    sim = pyrvo.RVOSimulator(DT, 2.0, 10, 1.0, 1.0, 0.2, 1.0)
    for part in told.cells.plan.parts:
        for ring, outer in ((part.exterior, True), *((hole, False) for hole in part.interiors)):
            points = np.array(ring.coords)[:-1]
            points = points if ring.is_ccw != outer else points[::-1]  # free space lies to the right of a wall
            sim.add_obstacle([tuple(p) for p in points.tolist()])
    sim.process_obstacles()
    rng, routes = np.random.default_rng(1), Routes(told.cells)
    places = _places(told, agents, rng)
    cells = told.cells.locate(places).tolist()
    todo: list[list[tuple[float, float]]] = []
    for place, cell in zip(places.tolist(), cells, strict=True):
        sim.add_agent(tuple(place))
        todo.append([tuple(routes.checkpoint(cell).tolist())])

    def work() -> None:
        for _ in range(steps):
            for k, corners in enumerate(todo):  # each agent heads for the next corner of its route
                at = sim.get_agent_position(k)
                dx, dy = corners[-1][0] - at.x, corners[-1][1] - at.y
                gap = math.hypot(dx, dy)
                if gap < 0.3 and len(corners) > 1:
                    corners.pop()
                elif gap < 0.3:
                    cells[k], last = int(rng.choice(routes.neighbours[cells[k]])), cells[k]
                    corners[:] = [tuple(p) for p in routes.between(last, cells[k]).points[:0:-1].tolist()]
                sim.set_agent_pref_velocity(k, (dx / max(gap, 1e-9), dy / max(gap, 1e-9)))
            sim.do_step()

    return spent(work)[0]


def jupedsim(told: Experiment, agents: int, steps: int) -> float | None:
    """Seconds for as many agents of JuPedSim among the same walls."""
    try:
        import jupedsim as jps
    except ImportError:
        return None
    space = told.cells.plan.parts[0]
    sim = jps.Simulation(model=jps.CollisionFreeSpeedModel(), geometry=space, dt=DT)
    rng = np.random.default_rng(1)
    inside = [c for c in told.cells.checkpoints if np.isfinite(c[0])]
    journeys = []
    for k in rng.choice(len(inside), 8, replace=False):
        stage = sim.add_waypoint_stage(tuple(inside[k].tolist()), 0.5)
        journeys.append((sim.add_journey(jps.JourneyDescription([stage])), stage))
    spots = jps.distribute_by_number(
        polygon=space, number_of_agents=agents, distance_to_agents=0.45, distance_to_polygon=0.25, seed=1
    )
    for k, spot in enumerate(spots):
        journey, stage = journeys[k % len(journeys)]
        sim.add_agent(
            jps.CollisionFreeSpeedModelAgentParameters(
                journey_id=journey, stage_id=stage, position=spot, desired_speed=1.0, radius=0.2
            )
        )
    return spent(lambda: sim.iterate(steps))[0]


def _places(told: Experiment, count: int, rng: np.random.Generator) -> np.ndarray:
    """Random places, no two in one."""
    import shapely

    free = told.cells.plan.space.buffer(-0.25)
    shapely.prepare(free)
    x0, y0, x1, y1 = told.cells.plan.bounds
    points = rng.uniform((x0, y0), (x1, y1), size=(400 * count, 2))
    points = points[shapely.contains_xy(free, *points.T)]
    chosen = np.unique(np.round(points / 0.5), axis=0) * 0.5
    chosen = chosen[shapely.contains_xy(told.cells.plan.space.buffer(-0.2), *chosen.T)]
    if len(chosen) < count:
        raise SystemExit(f"There is no room for {count} bodies in {told.cells.plan.name}.")
    return rng.permutation(chosen)[:count]


def looking(cells: CellMap, quick: bool) -> list[dict[str, Any]]:
    """Steps of a trial a second, three robots with sight."""
    seconds, few = (60.0, 4) if quick else (300.0, 10)
    steps = round(seconds / DT)
    told = experiment(cells, 1000, seconds, blind=True)
    share(told, run_team(told, 0, [0], 20), 20)  # compiled by now
    team, (run,) = spent(lambda: run_team(told, 0, [0], steps))
    ours = 1000 * steps / (team + share(told, [run], steps))
    routes = Routes(cells)
    alone = spent(lambda: [own_space(told, routes, k, steps, stop=False) for k in range(few)])[0]
    lone = few * steps / alone
    limit = 1000 * steps / bare(told, run, steps)
    episodes = spent(lambda: run_episodes(told, 0, list(range(2))))[0]
    return [
        row("steps of a trial with sight", ours, "one bare space for each trial", lone, 50),
        row("steps of a trial with sight", ours, "the separate engine", 2 * steps / episodes, 50),
        row("steps of a trial with sight", ours, "compiled, without physics", limit, 0.2),
    ]


def moving(cells: CellMap, quick: bool) -> list[dict[str, Any]]:
    """Steps of a body a second, against programs that move crowds."""
    steps, theirs = (300, 20) if quick else (1500, 60)
    told = experiment(cells, 1000, 300.0)
    banks = [Bank(told, range(first, first + 500)) for first in (0, 500)]  # made before, as the peers' agents are
    ours = sum(spent(lambda bank=bank: bank.reel(steps))[0] for bank in banks)
    rows = []
    for name, peer, least in (("pyrvo", rvo, 10), ("JuPedSim", jupedsim, 40)):
        took = peer(told, 1000, theirs)
        if took is not None:
            rows.append(row("steps of a body, 1000 bodies", 1000 * steps / ours, name, 1000 * theirs / took, least))
    return rows


def ten_methods(cells: CellMap, quick: bool) -> list[dict[str, Any]]:
    """Ten methods, 1000 trials, 300 s, until capture."""
    seconds, few = (60.0, 20) if quick else (300.0, 60)
    steps = round(seconds / DT)
    told = experiment(cells, 1000, seconds, methods=10)
    runs = [replace(run_team(told, m, [m], steps)[0], run=0) for m in range(10)]
    share(told, [run.cut(20, sight=True) for run in runs], 20)
    ours = 10_000 / share(told, runs, steps)
    routes = Routes(cells)
    alone = spent(lambda: [own_space(told, routes, k, steps, stop=True) for k in range(few)])[0]
    return [row("trials of ten methods", ours, "one bare space for each trial", few / alone, 30)]


def figure_5(quick: bool) -> list[dict[str, Any]]:
    """The whole of Fig. 5, planning and start-up included, by the wall clock; memory of all its processes together."""
    trials, most = 100 if quick else 1000, 0.0
    with tempfile.TemporaryDirectory() as folder:
        program = "from geomsim.cli import main; main()"
        argv = ["compare", "office", "--capture", "cell", "--trials", str(trials), "--json", "--out", f"{folder}/out"]
        begun, before = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
        with (Path(folder) / "told").open("w+") as told:
            process = subprocess.Popen([sys.executable, "-c", program, *argv], stdout=told)
            while process.poll() is None:
                most = max(most, sum(map(proportional_set, family(process.pid))))
                time.sleep(0.3)
            told.seek(0)
            methods = json.load(told)["methods"]
        wall, after = time.perf_counter() - begun, resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return [
        {
            "what": f"Fig. 5, {trials} trials, {len(methods)} methods",
            "wall_seconds": wall,
            "processor_seconds": cpu,
            "memory_of_all_processes_GiB": most / 2**20,
        }
    ]


def family(process: int) -> list[int]:
    """A process and those that it started; none where it has ended."""
    try:
        children = Path(f"/proc/{process}/task/{process}/children").read_text().split()
    except OSError:
        return []
    return [process, *(int(child) for child in children)]


def proportional_set(process: int) -> int:
    """Memory of a process, KiB, what it shares with others divided among them."""
    try:
        lines = Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()
    except OSError:
        return 0
    return sum(int(line.split()[1]) for line in lines if line.startswith("Pss:"))


def row(what: str, ours: float, peer: str, theirs: float, least: float) -> dict[str, Any]:
    return {"what": what, "ours": ours, "peer": peer, "theirs": theirs, "ratio": ours / theirs, "at_least": least}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path(__file__).with_suffix(".json"))
    parser.add_argument("--quick", action="store_true", help="shorter, rougher")
    parser.add_argument("--only", default="looking,moving,ten_methods,figure_5")
    options = parser.parse_args()
    cells = convex_cells(read_plan("office"))
    table: list[dict[str, Any]] = []
    for name in options.only.split(","):
        rows = figure_5(options.quick) if name == "figure_5" else globals()[name](cells, options.quick)
        for line in rows:
            if "ratio" in line:
                verdict = "reached" if line["ratio"] >= line["at_least"] else "MISSED"
                sys.stdout.write(
                    f"{line['what']:<30} {line['ours']:>12,.0f} a second, {line['peer']} {line['theirs']:,.0f}: "
                    f"{line['ratio']:.2f} times, at least {line['at_least']} {verdict}\n"
                )
            else:
                sys.stdout.write(f"{line}\n")
            sys.stdout.flush()
        table += rows
    options.out.write_text(json.dumps({"python": sys.version, "rows": table}, indent=1) + "\n")


if __name__ == "__main__":
    main()
