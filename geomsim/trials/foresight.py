"""What a method's capture curve will be where capture is by sight, from the ways its robots go."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from geomsim.trials.experiment import Experiment
from geomsim.trials.fidelity import Forecast
from geomsim.trials.teamruns import TeamRun
from geomsim.watching import Track, Watch, expected_looks

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
        Its mean counts who is never seen with the time limit.
    """
    timing, team = experiment.timing, experiment.team
    watch = Watch(experiment.cells, experiment.motion, experiment.evader.speed, timing.physics_step)
    first, sensors = watch.first_belief(experiment.starts), team.sensors
    curves = [watch.survival(Track(run.eyes, run.headings, timing.physics_step), sensors, first) for run in runs]
    means = [expected_looks(curve, timing.limit / watch.step) * watch.step for curve in curves]
    length = max(map(len, curves))
    free = np.mean([np.pad(curve, (0, length - len(curve)), mode="edge") for curve in curves], axis=0)
    return Forecast(float(np.mean(means)), free, watch.step, watch.begin)
