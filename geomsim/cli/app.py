"""The command line's frame: its commands, and what becomes of errors."""

from __future__ import annotations

import signal
import sys
from collections.abc import Sequence
from typing import Any

from cyclopts import App, CycloptsError

from geomsim.cli.console import complain

__all__ = ["main"]

app = App(
    name="geomsim",
    help="Find somebody who moves about a building, with a team of robots.",
    help_epilogue="Exit codes: 0 done, 2 bad input, 130 interrupted. --debug shows where an error comes from.",
    result_action="return_value",
    version_flags=["--version"],
    version=lambda: _version(),
)
# a name of a module and a function in it: a command's code is imported when the command is called
app.command("geomsim.cli.run:run", name="run", help="One pursuit: record, video, snapshots.")
app.command(
    "geomsim.cli.discretize:discretize",
    name="discretize",
    help="A floor plan cut into cells: GeoJSON, picture, report.",
)
app.command("geomsim.cli.render:render", name="render", help="Pictures and video from a saved episode.")
app.command("geomsim.cli.listing:maps", name="maps", help="The bundled floor plans.")
app.command("geomsim.cli.listing:planners", name="planners", help="The planners, each with its source.")


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command line and exit: 0 done, 2 bad input, 130 interrupted, 1 a fault of the program itself."""
    tokens = list(sys.argv[1:] if argv is None else argv)
    debug = "--debug" in tokens
    tokens = [token for token in tokens if token != "--debug"]
    signal.signal(signal.SIGTERM, _interrupt)
    try:
        code = app(tokens, exit_on_error=False, print_error=False)
    except Exception as exc:
        if debug:
            raise
        code = _explain(exc)
    except KeyboardInterrupt:
        complain("Interrupted.")
        code = 130
    sys.exit(code if isinstance(code, int) else 0)


def _explain(exc: Exception) -> int:
    """Print the sentence of an error and return the exit code."""
    from maps import GeomsimError

    if isinstance(exc, GeomsimError):
        complain(str(exc))
        return 2
    if isinstance(exc, CycloptsError):
        complain(" ".join(str(exc).split()))
        return 2
    if isinstance(exc, BrokenPipeError):
        return 0
    if isinstance(exc, MemoryError):
        complain("There is not enough memory for this plan or scenario.")
        return 2
    complain(f"A fault of geomsim itself, please report it: {type(exc).__name__}: {exc} (--debug shows where).")
    return 1


def _interrupt(*_: Any) -> None:
    raise KeyboardInterrupt


def _version() -> str:
    from importlib.metadata import version

    return version("geomsim")
