"""The command line's frame: its commands, and what becomes of errors."""

from __future__ import annotations

import signal
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

from cyclopts import App, CycloptsError, UnusedCliTokensError

from geomsim.cli.console import complain, finish_stdout, speak_plainly

__all__ = ["run_app"]

app = App(
    name="geomsim",
    help="Find somebody who moves about a building, with a team of robots.",
    help_epilogue=(
        "Every command also takes --plugin FILE.py or --plugin MODULE, with planners, heuristics, evader models or "
        "readers of your own; it may be given several times. "
        "Exit codes: 0 done, 2 bad input, 130 interrupted. --debug shows where an error comes from."
    ),
    result_action="return_value",
    suppress_keyboard_interrupt=False,
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
app.command("geomsim.cli.predict:predict", name="predict", help="Exact expected capture time, without sampling.")
app.command("geomsim.cli.compare:compare", name="compare", help="Many methods, many trials, the same evaders.")
app.command("geomsim.cli.reproduce:reproduce", name="reproduce", help="The paper's experiments, as a page.")
app.command("geomsim.cli.render:render", name="render", help="Pictures and video from a saved episode.")
app.command("geomsim.cli.convert:convert", name="convert", help="A floor plan from one format into another.")
app.command("geomsim.cli.export:export", name="export", help="Waypoints, ROS map, cells and graph for other programs.")
app.command("geomsim.cli.listing:maps", name="maps", help="The bundled floor plans.")
app.command("geomsim.cli.listing:planners", name="planners", help="The planners, each with its source.")


def run_app(tokens: Sequence[str]) -> NoReturn:
    """Run a command and exit: 0 done, 2 bad input, 130 interrupted, 1 a fault of the program itself."""
    debug = "--debug" in tokens
    tokens = [token for token in tokens if token != "--debug"]
    try:
        signal.signal(signal.SIGTERM, _interrupt)
        speak_plainly()
        tokens = _with_plugins(tokens)
        code = app(tokens, exit_on_error=False, print_error=False)
        finish_stdout()
    except SystemExit as exc:  # Rich's, where the reader of the help has seen enough, like `head`
        code = 0 if isinstance(exc.__context__, BrokenPipeError) else exc.code
    except Exception as exc:
        if debug:
            raise
        code = _explain(exc)
    except KeyboardInterrupt:
        complain("Interrupted.")
        code = 130
    sys.exit(code if isinstance(code, int) else 0)


def _with_plugins(tokens: list[str]) -> list[str]:
    """Load the plugins that are named and, where there is a command, those installed; return the other tokens."""
    named, others, rest = [], [], iter(tokens)
    for token in rest:
        flag, equals, value = token.partition("=")
        if flag != "--plugin":
            others.append(token)
            continue
        value = value if equals else next(rest, "")
        named.append(value)
    if others and not others[0].startswith("-") and "--help" not in others:
        from geomsim.plugins import load_plugins

        load_plugins(named)
    return others


def _explain(exc: Exception) -> int:
    """Print the sentence of an error and return the exit code."""
    from maps import GeomsimError

    if isinstance(exc, UnusedCliTokensError):
        complain(f"Unexpected argument {(exc.unused_tokens or ['?'])[0]!r}.")
        return 2
    if isinstance(exc, GeomsimError | CycloptsError):
        complain(str(exc))
        return 2
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
