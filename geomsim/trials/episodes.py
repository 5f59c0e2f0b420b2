"""Trials that each need a world of their own."""

from __future__ import annotations

import numpy as np

from discretize import WallGrid
from geomsim.pursuit import run_episode
from geomsim.trials.bank import Meetings
from geomsim.trials.experiment import Experiment

__all__ = ["run_episodes"]


def run_episodes(experiment: Experiment, method: int, trials: list[int]) -> Meetings:
    """Run some trials of a method, each as an episode of its own."""
    from geomsim.trials.kernels import blocked_moves

    found, grid = Meetings(), WallGrid.of(experiment.cells.plan.walls)
    for k in trials:
        episode = run_episode(
            experiment.cells.plan,
            experiment.cells,
            experiment.team_for(method),
            experiment.evader,
            seed=experiment.seeds[k],
            team_seed=experiment.seeds[k % experiment.team_runs],
            capture=experiment.capture,
            motion=experiment.motion,
            timing=experiment.timing,
        )
        steps, out = len(episode.times) - 1, episode.outcome
        tracks = np.concatenate([episode.pursuers, episode.evaders], axis=1)
        found.crossings += blocked_moves(grid, tracks)
        found.evader_steps += steps
        if any("evader" in note.lower() for note in out.notes):
            found.held_up.add(k)
        if out.pursuer is None or out.cell is None or out.position is None:
            found.rows.append(experiment.row(method, k, steps, captured=False))
            continue
        x, y = (round(float(np.float32(v)), 3) for v in out.position)
        found.rows.append(
            experiment.row(method, k, steps, captured=True, pursuer=out.pursuer + 1, cell=out.cell + 1, x=x, y=y)
        )
    return found
