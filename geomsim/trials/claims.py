"""What the paper says of its experiments, beside what came out."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass

from geomsim.trials.results import Trials
from geomsim.trials.statistics import compare_times

__all__ = ["PAPER_COSTS", "Claim", "judge"]

#: a number that differs from the paper's by no more than this share agrees with it
_NEAR = 0.2

#: the heuristics of Fig. 5
PAPER_COSTS = ("distance-over-probability", "probability", "target-probability", "entropy")


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
    names = tuple(f"{cost}-{depth}" for cost in PAPER_COSTS for depth in (1, 5))
    ours = [line for line in table.methods if line.name.endswith(names)]
    best, rival = (
        min((line for line in ours if ("distance-over" in line.name) == old), key=lambda line: line.observed.mean)
        for old in (False, True)
    )
    factor = table["random"].observed.mean / best.observed.mean
    told = f"{factor:.1f} ({best.name})"
    claims.append(Claim("random over the best of the paper's methods", "5", told, factor / 5, factor >= 5))
    difference = compare_times(trials.times(best.name), trials.times(rival.name))
    gain = -difference.difference / rival.observed.mean
    clear = difference.high is not None and difference.high < 0
    claims.append(
        Claim(
            "best of the paper's methods against distance over probability",
            "17 % sooner",
            f"{gain:.0%} sooner, paired difference {_interval(difference.difference, difference.low, difference.high)}",
            gain / 0.17,
            gain >= 0.17 and clear,
        )
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
