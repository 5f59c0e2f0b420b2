"""Records come back as they were; what is no record is refused with a sentence."""

import io
import json
import os
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from geomsim import Episode
from geomsim.files import OutputError
from geomsim.record import FORMAT, RecordError


def same(a: object, b: object) -> bool:
    if isinstance(a, np.ndarray):
        return isinstance(b, np.ndarray) and a.dtype == b.dtype and np.array_equal(a, b, equal_nan=True)
    if isinstance(a, tuple | list):
        return len(a) == len(b) and all(same(x, y) for x, y in zip(a, b, strict=True))
    if hasattr(a, "__dataclass_fields__"):
        return all(same(getattr(a, f.name), getattr(b, f.name)) for f in fields(a))
    return a == b


def test_round_trip(pursuit: Episode, tmp_path: Path) -> None:
    path = pursuit.save(tmp_path / "episode.npz")
    again = Episode.load(path)
    for field in fields(Episode):
        assert same(getattr(pursuit, field.name), getattr(again, field.name)), field.name


def test_the_same_episode_gives_the_same_bytes(pursuit: Episode, tmp_path: Path) -> None:
    a, b = pursuit.save(tmp_path / "a.npz"), pursuit.save(tmp_path / "b.npz")
    assert a.read_bytes() == b.read_bytes()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.npz", "b.npz"]


@pytest.fixture
def arrays(pursuit: Episode, tmp_path: Path) -> dict[str, np.ndarray]:
    with np.load(pursuit.save(tmp_path / "whole.npz")) as file:
        return dict(file)


def test_there_are_no_pickles(arrays: dict[str, np.ndarray]) -> None:
    assert not [name for name, array in arrays.items() if array.dtype == object]


def test_a_pickle_is_refused(arrays: dict[str, np.ndarray], tmp_path: Path) -> None:
    bad = tmp_path / "bad.npz"
    np.savez(bad, **(arrays | {"times": np.array([{"a": 1}], dtype=object)}))
    with pytest.raises(RecordError, match="no episode record"):
        Episode.load(bad)


def test_another_format_is_refused(arrays: dict[str, np.ndarray], tmp_path: Path) -> None:
    bad = tmp_path / "old.npz"
    meta = json.loads(str(arrays["meta"])) | {"format": FORMAT + 1}
    np.savez(bad, **(arrays | {"meta": np.array(json.dumps(meta))}))
    with pytest.raises(RecordError, match=f"format {FORMAT + 1}, but this version of geomsim reads {FORMAT}"):
        Episode.load(bad)


@pytest.mark.parametrize("missing", ["meta", "times", "portal_legs", "plan", "cells", "decision_splits"])
def test_a_missing_part_is_refused(arrays: dict[str, np.ndarray], tmp_path: Path, missing: str) -> None:
    bad = tmp_path / "bad.npz"
    del arrays[missing]
    np.savez(bad, **arrays)
    with pytest.raises(RecordError, match=r"bad\.npz"):
        Episode.load(bad)


@pytest.mark.parametrize("name", ["pursuers", "headings", "evaders", "beliefs", "evaders_cells", "decision_pursuers"])
def test_a_part_of_another_length_is_refused(arrays: dict[str, np.ndarray], tmp_path: Path, name: str) -> None:
    bad = tmp_path / "bad.npz"
    np.savez(bad, **(arrays | {name: arrays[name][:-1]}))
    with pytest.raises(RecordError, match="damaged"):
        Episode.load(bad)


def _outcome(arrays: dict[str, np.ndarray], **changed: object) -> np.ndarray:
    meta = json.loads(str(arrays["meta"]))
    meta["outcome"] |= changed
    return np.array(json.dumps(meta))


@pytest.mark.parametrize(
    ("name", "spoil"),
    [
        ("times", lambda a: a["times"][::-1]),
        ("times", lambda a: a["times"] * np.nan),
        ("times", lambda a: a["times"][0]),
        ("times", lambda a: a["times"].astype(complex)),
        ("pursuers", lambda a: a["pursuers"] + 1e300),
        ("evaders", lambda a: a["evaders"] - 1e4),
        ("pursuers", lambda a: a["pursuers"].astype(str)),
        ("evaders_cells", lambda a: a["evaders_cells"] + 99),
        ("pursuer_cells", lambda a: a["pursuer_cells"] - 99),
        ("decision_pursuers", lambda a: a["decision_pursuers"] + 99),
        ("decision_paths", lambda a: a["decision_paths"] - 99),
        ("portal_cells", lambda a: a["portal_cells"] + 99),
        ("checkpoints", lambda a: a["checkpoints"][:-1]),
        ("beliefs", lambda a: -a["beliefs"]),
        ("meta", lambda a: _outcome(a, pursuer=99)),
        ("meta", lambda a: _outcome(a, pursuer="one")),
        ("meta", lambda a: _outcome(a, cell=-1)),
        ("meta", lambda a: _outcome(a, status="lost")),
    ],
)
def test_values_that_cannot_be_are_refused(arrays: dict[str, np.ndarray], tmp_path: Path, name: str, spoil) -> None:
    bad = tmp_path / "bad.npz"
    np.savez(bad, **(arrays | {name: spoil(arrays)}))
    with pytest.raises(RecordError, match="damaged"):
        Episode.load(bad)


def test_text_nested_without_end_is_refused(arrays: dict[str, np.ndarray], tmp_path: Path) -> None:
    bad = tmp_path / "bad.npz"
    np.savez(bad, **(arrays | {"meta": np.array("[" * 50_000)}))
    with pytest.raises(RecordError, match="no episode record"):
        Episode.load(bad)


def test_what_is_no_file_is_not_waited_for(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.npz"
    os.mkfifo(pipe)
    for path in (pipe, tmp_path):
        with pytest.raises(RecordError, match="is no file"):
            Episode.load(path)


def test_every_truncation_is_refused(pursuit: Episode, tmp_path: Path) -> None:
    whole = pursuit.save(tmp_path / "whole.npz").read_bytes()
    bad = tmp_path / "cut.npz"
    for share in np.linspace(0, 0.999, 40):
        bad.write_bytes(whole[: int(share * len(whole))])
        with pytest.raises(RecordError, match=r"cut\.npz"):
            Episode.load(bad)


def test_damaged_bytes_are_refused_or_harmless(pursuit: Episode, tmp_path: Path) -> None:
    """Flip bytes all over the file: a RecordError or an episode, nothing else."""
    whole = pursuit.save(tmp_path / "whole.npz").read_bytes()
    rng = np.random.default_rng(0)
    bad = tmp_path / "flipped.npz"
    refused = 0
    for _ in range(150):
        damaged = bytearray(whole)
        damaged[int(rng.integers(len(whole)))] ^= int(rng.integers(1, 256))
        bad.write_bytes(bytes(damaged))
        try:
            Episode.load(bad)
        except RecordError:
            refused += 1
    assert refused > 100


@pytest.mark.parametrize("content", [b"", b"hello", b"PK\x05\x06" + bytes(18)])
def test_other_files_are_refused(tmp_path: Path, content: bytes) -> None:
    bad = tmp_path / "other.npz"
    bad.write_bytes(content)
    with pytest.raises(RecordError):
        Episode.load(bad)


def test_a_single_array_is_refused(tmp_path: Path) -> None:
    buffer = io.BytesIO()
    np.save(buffer, np.zeros(3))
    bad = tmp_path / "array.npz"
    bad.write_bytes(buffer.getvalue())
    with pytest.raises(RecordError, match="no episode record"):
        Episode.load(bad)


def test_no_such_record(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match="There is no episode record"):
        Episode.load(tmp_path / "none.npz")


def test_an_unwritable_place_leaves_nothing(pursuit: Episode, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="Cannot write"):
        pursuit.save(tmp_path / "no" / "such" / "folder" / "episode.npz")
    assert list(tmp_path.iterdir()) == []
