"""The command line: ``geomsim run | discretize | render | maps | planners``."""

from geomsim.cli.app import main

__all__ = ["main"]
