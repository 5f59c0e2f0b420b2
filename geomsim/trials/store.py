"""Results on disk as they come: a folder that outlives any interruption."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import astuple, fields
from pathlib import Path
from typing import Any

from geomsim.files import OutputError, output_folder, replacing, write_text
from geomsim.trials.experiment import Row
from maps import GeomsimError

__all__ = ["Store", "StoreError", "read_rows"]

FORMAT = 1
_KIND = "geomsim trials"
_ABOUT, _TABLE = "experiment.json", "trials.csv"
_COLUMNS = [f.name for f in fields(Row)]


class StoreError(GeomsimError):
    """A results folder that belongs to something else, or is damaged."""


class Store:
    """The results of one experiment in a folder.

    A row is appended, whole, as soon as a trial is decided. Opening the folder again with the same experiment repairs
    a last line that was cut off, and gives back what is there.

    Parameters
    ----------
    folder : Path
        Made if need be.
    about : mapping
        What the results depend on, in plain values.

    Attributes
    ----------
    rows : list of Row
        What was there already.

    Raises
    ------
    StoreError
        If the folder holds anything else, or results of another experiment or another format.
    OutputError
        If it cannot be written.
    """

    def __init__(self, folder: Path, about: Mapping[str, Any]) -> None:
        self.folder = output_folder(folder)
        self._table = folder / _TABLE
        told = {"kind": _KIND, "format": FORMAT, **json.loads(json.dumps(about))}
        if (folder / _ABOUT).exists():
            _compare(folder / _ABOUT, told)
        elif others := sorted(p.name for p in folder.iterdir() if not p.name.startswith(".")):
            raise StoreError(
                f"The folder {folder} holds no results of trials but {others[0]!r}; choose another one with --out."
            )
        else:
            write_text(folder / _ABOUT, json.dumps(told, indent=1) + "\n")
        self.rows: list[Row] = []
        if self._table.exists():
            self.rows = read_rows(self._repaired())
        if not self._table.exists() or self._table.stat().st_size == 0:
            self._write(_line(_COLUMNS))

    def append(self, rows: Iterable[Row]) -> None:
        """Append rows; once this returns, the system has them."""
        self._write("".join(_line(astuple(row)) for row in rows))

    def finish(self, rows: Sequence[Row]) -> dict[str, Path]:
        """Put the table in order, and write it as Parquet too where pyarrow is installed; return the files."""
        write_text(self._table, _line(_COLUMNS) + "".join(_line(astuple(row)) for row in rows))
        files = {"trials": self._table}
        try:
            import pyarrow
            from pyarrow import parquet
        except ImportError:
            return files
        files["parquet"] = self.folder / "trials.parquet"
        columns = {name: [getattr(row, name) for row in rows] for name in _COLUMNS}
        with replacing(files["parquet"]) as part:
            parquet.write_table(pyarrow.table(columns), part)
        return files

    def _write(self, text: str) -> None:
        try:
            with self._table.open("a", encoding="utf-8", newline="") as file:
                file.write(text)
        except OSError as exc:
            raise OutputError(f"Cannot write {self._table}: {exc.strerror or exc}.") from exc

    def _repaired(self) -> Path:
        data = self._table.read_bytes()
        whole = data.rfind(b"\n") + 1
        if whole < len(data):
            with self._table.open("r+b") as file:
                file.truncate(whole)
        return self._table


def read_rows(path: Path) -> list[Row]:
    """Read a table of trials.

    Raises
    ------
    StoreError
        If it is no such table; the message names the line.
    """
    with path.open(encoding="utf-8", newline="") as file:
        reader = csv.reader(file)
        rows: list[Row] = []
        try:
            for number, values in enumerate(reader, start=1):
                if number > 1:
                    rows.append(_row(values))
                elif values != _COLUMNS:
                    raise ValueError("its columns are others")
        except (ValueError, csv.Error) as exc:
            raise StoreError(f"{path}, line {reader.line_num}, is no row of a table of trials: {exc}.") from exc
    return rows


def _row(values: list[str]) -> Row:
    told = dict(zip(_COLUMNS, values, strict=True))
    whole = {key: int(told[key]) for key in ("trial", "seed", "team_seed", "start")}
    if told["captured"] not in ("True", "False"):
        raise ValueError(f"captured is {told['captured']!r}")
    captured = told["captured"] == "True"
    return Row(
        method=told["method"],
        **whole,
        captured=captured,
        time=float(told["time"]),
        pursuer=int(told["pursuer"]) if captured else None,
        cell=int(told["cell"]) if captured else None,
        x=float(told["x"]) if captured else None,
        y=float(told["y"]) if captured else None,
    )


def _line(values: Sequence[object]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(values)
    return text.getvalue()


def _compare(path: Path, told: Mapping[str, Any]) -> None:
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        kind = found["kind"]
    except (OSError, UnicodeDecodeError, json.JSONDecodeError, TypeError, KeyError) as exc:
        raise StoreError(f"{path} does not describe results of trials; choose another folder with --out.") from exc
    if kind != _KIND or found.get("format") != FORMAT:
        raise StoreError(
            f"{path} is of format {found.get('format')!r}, but this version of geomsim goes on with format {FORMAT}; "
            "choose another folder with --out."
        )
    for key in sorted({*found, *told}):
        if found.get(key) != told.get(key):
            raise StoreError(
                f"The folder {path.parent} holds results of another experiment: its {key} is {found.get(key)!r}, not "
                f"{told.get(key)!r}. Choose another one with --out, or remove it."
            )
