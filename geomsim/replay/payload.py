"""What the page needs of an episode, as plain numbers: whole centimetres, differences from step to step."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from geomsim.drawing.colours import hex_colour, mixed
from geomsim.drawing.floor import inner_boundaries, thin_walls
from geomsim.drawing.moment import Timeline, shares
from geomsim.drawing.scale import ProbabilityScale
from geomsim.drawing.sight import eyes
from geomsim.drawing.theme import THEMES, Theme
from geomsim.episode import Episode

__all__ = ["payload"]

# A page stays small: at most this many positions of a body, and this many chances of cells.
_MOST_STEPS = 12_000
_MOST_CHANCES = 1_500_000

# Chances are written as the root of the share in ten-thousandths, so that small ones keep their digits.
_ROOT = 10_000

Record = dict[str, Any]


def payload(episode: Episode) -> Record:
    """Return an episode as values that JSON can hold.

    Lengths are in centimetres. ``moves`` and ``chances`` hold the first row and then the differences between rows,
    which compress well. A very long or very large episode is thinned in time; its end is always there.
    """
    every = max(1, math.ceil(len(episode.times) / _MOST_STEPS))
    steps = _thinned(len(episode.times), every)
    cells = len(episode.cells)
    beliefs = _thinned(len(episode.belief_times), max(1, math.ceil(len(episode.belief_times) * cells / _MOST_CHANCES)))
    out = episode.outcome
    moving = np.concatenate([episode.pursuers, episode.evaders], axis=1)[steps].reshape(len(steps), -1)
    roots = [np.sqrt(np.append(b[:1], shares(b))) * _ROOT for b in episode.beliefs[beliefs]]
    return {
        "name": episode.plan.name,
        "bounds": _centimetres(np.array(episode.plan.bounds)),
        "space": _rings(episode.plan.space),
        "thin": _rings(thin_walls(episode.plan)),
        "dotted": [_centimetres(path) for path in inner_boundaries(episode.cells)],
        "portals": [_centimetres(portal.point) for portal in episode.cells.portals],
        "cells": _cells(episode),
        "top": ProbabilityScale.of(episode.beliefs).top,
        "robots": episode.pursuers.shape[1],
        "evaders": episode.evaders.shape[1],
        "sight": {
            "byCell": episode.scenario.get("capture") == "cell",
            "eyes": [{"range": _finite(reach), "field": field} for reach, field in eyes(episode)],
        },
        "times": _differences(episode.times[steps][:, None] * 1000),
        "moves": _differences(moving * 100),
        "headings": _differences(np.degrees(np.unwrap(episode.headings[steps], axis=0))),
        "beliefTimes": [round(float(t), 3) for t in episode.belief_times[beliefs]],
        "chances": _differences(np.array(roots)),
        "plans": _plans(episode),
        "outcome": {
            "captured": out.captured,
            "time": out.time,
            "robot": None if out.pursuer is None else out.pursuer + 1,
            "cell": None if out.cell is None else out.cell + 1,
            "status": out.status.value,
            "evader": out.evader,
            "captures": [{"evader": capture.evader, "time": capture.time} for capture in out.captures],
        },
        "themes": {name: _theme(theme) for name, theme in THEMES.items()},
    }


def _thinned(count: int, every: int) -> NDArray[np.intp]:
    """Return each ``every``-th index, and the last one."""
    return np.unique(np.append(np.arange(0, count, every), count - 1))


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _centimetres(points: NDArray[np.float64]) -> list[float]:
    """Flat list of coordinates, to a tenth of a millimetre where that is not whole."""
    return [int(v) if v == int(v) else float(v) for v in np.round(points * 100, 2).ravel()]


def _rings(area: shapely.Geometry) -> list[list[float]]:
    """Rings, each once around with free space to its left, without the repeated first point."""
    parts = [p for p in shapely.get_parts(shapely.orient_polygons(area)) if isinstance(p, shapely.Polygon)]
    return [_centimetres(shapely.get_coordinates(ring)[:-1]) for ring in shapely.get_rings(parts)]


def _cells(episode: Episode) -> list[Record]:
    cells = episode.cells
    return [
        {
            "rings": _rings(cell),
            "at": _centimetres(np.array(cell.representative_point().coords[0]) if np.isnan(at[0]) else at),
            "area": round(float(area), 2),
            "name": name,
        }
        for cell, at, area, name in zip(cells.cells, cells.checkpoints, cells.areas, cells.names, strict=True)
    ]


def _differences(rows: NDArray[np.float64]) -> list[list[int]]:
    whole = np.rint(rows).astype(np.int64)
    listed: list[list[int]] = np.diff(whole, axis=0, prepend=np.zeros_like(whole[:1])).tolist()
    return listed


def _plans(episode: Episode) -> list[Record]:
    """Every decision with the way that it means: when, who, and the way from where the pursuer stood."""
    timeline = Timeline(episode)
    return [
        {"time": round(float(time), 3), "robot": int(robot), "way": _centimetres(timeline.way(k))}
        for k, (time, robot) in enumerate(zip(episode.decision_times, episode.decision_pursuers, strict=True))
    ]


def _theme(theme: Theme) -> Record:
    plain = {key: getattr(theme, key) for key in ("page", "text", "muted", "grid", "wall", "dots", "portal")}
    plain |= {key: getattr(theme, key) for key in ("casing", "label", "evader", "curve")}
    ramp = [hex_colour(colour) for colour in theme.ramp[::5]]
    lit = [mixed(colour, theme.light, 0.5) for colour in theme.robots]
    return {**plain, "robots": list(theme.robots), "lit": lit, "ramp": ramp}
