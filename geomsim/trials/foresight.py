"""What a method's capture curve will be where capture is by sight, from the ways its robots go."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from geomsim.curves import lengthened, mean_time
from geomsim.trials.experiment import Experiment
from geomsim.trials.fidelity import Forecast
from geomsim.trials.teamruns import TeamRun
from geomsim.watching import Track, Watch

__all__ = ["foresee"]


def foresee(experiment: Experiment, runs: Sequence[TeamRun]) -> Forecast:
    """Predict when the robots of one method will see the evader, by a belief over places.

    Parameters
    ----------
    experiment : Experiment
        What is compared, with capture by sight.
    runs : sequence of TeamRun
        The method's runs; the forecast is the mean over them.

    Returns
    -------
    Forecast
        Its mean counts who is never seen with the time limit; of several evaders the last one counts.
    """
    timing, team = experiment.timing, experiment.team
    watch = Watch(experiment.cells, experiment.evader, timing.physics_step)
    first, sensors = watch.first_belief(experiment.starts), team.sensors
    curves = [watch.survival(Track(run.eyes, run.headings, timing.physics_step), sensors, first) for run in runs]
    curves = [1.0 - (1.0 - curve) ** experiment.evader.count for curve in curves]
    mean = float(np.mean([mean_time(curve, watch.step, timing.limit) for curve in curves]))
    length = max(map(len, curves))
    free = np.mean([lengthened(curve, length) for curve in curves], axis=0)
    return Forecast(mean, free, watch.step, watch.begin)
