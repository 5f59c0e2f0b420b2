"""Episode records on disk: one compressed ``.npz`` of plain arrays, no pickles, the same bytes for the same episode."""

from __future__ import annotations

import itertools
import json
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from discretize import CellMap, Portal
from geomsim.episode import Capture, Episode, Outcome, Status
from geomsim.files import replacing
from geomsim.recordchecks import PLAIN, check_shapes, check_types, check_values
from maps import FloorPlan, GeomsimError, Label, Repair

__all__ = ["FORMAT", "RecordError", "read_record", "write_record"]

#: raised by one whenever a reader of the format before would misread a record
FORMAT = 2
_KIND = "geomsim episode"
_ABOUT_CELLS = ("radius", "method", "names", "tolerance", "strict", "notes")


class RecordError(GeomsimError):
    """A file that is no episode record, or a damaged one, or one of another format; the message names it."""


def write_record(episode: Episode, path: Path) -> Path:
    """Write an episode.

    Parameters
    ----------
    episode : Episode
        What happened.
    path : Path
        Ends in ``.npz``; replaced if it exists.

    Raises
    ------
    OutputError
        If it cannot be written.
    """
    arrays: dict[str, NDArray[Any]] = {name: getattr(episode, name) for name in PLAIN}
    arrays["decision_paths"], arrays["decision_splits"] = _join(episode.decision_paths, np.dtype(np.int32))
    arrays |= _pack_plan(episode.plan) | _pack_cells(episode.cells)
    outcome = episode.outcome
    meta = {
        "kind": _KIND,
        "format": FORMAT,
        "scenario": episode.scenario,
        "outcome": {
            "status": outcome.status.name,
            "time": outcome.time,
            "pursuer": outcome.pursuer,
            "position": outcome.position,
            "cell": outcome.cell,
            "predicted": outcome.predicted,
            "notes": outcome.notes,
            "evader": outcome.evader,
            "earlier": [asdict(capture) for capture in outcome.earlier],
        },
    }
    arrays["meta"] = _text(meta)
    with replacing(path) as part, part.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)
    return path


def read_record(path: Path) -> Episode:
    """Read an episode that :func:`write_record` wrote.

    Raises
    ------
    RecordError
        If there is no such file, or it is no record, damaged, or of another format.
    """
    try:
        if path.exists() and not path.is_file():
            raise RecordError(f"{path} is no file, so it is no episode record.")
        # opened here, since NumPy leaves a file open that turns out to be no archive
        with path.open("rb") as stream:
            file = np.load(stream, allow_pickle=False)
            if not isinstance(file, np.lib.npyio.NpzFile):
                raise RecordError(f"{path} is no episode record.")
            arrays = {name: file[name] for name in file.files}
    except FileNotFoundError as exc:
        raise RecordError(f"There is no episode record {path}.") from exc
    except (OSError, ValueError, EOFError, zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError) as exc:
        raise RecordError(f"{path} is no episode record, or a damaged one.") from exc
    meta = _meta(arrays, path)
    try:
        check_types(arrays)
        episode = _episode(arrays, meta)
        check_shapes(episode)
        check_values(episode)
    except (KeyError, ValueError, IndexError, TypeError, RecursionError, shapely.errors.ShapelyError) as exc:
        raise RecordError(f"The episode record {path} is damaged: {type(exc).__name__} {exc}") from exc
    return episode


def _meta(arrays: Mapping[str, NDArray[Any]], path: Path) -> dict[str, Any]:
    try:
        meta = json.loads(str(arrays["meta"]))
        kind, version = meta["kind"], meta["format"]
    except (KeyError, TypeError, ValueError, RecursionError) as exc:
        raise RecordError(f"{path} is no episode record.") from exc
    if kind != _KIND or version != FORMAT:
        raise RecordError(f"{path} is a record of format {version!r}, but this version of geomsim reads {FORMAT}.")
    return dict(meta)


def _episode(arrays: Mapping[str, NDArray[Any]], meta: dict[str, Any]) -> Episode:
    plan = _unpack_plan(arrays)
    told = meta["outcome"]
    outcome = Outcome(
        status=Status[told["status"]],
        time=float(told["time"]),
        pursuer=told["pursuer"],
        position=None if told["position"] is None else (float(told["position"][0]), float(told["position"][1])),
        cell=told["cell"],
        predicted=float(told["predicted"]),
        notes=tuple(told["notes"]),
        evader=int(told["evader"]),
        earlier=tuple(_capture(**capture) for capture in told["earlier"]),
    )
    return Episode(
        scenario=meta["scenario"],
        plan=plan,
        cells=_unpack_cells(arrays, plan),
        decision_paths=_split(arrays["decision_paths"], arrays["decision_splits"]),
        outcome=outcome,
        **{name: arrays[name] for name in PLAIN},
    )


def _capture(evader: int, time: float, pursuer: int, position: Sequence[float], cell: int) -> Capture:
    return Capture(int(evader), float(time), int(pursuer), (float(position[0]), float(position[1])), int(cell))


def _text(value: object) -> NDArray[np.str_]:
    return np.array(json.dumps(value, sort_keys=True))


def _join(rows: Sequence[NDArray[Any]], dtype: np.dtype[Any]) -> tuple[NDArray[Any], NDArray[np.int64]]:
    splits = np.cumsum([0, *(len(row) for row in rows)], dtype=np.int64)
    return (np.concatenate(rows) if rows else np.empty(0, dtype)).astype(dtype), splits


def _split(joined: NDArray[Any], splits: NDArray[np.int64]) -> tuple[NDArray[Any], ...]:
    return tuple(joined[a:b] for a, b in itertools.pairwise(splits))


def _wkb(geometries: Sequence[shapely.Geometry]) -> NDArray[np.uint8]:
    return np.frombuffer(shapely.to_wkb(shapely.GeometryCollection(list(geometries))), dtype=np.uint8)


def _geometries(blob: NDArray[np.uint8]) -> list[Any]:
    return list(shapely.get_parts(shapely.from_wkb(blob.tobytes())))


def _pack_plan(plan: FloorPlan) -> dict[str, NDArray[Any]]:
    about = {
        "name": plan.name,
        "source": plan.source,
        "start": plan.start,
        "labels": [[*label.point, label.name, label.number] for label in plan.labels],
        "repairs": [[repair.kind, repair.message] for repair in plan.repairs],
    }
    return {
        "plan": _text(about),
        "plan_space": np.frombuffer(shapely.to_wkb(plan.space), dtype=np.uint8),
        "plan_doors": _wkb(plan.doors),
        "plan_repairs": _wkb([repair.geometry for repair in plan.repairs]),
    }


def _unpack_plan(arrays: Mapping[str, NDArray[Any]]) -> FloorPlan:
    about = json.loads(str(arrays["plan"]))
    space = shapely.from_wkb(arrays["plan_space"].tobytes())
    if not isinstance(space, shapely.Polygon | shapely.MultiPolygon):
        raise ValueError("the free space is no polygon")
    where = _geometries(arrays["plan_repairs"])
    return FloorPlan(
        name=about["name"],
        space=space,
        doors=tuple(_geometries(arrays["plan_doors"])),
        labels=tuple(Label((x, y), name, number) for x, y, name, number in about["labels"]),
        source=about["source"],
        repairs=tuple(Repair(k, m, g) for (k, m), g in zip(about["repairs"], where, strict=True)),
        start=tuple(about["start"]),
    )


def _pack_cells(cells: CellMap) -> dict[str, NDArray[Any]]:
    legs, splits = _join([leg for portal in cells.portals for leg in portal.legs], np.dtype(np.float64))
    return {
        "cells": _wkb(cells.cells),
        "cells_about": _text({key: getattr(cells, key) for key in _ABOUT_CELLS}),
        "checkpoints": cells.checkpoints,
        "portal_cells": np.array(cells.edges, dtype=np.int32).reshape(-1, 2),
        "portal_segments": np.array([portal.segment for portal in cells.portals]).reshape(-1, 2, 2),
        "portal_points": np.array([portal.point for portal in cells.portals]).reshape(-1, 2),
        "portal_legs": legs.reshape(-1, 2),
        "portal_splits": splits,
    }


def _unpack_cells(arrays: Mapping[str, NDArray[Any]], plan: FloorPlan) -> CellMap:
    about = json.loads(str(arrays["cells_about"]))
    legs = _split(arrays["portal_legs"], arrays["portal_splits"])
    rows = zip(
        arrays["portal_cells"].tolist(),
        arrays["portal_segments"],
        arrays["portal_points"],
        legs[::2],
        legs[1::2],
        strict=True,
    )
    return CellMap(
        plan=plan,
        cells=tuple(_geometries(arrays["cells"])),
        portals=tuple(Portal((i, j), segment, point, (near, far)) for (i, j), segment, point, near, far in rows),
        checkpoints=arrays["checkpoints"],
        radius=float(about["radius"]),
        method=about["method"],
        names=tuple(about["names"]),
        tolerance=float(about["tolerance"]),
        strict=bool(about["strict"]),
        notes=tuple(about["notes"]),
    )
