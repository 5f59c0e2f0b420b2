"""Reading XML that a stranger wrote, with the ``formats`` extra: no entities, nothing from elsewhere."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from maps.errors import PlanError
from maps.extras import need

__all__ = ["kind_of", "read_xml"]


def read_xml(path: Path, root_kind: str, name: str) -> Any:
    """Return the root element of an XML file.

    Parameters
    ----------
    path : Path
        The file.
    root_kind : str
        What its root must be, without a namespace.
    name : str
        What a file with such a root is called.

    Raises
    ------
    PlanError
        If the file cannot be read, is no valid XML, defines entities, or has another root.
    """
    tree = need("defusedxml.ElementTree", str(path))
    common = need("defusedxml.common", str(path))
    try:
        root = tree.parse(path).getroot()
    except OSError as exc:
        raise PlanError(f"{path}: the file cannot be read ({exc.strerror}).") from exc
    except (tree.ParseError, common.DefusedXmlException, ValueError) as exc:
        raise PlanError(f"{path}: the file is not valid XML ({exc}).") from exc
    if kind_of(root) != root_kind:
        raise PlanError(f"{path}: this is not {name}; its root is {kind_of(root)!r}, not {root_kind!r}.")
    return root


def kind_of(element: Any) -> str:
    """Return the name of an element without its namespace."""
    return str(element.tag).rpartition("}")[2]
