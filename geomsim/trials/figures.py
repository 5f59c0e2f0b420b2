"""Figures of a comparison: mean capture times as bars, and capture curves."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from geomsim.files import replacing
from geomsim.trials.results import Summary, Trials

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_curves", "draw_means"]

# told apart by the colour-blind, and in grey by their dashes (Okabe and Ito's colours without yellow)
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000")
_DASHES = ("-", "--", ":", "-.")
_INK = "#222222"


def draw_means(trials: Trials, path: Path) -> Path:
    """Draw the mean capture time of each method with its standard error, and what the cell model predicts.

    Parameters
    ----------
    trials : Trials
        What is drawn.
    path : Path
        Ends in ``.png``, ``.svg`` or ``.pdf``; replaced if it exists.
    """
    summary = trials.summary()
    means = np.array([line.observed.mean for line in summary.methods])
    rows = np.arange(len(means))[::-1]
    figure, axes = _figure(8.0, 1.3 + 0.34 * len(means))
    axes.barh(rows, means, height=0.62, color="#9db8cf", label="mean of trials")
    errors = np.array([line.observed.sem or 0.0 for line in summary.methods])
    axes.errorbar(means, rows, xerr=errors, fmt="none", ecolor=_INK, capsize=3, lw=1.2, label="standard error")
    told = [line.predicted for line in summary.methods]
    axes.plot(told, rows, "D", color="#d55e00", ms=5, ls="none", label="predicted in the cell model")
    end = max(float((means + errors).max()), *told, 1e-9)
    wide = means.min() > 0 and end > 12 * means.min()
    if wide:
        axes.set_xscale("log")
        axes.set_xlim(0.6 * means.min(), 2.2 * end)
    else:
        axes.set_xlim(0, 1.18 * end)
    for line, row in zip(summary.methods, rows, strict=True):
        bound = "\u2265 " if line.observed.censored else ""
        label, left = f"{bound}{line.observed.mean:.1f}", (axes.get_xlim()[0], row)
        axes.annotate(label, left, (5, 0), textcoords="offset points", va="center", size=9, color=_INK)
    axes.set_yticks(rows, [line.name for line in summary.methods])
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel("time to capture, s" + (" (logarithmic)" if wide else ""))
    axes.set_title(_title(trials, summary), loc="left", size=11)
    axes.legend(loc="upper center", bbox_to_anchor=(0.4, -0.5 / (0.34 * len(means) + 0.1)), ncols=3, frameon=False)
    return _save(figure, path)


def draw_curves(trials: Trials, path: Path) -> Path:
    """Draw the share captured over time, by Kaplan and Meier with 95 % bands; logarithmic time.

    Parameters as for :func:`draw_means`.
    """
    summary = trials.summary()
    figure, axes = _figure(8.0, 5.2)
    first, last = np.inf, 1.0
    for k, name in enumerate(trials.names):
        curve = trials.survival(name)
        colour, dash = _COLOURS[k % len(_COLOURS)], _DASHES[k // len(_COLOURS) % len(_DASHES)]
        axes.step(curve.time, 1 - curve.free, where="post", color=colour, ls=dash, lw=1.6, label=name)
        axes.fill_between(curve.time, 1 - curve.high, 1 - curve.low, step="post", color=colour, alpha=0.12, lw=0)
        begun = curve.time[np.flatnonzero(curve.free <= 0.97)[:1]]
        first, last = min(first, float(begun[0]) if len(begun) else np.inf), max(last, float(curve.time[-1]))
    axes.set_xscale("log")
    axes.set_xlim(max(0.5, min(first, last / 2) / 1.5), last)
    axes.xaxis.set_major_formatter("{x:g}")
    axes.set_ylim(0, 1)
    axes.grid(alpha=0.25, lw=0.6)
    axes.set_xlabel("time, s (logarithmic)")
    axes.set_ylabel("share captured")
    axes.set_title(_title(trials, summary), loc="left", size=11)
    axes.legend(loc="upper left" if len(trials.names) <= 6 else "center left", **_beside(len(trials.names)))
    return _save(figure, path)


def _beside(count: int) -> dict[str, object]:
    return {"frameon": False, "fontsize": 8.5} | ({} if count <= 6 else {"bbox_to_anchor": (1.0, 0.5)})


def _title(trials: Trials, summary: Summary) -> str:
    plan, team = trials.experiment.cells.plan.name, trials.experiment.team
    robots = f"{team.pursuers} robot" + ("s" if team.pursuers > 1 else "")
    return f"{plan}: {robots}, {summary.trials} trials, capture by {trials.experiment.capture}"


def _figure(width: float, height: float) -> tuple[Figure, Axes]:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), dpi=150)
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    return figure, axes


def _save(figure: Figure, path: Path) -> Path:
    with replacing(path) as part:
        figure.savefig(part, bbox_inches="tight", facecolor="white")
    return path
