"""Text files, and the JSON and YAML in them, or a sentence why not."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import yaml

from maps.errors import PlanError

__all__ = ["load_json", "load_yaml", "read_text"]


class _NotFiniteError(Exception):
    """Carries the NaN or Infinity that Python's reader would take, though JSON has no such numbers."""


def read_text(path: Path, where: str) -> str:
    """Read a UTF-8 text file; PlanError if it cannot be read or is not text."""
    try:
        return path.read_text(encoding="utf-8-sig")
    except OSError as exc:
        raise PlanError(f"{where}: the file cannot be read ({exc.strerror}).") from exc
    except UnicodeDecodeError as exc:
        raise PlanError(f"{where}: the file is not text, so it is not what {path.suffix} says.") from exc


def load_json(path: Path, where: str) -> Any:
    """Load a JSON file; PlanError if it is none, or holds numbers that are not finite."""
    text = read_text(path, where)
    try:
        return json.loads(text, parse_constant=_no_number)
    except _NotFiniteError as exc:
        raise PlanError(f"{where}: there is a {exc} in it; coordinates must be finite numbers.") from exc
    except (json.JSONDecodeError, RecursionError) as exc:
        place = f" at line {exc.lineno}, column {exc.colno}: {exc.msg}" if isinstance(exc, json.JSONDecodeError) else ""
        raise PlanError(f"{where}: the file is not valid JSON{place}.") from exc


def load_yaml(path: Path, where: str) -> dict[str, Any]:
    """Load a YAML file whose top is a mapping; PlanError otherwise."""
    text = read_text(path, where)
    try:
        data = yaml.safe_load(text)
    except (yaml.YAMLError, RecursionError) as exc:
        mark = getattr(exc, "problem_mark", None)
        place = f" at line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        raise PlanError(f"{where}: the file is not valid YAML{place}.") from exc
    if not isinstance(data, dict):
        raise PlanError(f"{where}: a map's YAML file is a list of keys and values, not a {type(data).__name__}.")
    return data


def _no_number(constant: str) -> float:
    raise _NotFiniteError(constant)
