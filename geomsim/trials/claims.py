"""What the paper says of its experiments, beside what came out."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from geomsim.trials.results import MethodSummary, Trials
from geomsim.trials.statistics import compare_times

__all__ = ["PAPER_COSTS", "Claim", "judge"]

#: a number that differs from the paper's by no more than this share agrees with it
_NEAR = 0.2

#: the heuristics of Fig. 5
PAPER_COSTS = ("distance-over-probability", "probability", "target-probability", "entropy")
_PAPERS = tuple(f"{cost}-{depth}" for cost in PAPER_COSTS for depth in (1, 5))


@dataclass(frozen=True, slots=True)
class Claim:
    """What the paper says beside what came out.

    Attributes
    ----------
    what : str
        Of what.
    paper, ours : str
        The two, as text.
    ratio : float or None
        Ours over the paper's, where both are numbers.
    agrees : bool
        Whether they do.
    """

    what: str
    paper: str
    ours: str
    ratio: float | None
    agrees: bool


def judge(trials: Mapping[str, Trials]) -> tuple[Claim, ...]:
    """Hold what the paper says against what came out, as far as the experiments have been run."""
    claims: list[Claim] = []
    if "figure-5" in trials:
        claims += _figure_5(trials["figure-5"])
    if "figure-5" in trials and "no-dispersion" in trials:
        claims += _dispersion(trials["figure-5"], trials["no-dispersion"])
    if "immobile" in trials:
        claims += _immobile(trials["immobile"])
    teams = [trials[key] for key in ("figure-5", "pursuers-3", "pursuers-4", "pursuers-5") if key in trials]
    if len(teams) > 1:
        means = [team.summary()["decoupled-entropy-5"].observed.mean for team in teams]
        told = ", ".join(f"{t.experiment.team.pursuers}: {mean:.1f} s" for t, mean in zip(teams, means, strict=True))
        claims.append(
            Claim(
                "more pursuers (entropy, five cells)",
                "up to five reduce the time for most evader paths",
                told,
                None,
                all(b < a for a, b in itertools.pairwise(means)),
            )
        )
    return tuple(claims)


def _figure_5(trials: Trials) -> list[Claim]:
    table = trials.summary()
    claims = []
    for name, mean, sem in (("stationary", 749.319, 24.6114), ("random", 344.385, 14.6694)):
        seen = table[name].observed
        claims.append(
            _number(f"{name}: mean capture time", mean, f"{mean:.1f} \u00b1 {sem:.1f} s", seen.mean, seen.sem)
        )
    share = table["random"].observed.mean / table["stationary"].observed.mean
    paper = 344.385 / 749.319
    close = abs(share / paper - 1) <= _NEAR
    claims.append(
        Claim("random over stationary, whatever the scale", f"{paper:.2f}", f"{share:.2f}", share / paper, close)
    )
    papers = [line for line in table.methods if line.name.endswith(_PAPERS)]
    claims += _best(trials, papers, "the paper's methods")
    claims += _best(
        trials, [line for line in table.methods if line.name not in ("stationary", "random")], "all methods"
    )
    for cost in PAPER_COSTS:
        near, far = (table[f"decoupled-{cost}-{depth}"].observed.mean for depth in (1, 5))
        helps = cost in ("entropy", "target-probability")
        claims.append(
            Claim(
                f"five-cell lookahead with {cost.replace('-', ' ')}",
                "reduces the time" if helps else "hurts",
                f"{near:.1f} s to {far:.1f} s",
                None,
                (far < near) == helps,
            )
        )
    return claims


def _best(trials: Trials, lines: Sequence[MethodSummary], of_what: str) -> list[Claim]:
    """Hold the best of some methods against random, and against the best of distance over probability."""
    best, rival = (
        min((line for line in lines if ("distance-over" in line.name) == old), key=lambda line: line.observed.mean)
        for old in (False, True)
    )
    factor = trials.summary()["random"].observed.mean / best.observed.mean
    difference = compare_times(trials.times(best.name), trials.times(rival.name))
    gain = -difference.difference / rival.observed.mean
    clear = difference.high is not None and difference.high < 0
    told = f"{gain:.0%} sooner, {best.name} against {rival.name}, paired difference "
    return [
        Claim(f"random over the best of {of_what}", "5", f"{factor:.1f} ({best.name})", factor / 5, factor >= 5),
        Claim(
            f"best of {of_what} against distance over probability",
            "17 % sooner",
            told + _interval(difference.difference, difference.low, difference.high),
            gain / 0.17,
            gain >= 0.17 and clear,
        ),
    ]


def _dispersion(modelled: Trials, blind: Trials) -> list[Claim]:
    claims = []
    for name in ("decoupled-entropy-5", "decoupled-target-probability-5"):
        difference = compare_times(modelled.times(name), blind.times(name))
        on, off = (t.summary()[name].observed.mean for t in (modelled, blind))
        claims.append(
            Claim(
                f"dispersion, {name}",
                "greatly helps in catching a mobile evader",
                f"{off:.1f} s without, {on:.1f} s with it",
                None,
                difference.high is not None and difference.high < 0,
            )
        )
    return claims


def _immobile(trials: Trials) -> list[Claim]:
    claims = []
    rival = min(
        (line for line in trials.summary().methods if "distance-over" in line.name), key=lambda line: line.observed.mean
    )
    for name in ("decoupled-entropy-5", "decoupled-target-probability-5"):
        difference = compare_times(trials.times(name), trials.times(rival.name))
        low, high = difference.low, difference.high
        claims.append(
            Claim(
                f"immobile evader: {name} against {rival.name}",
                "not significantly different",
                f"paired difference {_interval(difference.difference, low, high)}",
                None,
                low is not None and high is not None and low <= 0 <= high,
            )
        )
    return claims


def _number(what: str, paper: float, told: str, ours: float, sem: float | None) -> Claim:
    ratio = ours / paper
    error = "" if sem is None else f" \u00b1 {sem:.1f}"
    return Claim(what, told, f"{ours:.1f}{error} s", ratio, abs(ratio - 1) <= _NEAR)


def _interval(mean: float, low: float | None, high: float | None) -> str:
    return f"{mean:+.1f} s" + ("" if low is None or high is None else f" [{low:+.1f}, {high:+.1f}]")
