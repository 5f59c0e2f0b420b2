"""How good and how fast the planners are: prints a table and stores it.

Run from the project's root::

    python tests/benchmarks/planning.py [--graphs FOLDER] [--every K] [--out FILE]

``--graphs`` is a folder with ``office-60.json`` and ``museum-70.json``; ``--every K`` takes every K-th start only.
Expected times are exact, in the cell model; times of plans are medians of this run on this machine, so compare them
with each other only.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from planners import (
    AreaSpeedDegree,
    Beam,
    BestResponse,
    BranchAndBound,
    Decoupled,
    Planner,
    PursuerState,
    Random,
    Rollout,
    SameCell,
    SearchGraph,
    SearchProblem,
    SearchState,
    Sequential,
    Stationary,
    advance,
    lower_bounds,
    predict,
    read_edge_list,
    uniform_belief,
    unit_problem,
)
from planners.beam import BeamSearch
from planners.branching import JointSearch
from planners.horizon import respond
from planners.simulation import SearchModel

Row = dict[str, Any]


def timed(call: Callable[[], Any], times: int) -> float:
    """Return the median time of a call after one that does not count, milliseconds."""
    call()
    spent = []
    for _ in range(times):
        begun = time.perf_counter()
        call()
        spent.append(time.perf_counter() - begun)
    return 1e3 * float(np.median(spent))


def expected_times(graphs: Path, every: int) -> Iterable[Row]:
    """Yield mean expected times over common starts of two searchers on the published graphs."""
    methods: Sequence[Planner] = (
        Stationary(),
        Random(wait=True),
        Decoupled("entropy", 5),
        Decoupled("target-probability", 5),
        Decoupled("distance-over-probability", 1),
        Rollout(),
        Sequential(),
        BestResponse(),
        BestResponse(discount=0.99),
        BranchAndBound(),
        Beam(width=30),
        Beam(),
        Beam(width=1000, alike=3),
    )
    for name in ("office-60", "museum-70"):
        problem = unit_problem(read_edge_list(graphs / f"{name}.json"), 2)
        starts = [(cell, cell) for cell in range(0, len(problem.graph), every)]
        yield {
            "what": "expected time, steps",
            "graph": name,
            "method": "bound",
            "mean": mean(lower_bounds(problem, starts)),
        }
        for planner in methods:
            results = predict(problem, planner, starts, np.random.default_rng(0), residue=1e-6)
            yield {
                "what": "expected time, steps",
                "graph": name,
                "method": repr(planner),
                "mean": mean([r.expected_time for r in results]),
                "ms a decision": 1e3 * mean([r.seconds_per_plan for r in results]),
            }


def fixed_time_plans(graphs: Path, seconds: float) -> Iterable[Row]:
    """Yield how ten-step plans compare with the proven optimum: discount 0.99, two searchers, twenty seeds."""
    for name in ("office-60", "museum-70"):
        graph = read_edge_list(graphs / f"{name}.json")
        model = SearchModel(unit_problem(graph, 2))
        joint = JointSearch(model, horizon=10, discount=0.99)
        beam = BeamSearch(model, width=200, alike=1, horizon=10, discount=0.99, residue=0.0)
        for kind in ("five cells", "uniform"):
            ratios: dict[str, list[float]] = {"beam": [], "sequential": [], "best response": []}
            spent, proven = [], 0
            for seed in range(20):
                rng = np.random.default_rng(seed)
                start = int(rng.integers(len(graph)))
                belief = uniform_belief(graph, exclude=[start])[1:]
                if kind == "five cells":
                    others = np.delete(np.arange(len(graph)), start)
                    belief = np.zeros(len(graph))
                    belief[rng.choice(others, 5, replace=False)] = 0.2
                now = (belief, [model.move(start, start)] * 2, [1, 1])
                plans = {
                    "beam": beam.run(*now).moves,
                    "sequential": respond(joint, *now, (), rounds=0),
                    "best response": respond(joint, *now, (), rounds=10),
                }
                known = max(plans.values(), key=lambda plan: joint.value(*now, plan))
                proof = joint.run(*now, known, nodes=10**9, seconds=seconds)
                spent.append(proof.seconds)
                proven += proof.gap < 1e-9
                for method, plan in plans.items():
                    ratios[method].append(joint.value(*now, plan) / proof.bound)
            row = {"what": "ten steps", "graph": name, "belief": kind, "proven of 20": proven}
            yield row | {"seconds, median": float(np.median(spent)), "seconds, worst": max(spent)}
            for method, shares in ratios.items():
                yield row | {"method": method, "share of bound, mean": mean(shares), "worst": min(shares)}


def offices(blocks: int) -> SearchGraph:
    """Return a grid of ``blocks`` x ``blocks`` hallway cells with four rooms on each, random ways of 1.5 to 4 m."""
    rng = np.random.default_rng(0)
    halls = np.arange(blocks * blocks).reshape(blocks, blocks)
    edges = [*zip(halls[:, :-1].ravel(), halls[:, 1:].ravel(), strict=True)]
    edges += [*zip(halls[:-1].ravel(), halls[1:].ravel(), strict=True)]
    edges += [(hall, blocks * blocks + 4 * hall + room) for hall in halls.ravel() for room in range(4)]
    unit = SearchGraph.from_edges(5 * blocks * blocks, edges)
    legs = rng.uniform(1.5, 4.0, (len(edges), 2))
    return SearchGraph._build(edges, legs, rng.uniform(9.0, 30.0, len(unit)), unit.component)


def growth() -> Iterable[Row]:
    """Yield how the time of a replan of the whole team grows with cells, robots and depth."""
    cases = [(3, r, Decoupled("entropy", 5)) for r in (1, 2, 4, 8)]
    cases += [(3, 2, Decoupled("entropy", d)) for d in (1, 2, 3, 4, 6)]
    cases += [(blocks, 10, planner) for blocks in (5, 10, 20) for planner in (Decoupled("entropy", 2), Decoupled())]
    cases += [(blocks, 10, Beam(width=10, horizon=20)) for blocks in (3, 10, 20)]
    for blocks, robots, planner in cases:
        graph = offices(blocks)
        problem = SearchProblem(graph, AreaSpeedDegree(), SameCell(), (1.0,) * robots)
        policy = planner.solve(problem, np.random.default_rng(0))
        halls = np.random.default_rng(1).integers(blocks * blocks, size=robots).tolist()
        state = SearchState(
            0.0, uniform_belief(graph, exclude=halls), tuple(PursuerState(h) for h in halls), ((),) * robots
        )
        spent = timed(lambda policy=policy, state=state: policy.decide(state), 5)
        yield {"what": "replan", "cells": len(graph), "robots": robots, "method": repr(planner), "ms": spent}


def belief_steps() -> Iterable[Row]:
    """Yield the time of a belief step with ten robots."""
    for blocks in (3, 20):
        graph = offices(blocks)
        transition = AreaSpeedDegree().matrix(graph, 1.0)
        rows = np.stack([SameCell().row(graph, cell) for cell in range(10)])
        belief = uniform_belief(graph)
        spent = timed(lambda b=belief, t=transition, r=rows: advance(b, t, r), 200)
        yield {"what": "belief step", "cells": len(graph), "robots": 10, "ms": spent}


def mean(values: Sequence[float]) -> float:
    """Return the mean as a plain number."""
    return float(np.mean(values))


def main() -> None:
    """Run all parts, print a line for each result and store them."""
    root = Path(__file__).parents[2]
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--graphs", type=Path, default=root.parent / "shared" / "graphs")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=2.0, help="longest time for one proof")
    parser.add_argument("--out", type=Path, default=Path(__file__).with_suffix(".json"))
    options = parser.parse_args()
    parts: list[Iterable[Row]] = [belief_steps(), growth()]
    if options.graphs.is_dir():
        parts += [fixed_time_plans(options.graphs, options.seconds), expected_times(options.graphs, options.every)]
    rows = []
    for part in parts:
        for row in part:
            rows.append(row)
            cells = (f"{key} {value:.4g}" if isinstance(value, float) else str(value) for key, value in row.items())
            sys.stdout.write("  ".join(cells) + "\n")
            sys.stdout.flush()
    options.out.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
