"""Packages that only some readers need."""

from __future__ import annotations

import importlib
from typing import Any

from maps.errors import PlanError

__all__ = ["need"]


def need(module: str, where: str) -> Any:
    """Import a module of the ``formats`` extra; PlanError that says how to install it where it is missing."""
    try:
        return importlib.import_module(module)
    except ImportError as exc:
        package = module.partition(".")[0]
        raise PlanError(
            f"{where}: reading this needs the package {package}; install it with: pip install 'geomsim[formats]'."
        ) from exc
