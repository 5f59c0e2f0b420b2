"""Many trials at once: a bank of evaders, one run of the team for each method, compiled sight, statistics."""

from geomsim.trials.engine import ENGINES, run_trials
from geomsim.trials.experiment import Row
from geomsim.trials.methods import default_methods, parse_method
from geomsim.trials.results import MethodSummary, Summary, Trials
from geomsim.trials.workforce import dask_executor

__all__ = [
    "ENGINES",
    "MethodSummary",
    "Row",
    "Summary",
    "Trials",
    "dask_executor",
    "default_methods",
    "parse_method",
    "run_trials",
]
