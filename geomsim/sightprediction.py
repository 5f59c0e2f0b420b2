"""When a team will see the evader, without sampling evaders: its run in the world, and a belief over places."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from discretize import CellMap
from geomsim.curves import lengthened, mean_time
from geomsim.particles import Swarm
from geomsim.pursuit import Timing
from geomsim.seeds import Streams, trial_seeds
from geomsim.team import Evader, Team
from geomsim.teamwork import Teamwork
from geomsim.watching import Lookout, Watch
from planners import Decision, MotionModel, Planner, Policy, Prediction, SearchProblem, SearchState

__all__ = ["predict_sight"]

#: runs of a team whose planner draws random numbers; the prediction is their mean
_RUNS = 20

_RESIDUE = 1e-5


def predict_sight(
    cells: CellMap,
    team: Team,
    starts: Sequence[int],
    evader: Evader,
    motion: MotionModel,
    timing: Timing,
    seed: int,
    *,
    particles: bool = False,
) -> Prediction:
    """Return the distribution of the time to sight.

    The team goes its ways in the world, which do not depend on an evader that it has not seen. A belief over places
    follows, see :class:`geomsim.watching.Watch`. For a planner that draws no random numbers that is exact, as far as
    places are; for others it is the mean of 20 runs.

    Parameters
    ----------
    cells : CellMap
        Where.
    team : Team
        Who searches.
    starts : sequence of int
        The cell in which each pursuer starts, counted from 0.
    evader : Evader
        Who is searched for, see :class:`geomsim.watching.Watch`; of several the last one counts.
    motion : MotionModel
        What the team believes of its motion.
    timing : Timing
        Clocks; the prediction ends at their limit.
    seed : int
        The planner's chance comes from it, and that of particles.
    particles : bool
        Whether to follow particles instead, see :class:`geomsim.particles.Swarm`.

    Returns
    -------
    Prediction
        Its curve has a value for each look, at ``LOOK_STEP`` from each other.
    """
    watch = Watch(cells, evader, timing.physics_step)
    seeds = trial_seeds(seed, _RUNS)
    belief = watch.first_belief(starts)

    def follow(seed: int) -> _Run:
        chance = np.random.default_rng(seed)
        looker = Swarm(watch, team.sensors, belief, chance) if particles else watch.lookout(team.sensors, belief)
        return _Run(looker, watch.every, cells, team, starts, motion, timing, seed)

    runs = [follow(seeds[0])]
    if runs[0].drew:
        runs += [follow(one) for one in seeds[1:]]
    curves = [1.0 - (1.0 - run.curve) ** evader.count for run in runs]
    length = max(map(len, curves))
    free = np.mean([lengthened(curve, length) for curve in curves], axis=0)
    mean = float(np.mean([mean_time(curve, watch.step, timing.limit) for curve in curves]))
    paths = runs[0].paths if len(runs) == 1 else ((),) * team.pursuers
    return Prediction(tuple(starts), mean, free, paths, float(np.mean([run.seconds_per_plan for run in runs])))


class _Run:
    """One run of a team, followed until the evader is as good as seen."""

    def __init__(
        self,
        looker: Lookout | Swarm,
        every: int,
        cells: CellMap,
        team: Team,
        starts: Sequence[int],
        motion: MotionModel,
        timing: Timing,
        seed: int,
    ) -> None:
        chance = Streams(seed).deciding
        fresh, clocked = chance.bit_generator.state, _Clocked(team.planner)
        timed = replace(team, planner=clocked)
        work = Teamwork(cells, timed, starts, motion, timing.belief_step, [chance])
        curve: list[float] = []
        for k in range(timing.steps):
            work.step(k * timing.physics_step, timing.physics_step)
            if (k + 1) % timing.steps_per_belief == 0:
                work.learn()
            if k % every == 0:
                curve.append(looker.look(work.positions[0], work.headings[0]))
                if curve[-1] < _RESIDUE:
                    break
        self.curve, self.drew = np.array(curve), chance.bit_generator.state != fresh
        gone: list[list[int]] = [[] for _ in starts]
        for choice in work.choices:
            gone[choice.pursuer].append(choice.path[0])
        self.paths = tuple(map(tuple, gone))
        self.seconds_per_plan = clocked.seconds / max(1, clocked.decisions)


@dataclass(slots=True)
class _Clocked:
    """A planner whose decisions are timed."""

    planner: Planner
    seconds: float = 0.0
    decisions: int = 0

    def solve(self, problem: SearchProblem, rng: np.random.Generator) -> Policy:
        """Prepare the planner's policy."""
        return _ClockedPolicy(self, self.planner.solve(problem, rng))


@dataclass(frozen=True, slots=True)
class _ClockedPolicy:
    clock: _Clocked
    policy: Policy

    def decide(self, state: SearchState) -> Sequence[Decision | None]:
        begun = time.perf_counter()
        decisions = self.policy.decide(state)
        self.clock.seconds += time.perf_counter() - begun
        self.clock.decisions += 1
        return decisions
