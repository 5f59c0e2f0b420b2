"""Figures of a comparison: mean capture times as bars, cost heuristics side by side, curves, predictions."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from geomsim.files import replacing
from geomsim.trials.results import Summary, Trials
from geomsim.trials.statistics import Sample

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["FIGURES", "draw_curves", "draw_fidelity", "draw_heuristics", "draw_means"]

# told apart by the colour-blind, and in grey by their dashes (Okabe and Ito's colours without yellow)
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000")
_DASHES = ("-", "--", ":", "-.")
_INK = "#222222"


def draw_means(trials: Trials, path: Path) -> Path:
    """Draw the mean capture time of each method with its standard error, and what is predicted.

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
    axes.plot(told, rows, "D", color="#d55e00", ms=5, ls="none", label="predicted")
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


def draw_heuristics(trials: Trials, path: Path) -> Path | None:
    """Draw the paper's Fig. 5: mean capture time with its standard error, by coordination and lookahead, then by cost.

    Parameters as for :func:`draw_means`.

    Returns
    -------
    Path or None
        None, and nothing is written, where fewer than two methods differ in their cost heuristic alone.
    """
    found = {line.name: line.observed for line in trials.summary().methods}
    groups: dict[str, dict[str, Sample]] = {}
    for method in trials.experiment.methods:
        cost, depth = (str(getattr(method.planner, key, "")) for key in ("cost", "depth"))
        coordination = method.name.removesuffix(f"-{depth}").removesuffix(f"-{cost}")
        if cost and coordination != method.name:
            label = f"{coordination}\n" + ("no lookahead" if depth == "1" else f"{depth} cells ahead")
            groups.setdefault(label, {})[cost] = found.pop(method.name)
    if max(map(len, groups.values()), default=0) < 2:
        return None
    costs = list(dict.fromkeys(cost for group in groups.values() for cost in group))
    figure, axes = _figure(2.0 + 2.2 * len(groups), 4.6)
    wide = 0.8 / len(costs)
    for k, cost in enumerate(costs):
        shown = [(x + (k - (len(costs) - 1) / 2) * wide, g[cost]) for x, g in enumerate(groups.values()) if cost in g]
        places, bars = [x for x, _ in shown], [one.mean for _, one in shown]
        axes.bar(places, bars, 0.92 * wide, color=_COLOURS[k % len(_COLOURS)], alpha=0.75, label=cost.replace("-", " "))
        errors = [one.sem or 0.0 for _, one in shown]
        axes.errorbar(places, bars, yerr=errors, fmt="none", ecolor=_INK, capsize=3, lw=1.2)
    axes.set_xticks(range(len(groups)), list(groups))
    axes.tick_params(axis="x", length=0)
    axes.set_ylabel("mean time to capture, s")
    axes.set_title(_title(trials, trials.summary()), loc="left", size=11)
    axes.legend(frameon=False, fontsize=8.5, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    others = [f"{name} {one.mean:.1f} s" for name, one in found.items() if name in ("random", "stationary")]
    if others:
        axes.annotate("Not shown: " + ", ".join(others), (0, -42), xycoords="axes points", size=9, color=_INK)
    return _save(figure, path)


def draw_fidelity(trials: Trials, path: Path) -> Path | None:
    """Draw the mean capture time that is predicted against the one observed, method by method.

    Parameters as for :func:`draw_means`.

    Returns
    -------
    Path or None
        None, and nothing is written, where every capture is at once, which has no logarithm.
    """
    from matplotlib.ticker import LogLocator

    summary = trials.summary()
    told = [line for line in summary.methods if line.predicted > 0 and line.observed.mean > 0]
    if not told:
        return None
    figure, axes = _figure(8.0, 5.2)
    means = np.array([[line.predicted, line.observed.mean] for line in told])
    span = np.array([0.8 * means.min(), 1.25 * means.max()])
    axes.fill_between(span, 0.9 * span, 1.1 * span, color="#9db8cf", alpha=0.35, lw=0, label="within 10 %")
    axes.plot(span, span, color=_INK, lw=0.8)
    for k, (line, (said, seen)) in enumerate(zip(told, means, strict=True)):
        mark = "osD^vP*X"[k // len(_COLOURS) % 8]
        colour = _COLOURS[k % len(_COLOURS)]
        axes.errorbar(
            said, seen, yerr=line.observed.sem or 0.0, fmt=mark, color=colour, ms=6, capsize=3, label=line.name
        )
    for scale, limits, axis in (
        (axes.set_xscale, axes.set_xlim, axes.xaxis),
        (axes.set_yscale, axes.set_ylim, axes.yaxis),
    ):
        scale("log")
        limits(*span)
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter("")
    axes.set_xlabel("predicted, s (logarithmic)")
    axes.set_ylabel("mean of trials, s (logarithmic)")
    tau = summary.rank_correlation
    axes.set_title(
        _title(trials, summary) + ("" if tau is None else f", Kendall\u2019s tau {tau:.2f}"), loc="left", size=11
    )
    axes.legend(loc="center left", frameon=False, fontsize=8.5, bbox_to_anchor=(1.0, 0.5))
    return _save(figure, path)


#: every figure of a comparison by the name of its file
FIGURES: dict[str, Callable[[Trials, Path], Path | None]] = {
    "means": draw_means,
    "heuristics": draw_heuristics,
    "curves": draw_curves,
    "fidelity": draw_fidelity,
}


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
    from matplotlib import rc_context

    undated = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(path.suffix, {})
    with replacing(path) as part, rc_context({"svg.hashsalt": path.stem}):
        figure.savefig(part, bbox_inches="tight", facecolor="white", metadata=undated)
    return path
