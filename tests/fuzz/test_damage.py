"""Files that were damaged by chance: each makes something usable, or one sentence, and soon."""

import re
import time
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from geomsim import Episode
from geomsim.scenario import read_scenario
from maps import FORMATS, GeomsimError, read_plan
from tests.fuzz.examples import EXAMPLES, SCENARIO

#: what files of text are attacked with, besides bytes
TOKENS = [b"-1", b"1e308", b"1e-320", b"NaN", b"Infinity", b"9" * 400, b"null", b"[]", b"{}", b'""', b"\xff\xfe"]
TOKENS += [b"[" * 2000, b"<!ENTITY a 'b'>", b"&a;", b"\0", b"\xed\xa0\x80", b"../../x", b"true", b"0", b"\n" * 99]

#: no damage may take longer, seconds; the machine may be busy
PATIENCE = 10.0


def damaged(content: bytes) -> st.SearchStrategy[bytes]:
    """Content with one to four pieces cut out, doubled or put in place of others; numbers and bytes alike."""
    pieces = [m.span() for m in re.finditer(rb"-?\d+(\.\d+)?|\w+|[^\w\s]", content)] or [(0, 0)]
    place = st.one_of(st.sampled_from(pieces[:2000]), st.integers(0, len(content)).map(lambda k: (k, k + 1)))
    what = st.one_of(
        st.sampled_from(TOKENS), st.binary(max_size=6), st.sampled_from(pieces).map(lambda p: content[p[0] : p[1]])
    )

    def apply(edits: list[tuple[tuple[int, int], bytes]]) -> bytes:
        text = content
        for (begin, end), new in sorted(edits, reverse=True):  # from the end, so that earlier places stay
            text = text[:begin] + new + text[end:]
        return text

    whole = st.lists(st.tuples(place, what), min_size=1, max_size=4).map(apply)
    return st.one_of(whole, st.integers(0, len(content)).map(lambda k: content[:k]))


def usable(do, *arguments, **options) -> None:
    """Do something with a damaged file: it works, or raises one sentence, soon."""
    begun, sentence = time.process_time(), None
    try:
        do(*arguments, **options)
    except GeomsimError as exc:
        sentence = str(exc)
    if sentence is not None:
        assert "\n" not in sentence
        assert 10 < len(sentence) < 1500
    assert time.process_time() - begun < PATIENCE


def test_there_is_an_example_of_every_kind_but_building_models() -> None:
    kinds = {name.partition(" (")[0] for name in EXAMPLES}
    assert kinds == {kind.name for kind in FORMATS} - {"IFC building model"}


FEW = settings(max_examples=15, suppress_health_check=list(HealthCheck))


@pytest.mark.parametrize("name", list(EXAMPLES))
@FEW
@given(data=st.data())
def test_damaged_plans(name: str, data: st.DataObject, tmp_path_factory: pytest.TempPathFactory) -> None:
    file, content, options = EXAMPLES[name]
    folder = tmp_path_factory.mktemp("damaged")
    (folder / "map.png").write_bytes(EXAMPLES["picture"][1])  # of the ROS map
    path = folder / file
    path.write_bytes(content)
    read_plan(path, **options)  # whole, it is readable
    path.write_bytes(data.draw(damaged(content)))
    usable(read_plan, path, **options)


@FEW
@given(content=damaged(SCENARIO))
def test_damaged_scenarios(content: bytes, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("damaged") / "scenario.toml"
    path.write_bytes(content)

    def use() -> None:
        told = read_scenario(path, {})
        told.team(), told.quarry(), told.timing(), told.belief_motion()

    usable(use)


@FEW
@given(data=st.data())
def test_damaged_records(data: st.DataObject, pursuit: Episode, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("damaged") / "episode.npz"
    whole = pursuit.save(path).read_bytes()
    at, new = data.draw(st.integers(0, len(whole) - 1)), data.draw(st.binary(min_size=1, max_size=9))
    path.write_bytes(whole[:at] + new + whole[at + len(new) :])
    usable(Episode.load, path)


BOMB = """<?xml version="1.0"?><!DOCTYPE x [<!ENTITY a "aaaaaaaaaa">{}]>
<{root}><g id="room">&z9;</g></{root}>"""
ENTITIES = "".join(f'<!ENTITY z{k} "{f"&z{k - 1};" * 10 if k else "&a;" * 10}">' for k in range(10))


@pytest.mark.parametrize(("suffix", "root"), [(".svg", "svg"), (".gml", "IndoorFeatures")])
@pytest.mark.parametrize("entities", [ENTITIES, '<!ENTITY z9 SYSTEM "file:///etc/passwd">'])
def test_xml_with_entities_is_refused(tmp_path: Path, suffix: str, root: str, entities: str) -> None:
    path = tmp_path / f"bomb{suffix}"
    path.write_text(BOMB.replace("{root}", root).replace("{}", entities))
    with pytest.raises(GeomsimError, match="not valid XML"):
        read_plan(path, **({"resolution": 0.01} if suffix == ".svg" else {}))
