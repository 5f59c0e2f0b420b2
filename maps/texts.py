"""Files read and written whole, and the text, JSON and YAML in them, or a sentence why not."""

from __future__ import annotations

import errno
import json
import os
import stat
from contextlib import suppress
from pathlib import Path
from typing import Any

import yaml

from maps.errors import GeomsimError, PlanError, shortened, shown

__all__ = ["LARGEST_FILE", "check_file", "load_json", "load_yaml", "read_bytes", "read_text", "reason", "write_whole"]

LARGEST_FILE = 1_000_000_000
"""A file of more bytes than this is not read."""

MOST_DIGITS = 300
"""A whole number in JSON may have as many digits as a floating-point number can have before the point, about."""

MOST_SIGNS = 10_000_000
"""A YAML file may be so long if it is written without aliases, about."""


class _BadNumberError(Exception):
    """Carries the NaN or Infinity that Python's reader would take, though JSON has none, or a number too long."""


def check_file(path: Path, where: str, error: type[GeomsimError] = PlanError) -> None:
    """Raise ``error`` unless a path is a file that ends: a pipe or a device could keep its reader for ever."""
    try:
        about = path.stat()
    except (OSError, ValueError) as exc:
        raise error(f"{where}: {_the_file(path, where)} cannot be read ({reason(exc)}).") from exc
    if stat.S_ISDIR(about.st_mode):
        raise error(f"{where}: {_the_file(path, where)} is a folder.")
    if not stat.S_ISREG(about.st_mode):
        raise error(f"{where}: {_the_file(path, where)} is a pipe or a device and may never end.")
    if about.st_size > LARGEST_FILE:
        raise error(
            f"{where}: {_the_file(path, where)} has {about.st_size} bytes; at most {LARGEST_FILE} are possible."
        )


def read_bytes(path: Path, where: str, error: type[GeomsimError] = PlanError) -> bytes:
    """Read a file; ``error`` if it cannot be read, is no file that ends or is larger than ``LARGEST_FILE``."""
    check_file(path, where, error)
    try:
        return path.read_bytes()
    except OSError as exc:
        raise error(f"{where}: {_the_file(path, where)} cannot be read ({reason(exc)}).") from exc


def read_text(path: Path, where: str, error: type[GeomsimError] = PlanError) -> str:
    """Read a UTF-8 text file, with a byte order mark or without; ``error`` if it cannot be read or is not text."""
    try:
        return read_bytes(path, where, error).decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as exc:
        raise error(f"{where}: the file is not text, so it is not what {path.suffix} says.") from exc


def write_whole(path: Path, content: bytes) -> None:
    """Write a file whole, or leave what was there before; OSError or ValueError if it cannot be written."""
    part = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
    try:
        part.write_bytes(content)
        part.replace(path)
    finally:
        with suppress(OSError, ValueError):  # it has its name by now, or never was
            part.unlink()


def reason(exc: OSError | ValueError) -> str:
    """Say in a few words why the system does not give a file."""
    if isinstance(exc, ValueError):
        return "there is a null character in its name"
    if exc.errno == errno.ELOOP:
        return "it is a symbolic link that leads to itself"
    return exc.strerror or str(exc)


def load_json(path: Path, where: str, error: type[GeomsimError] = PlanError) -> Any:
    """Load a JSON file; ``error`` if it is none, or holds numbers that are not finite or endlessly long."""
    text = read_text(path, where, error)
    try:
        data = json.loads(text, parse_constant=_no_number, parse_int=_whole)
    except _BadNumberError as exc:
        raise error(f"{where}: there is {exc} in it; coordinates must be finite numbers.") from exc
    except (json.JSONDecodeError, RecursionError) as exc:
        place = f" at line {exc.lineno}, column {exc.colno}: {exc.msg}" if isinstance(exc, json.JSONDecodeError) else ""
        raise error(f"{where}: the file is not valid JSON{place}.") from exc
    if "\\ud" in text.lower():  # what stands for half a character could be read, but never be written again
        try:
            json.dumps(data, ensure_ascii=False).encode()
        except UnicodeEncodeError as exc:
            half = f"\\u{ord(exc.object[exc.start]):04x}"
            raise error(f"{where}: the file is not valid JSON: {half} in it is half a character.") from exc
    return data


def load_yaml(path: Path, where: str) -> dict[str, Any]:
    """Load a YAML file whose top is a mapping; PlanError otherwise, or if its aliases stand for endless values."""
    text = read_text(path, where)
    try:
        data = yaml.load(text, _Loader)
    except (yaml.YAMLError, RecursionError) as exc:
        mark = getattr(exc, "problem_mark", None)
        place = f" at line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        problem = f": {exc.problem}" if isinstance(exc, _UnusableError) else ""
        raise PlanError(f"{where}: the file is not valid YAML{place}{problem}.") from exc
    if not isinstance(data, dict):
        raise PlanError(f"{where}: a map's YAML file is a list of keys and values, not a {type(data).__name__}.")
    return data


class _UnusableError(yaml.constructor.ConstructorError):
    """YAML whose syntax is right, with a problem in our own words."""

    def __init__(self, problem: str, node: yaml.Node) -> None:
        super().__init__(None, None, problem, node.start_mark)


class _Loader(yaml.SafeLoader):
    """PyYAML's safe loader, safe from what it lets through: aliases of aliases, and values that Python cannot hold."""

    def get_single_node(self) -> yaml.Node | None:
        """Compose the document; see that it stays small when its aliases are followed."""
        node: yaml.Node | None = super().get_single_node()
        if node is not None:
            _length(node, {})
        return node

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        """Make the value of a node."""
        try:
            return super().construct_object(node, deep)
        except (ValueError, LookupError, TypeError, AttributeError, ArithmeticError) as exc:
            kind = node.tag.rpartition(":")[2]
            raise _UnusableError(f"{shown(node.value)} is no {kind} that can be read", node) from exc


def _length(node: yaml.Node, known: dict[int, int]) -> int:
    """About how many signs a node takes without aliases; in ``known``, 0 for what is a node around it."""
    if id(node) in known:
        if known[id(node)] == 0:
            raise _UnusableError("a value holds itself", node)
        return known[id(node)]
    known[id(node)] = 0
    inner = node.value
    if isinstance(node, yaml.ScalarNode):
        total = 1 + len(inner)
    elif isinstance(node, yaml.MappingNode):
        total = 1 + sum(_length(part, known) for pair in inner for part in pair)
    else:
        total = 1 + sum(_length(part, known) for part in inner)
    if total > MOST_SIGNS:
        raise _UnusableError("its aliases stand for too much", node)
    known[id(node)] = total
    return total


def _whole(digits: str) -> int:
    if len(digits) > MOST_DIGITS:
        raise _BadNumberError(f"a number of {len(digits)} digits, {digits[:12]}...")
    return int(digits)


def _no_number(constant: str) -> float:
    raise _BadNumberError(f"a {constant}")


def _the_file(path: Path, where: str) -> str:
    return "the file" if str(path) == where else f"the file {shortened(str(path))}"
