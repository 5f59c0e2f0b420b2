"""The page of Section V: every claim beside what came out, and nothing that it needs from elsewhere."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from discretize import CellMap
from geomsim import Timing
from geomsim.cli import main
from geomsim.trials import Trials, run_trials
from geomsim.trials.claims import PAPER_COSTS, judge
from geomsim.trials.page import write_page
from geomsim.trials.paper import Reproduction, parts

METHODS = ["stationary", "random", *(f"decoupled-{cost}-{depth}" for depth in (1, 5) for cost in PAPER_COSTS)]


@pytest.fixture(scope="module")
def trials(house: CellMap) -> Trials:
    return run_trials(
        house.plan, METHODS, cells=house, trials=24, capture="cell", workers=1, timing=Timing(limit=300.0), team_runs=4
    )


def test_claims_say_what_the_numbers_say(trials: Trials) -> None:
    claims = {claim.what: claim for claim in judge({"figure-5": trials})}
    table = trials.summary()
    random = claims["random: mean capture time"]
    assert random.paper == "344.4 \u00b1 14.7 s"
    assert random.ratio == pytest.approx(table["random"].observed.mean / 344.385)
    assert not random.agrees  # the house is no office
    for cost in PAPER_COSTS:
        claim = claims[f"five-cell lookahead with {cost.replace('-', ' ')}"]
        near, far = (table[f"decoupled-{cost}-{depth}"].observed.mean for depth in (1, 5))
        assert claim.agrees == ((far < near) == (claim.paper == "reduces the time"))
    best = min(table[f"decoupled-{c}-{d}"].observed.mean for c in PAPER_COSTS[1:] for d in (1, 5))
    factor = claims["random over the best of the paper's methods"]
    assert factor.ratio == pytest.approx(table["random"].observed.mean / best / 5)
    assert factor.agrees == (factor.ratio >= 1)


def test_an_experiment_against_itself(trials: Trials) -> None:
    """Nothing is gained by dispersion where both are the same trials, and claims about it must say so."""
    claims = judge({"figure-5": trials, "no-dispersion": trials, "immobile": trials})
    assert [c.agrees for c in claims if c.what.startswith("dispersion")] == [False, False]
    immobile = [c for c in claims if c.what.startswith("immobile")]
    assert len(immobile) == 2
    assert all("paired difference" in c.ours for c in immobile)


def test_the_page(trials: Trials, tmp_path: Path) -> None:
    part = replace(parts()[0], plan="house")
    files = write_page(Reproduction((part,), {part.key: trials}, judge({part.key: trials})), tmp_path)
    markdown, page = (files[kind].read_text(encoding="utf-8") for kind in ("markdown", "html"))
    for name in METHODS:
        assert f"| {name} | " in markdown
        assert f"<td>{name}</td>" in page
    for picture in re.findall(r"\]\((.*?)\)", markdown):
        assert (tmp_path / picture).read_bytes().startswith(b"\x89PNG")
    assert page.count("data:image/png;base64,") == 2
    assert not re.search(r"(src|href)=.?http", page)
    assert "749.3 \u00b1 24.6 s" in page
    assert page.count("class=differs") + page.count("class=agrees") == len(judge({part.key: trials}))


def test_the_experiments() -> None:
    told = {part.key: part for part in parts()}
    assert told["figure-5"].methods[:2] == ("stationary", "random")
    assert {told[f"pursuers-{k}"].pursuers for k in (3, 4, 5)} == {3, 4, 5}
    assert (told["museum"].plan, told["sight"].capture) == ("museum", "sight")


def test_an_unknown_experiment_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    with pytest.raises(SystemExit) as end:
        main(["reproduce", "--only", "figure-6", "--out", str(tmp_path / "x")])
    assert end.value.code == 2
    assert "did you mean 'figure-5'" in capsys.readouterr().err
