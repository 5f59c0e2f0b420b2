"""Planners, heuristics, evader models and readers of a user's own, found by name once they are loaded.

A plugin is a Python module that registers what it brings when it is imported, with :func:`geomsim.register_planner`,
:func:`geomsim.register_cost`, :func:`geomsim.register_evader` or :func:`geomsim.register_format`. An installed package
names its module in the entry-point group ``geomsim.plugins`` and is found by itself; a file or another module is
given to the command line with ``--plugin``.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.metadata import entry_points
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

from maps import GeomsimError

__all__ = ["GROUP", "PluginError", "load_plugins"]

GROUP = "geomsim.plugins"


class PluginError(GeomsimError):
    """A plugin that cannot be found or imported; the message names it."""


def load_plugins(named: Sequence[str] = (), *, installed: bool = True) -> None:
    """Load plugins; those that are loaded already stay as they are.

    Parameters
    ----------
    named : sequence of str
        Files that end in ``.py``, or names of modules.
    installed : bool
        Whether to load what installed packages bring, too.

    Raises
    ------
    PluginError
        If one is not found or cannot be imported, for whatever reason.
    """
    brought = [(entry.name, entry.module) for entry in entry_points(group=GROUP)] if installed else []
    if "" in named:
        raise PluginError("A plugin is a file that ends in .py or the name of a module; got none.")
    for name, module in [*brought, *((name, name) for name in named)]:
        try:
            if module.endswith(".py"):
                _import_file(Path(module))
            else:
                import_module(module)
        except PluginError:
            raise
        except GeomsimError as exc:
            raise PluginError(f"The plugin {name} cannot be used. {exc}") from exc
        except Exception as exc:  # whatever somebody else's module may raise
            raise PluginError(f"The plugin {name} cannot be imported: {type(exc).__name__}: {exc}.") from exc


def _import_file(path: Path) -> None:
    """Import a file as a module of its name, so that what it defines can be pickled."""
    path = path.resolve()
    known = sys.modules.get(path.stem)
    if known is not None:
        if getattr(known, "__file__", None) == str(path):
            return
        raise PluginError(f"The plugin {path} has the name of another module, {path.stem}: rename the file.")
    if not path.is_file():
        raise PluginError(f"There is no plugin {path}.")
    spec = spec_from_file_location(path.stem, path)
    if spec is None or spec.loader is None:
        raise PluginError(f"The plugin {path} is no Python module.")
    module = module_from_spec(spec)
    sys.modules[path.stem] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[path.stem]
        raise
