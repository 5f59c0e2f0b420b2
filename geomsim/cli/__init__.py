"""The command line: ``geomsim run | discretize | render | maps | planners``."""

import sys
from collections.abc import Sequence

__all__ = ["main"]


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command line and exit: 0 done, 2 bad input, 130 interrupted, 1 a fault of the program itself."""
    try:
        # imported here, so that Ctrl-C is also heard while the libraries are loaded
        from geomsim.cli.app import run_app
    except KeyboardInterrupt:
        sys.stderr.write("geomsim: Interrupted.\n")
        sys.exit(130)
    run_app(sys.argv[1:] if argv is None else argv)
