"""``geomsim predict``: the exact expected capture time of a team, without sampling evaders."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from geomsim.cli.console import say, say_json
from geomsim.cli.flags import JsonFlag, ScenarioFlags

if TYPE_CHECKING:
    from planners import Prediction

__all__ = ["predict"]


def predict(
    plan: str | None = None,
    *,
    scenario: Annotated[Path | None, Parameter(help="A scenario file (TOML); flags override its keys.")] = None,
    json: JsonFlag = False,
    flags: ScenarioFlags = ScenarioFlags(),  # noqa: B008 a frozen value without fields set
) -> int:
    """Predict when a team will capture, exactly: in the cell model, same-cell capture and memoryless moves.

    With `--capture sight` it is when the team will see the evader: the team goes its ways in the world, and a belief
    over places on the routes, on which the paper's evader moves exactly, follows what it sees.

    Parameters
    ----------
    plan
        A floor plan as for `geomsim run`, or an edge list in JSON, which has unit times and its own vertex numbers.
        `--start all` averages over all cells in which the whole team can start together.
    """
    import numpy as np

    from geomsim.prediction import predict_scenario

    everywhere = flags.start == "all"
    given = (replace(flags, start=None) if everywhere else flags).given() | ({} if plan is None else {"plan": plan})
    result = predict_scenario(scenario, given, everywhere=everywhere)
    times = np.array([p.expected_time for p in result.predictions])
    shares = np.array([p.captured_share for p in result.predictions])
    thought = np.array([p.seconds_per_plan for p in result.predictions])
    told: dict[str, Any] = {
        "expected_time": float(times.mean()),
        "captured_share": float(shares.mean()),
        "lower_bound": None if result.bounds is None else float(np.mean(result.bounds)),
        "seconds_per_plan": float(np.nanmean(thought)) if np.isfinite(thought).any() else None,
        "unit": result.unit,
        "capture": result.capture,
        "belief": result.belief,
        "plans": [[[c + result.first for c in path] for path in p.paths] for p in result.predictions],
        "per_start": [_start(p, k, result.first, result.bounds) for k, p in enumerate(result.predictions)],
        "survival": result.predictions[0].survival.tolist() if len(result.predictions) == 1 else None,
        "survival_step": result.step,
        "scenario": result.scenario,
    }
    if json:
        say_json(told)
        return 0
    model = "by sight of parts of cells" if result.capture == "sight" else "in the cell model"
    how = model if result.belief == "cells" else f"by sight, with a belief over {result.belief}"
    say(f"{result.name}: expected capture after {told['expected_time']:.2f} {result.unit}, {how}")
    if len(result.predictions) > 1:
        best, worst = (told["per_start"][int(k)] for k in (times.argmin(), times.argmax()))
        say(
            f"mean over {len(times)} common starts: from {best['expected_time']:.2f} (cell {best['start'][0]}) "
            f"to {worst['expected_time']:.2f} (cell {worst['start'][0]})"
        )
    if told["lower_bound"] is not None:
        say(f"a team that always knew the evader's cell would need {told['lower_bound']:.2f} or more: none is faster")
    if told["seconds_per_plan"] is not None:
        say(f"mean time to plan: {1000 * told['seconds_per_plan']:.2f} ms")
    if len(result.predictions) == 1:
        for who, path in enumerate(told["plans"][0], start=1):
            if path:
                say(f"pursuer {who} goes to {' '.join(map(str, path[:30]))}{' ...' if len(path) > 30 else ''}")
    return 0


def _start(prediction: Prediction, k: int, first: int, bounds: tuple[float, ...] | None) -> dict[str, Any]:
    return {
        "start": [cell + first for cell in prediction.start],
        "expected_time": prediction.expected_time,
        "captured_share": prediction.captured_share,
        "lower_bound": None if bounds is None else bounds[k],
    }
