"""The episode loop: Algorithm 1 of Hollinger, Kehagias and Singh, in a continuous world."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from discretize import CellMap
from geomsim.episode import Capture, Episode, Outcome, Status
from geomsim.quarry import Quarry
from geomsim.seeds import Streams
from geomsim.team import Evader, Team, place_evader, place_team
from geomsim.teamwork import Teamwork
from geomsim.walking import Routes
from maps import FloorPlan
from planners import MotionModel

if TYPE_CHECKING:
    from geomsim.pursuit import Timing

__all__ = ["HELD_UP", "Chase"]

#: a body that is held up for so long is reported, seconds
HELD_UP = 10.0


@dataclass(slots=True)
class _Log:
    """What has happened so far."""

    times: list[float] = field(default_factory=list)
    pursuers: list[NDArray[np.float64]] = field(default_factory=list)
    evaders: list[NDArray[np.float64]] = field(default_factory=list)
    headings: list[NDArray[np.float64]] = field(default_factory=list)
    pursuer_cells: list[NDArray[np.int32]] = field(default_factory=list)
    evaders_cells: list[NDArray[np.int32]] = field(default_factory=list)
    belief_times: list[float] = field(default_factory=list)
    beliefs: list[NDArray[np.float64]] = field(default_factory=list)
    own_beliefs: list[NDArray[np.float64]] = field(default_factory=list)
    decisions: list[tuple[float, int, tuple[int, ...]]] = field(default_factory=list)

    def episode(self, scenario: dict[str, Any], plan: FloorPlan, cells: CellMap, outcome: Outcome) -> Episode:
        """Make the record; Ctrl-C may have left some lists one entry longer."""
        n, b = len(self.times), len(self.belief_times)
        return Episode(
            scenario=scenario,
            plan=plan,
            cells=cells,
            times=np.array(self.times),
            pursuers=np.array(self.pursuers[:n]),
            headings=np.array(self.headings[:n]),
            pursuer_cells=np.array(self.pursuer_cells[:n], dtype=np.int32),
            evaders=np.array(self.evaders[:n]),
            evaders_cells=np.array(self.evaders_cells[:n], dtype=np.int32),
            belief_times=np.array(self.belief_times),
            beliefs=np.array(self.beliefs[:b]),
            own_beliefs=np.array(self.own_beliefs[:b]),
            decision_times=np.array([time for time, _, _ in self.decisions]),
            decision_pursuers=np.array([who for _, who, _ in self.decisions], dtype=np.int32),
            decision_paths=tuple(np.array(path, dtype=np.int32) for _, _, path in self.decisions),
            outcome=outcome,
        )


class Chase:
    """A running episode: the team at work, and the evaders.

    Parameters
    ----------
    cells : CellMap
        Where.
    team, evader : Team, Evader
        Who.
    seeds : tuple of int
        Of the evaders, and of the team.
    capture : str
        The capture rule.
    motion : MotionModel
        What the team believes of the evaders' motion.
    timing : Timing
        Clocks.
    crew : type
        How the team goes: from checkpoint to checkpoint, as its planner says, or otherwise.
    """

    def __init__(
        self,
        cells: CellMap,
        team: Team,
        evader: Evader,
        seeds: tuple[int, int],
        capture: str,
        motion: MotionModel,
        timing: Timing,
        crew: type[Teamwork] = Teamwork,
    ) -> None:
        theirs, ours = Streams(seeds[0]), Streams(seeds[1])
        starts = place_team(cells, team)
        self.team, self.capture, self.timing = team, capture, timing
        placing, them = theirs.placing, range(evader.count)
        hideouts = [place_evader(cells, evader, starts, placing) for _ in them]
        self.work = crew(cells, team, starts, motion, timing.belief_step, [ours.deciding], evader.count)
        chance = [theirs.moving_of(k) for k in them]
        self.quarry = Quarry(cells.plan.walls, Routes(cells), evader, hideouts, chance)
        self.patience = theirs.noticing.exponential(size=(evader.count, team.pursuers))
        self.looked = np.zeros_like(self.patience)
        self.measuring = theirs.measuring
        self.captures: list[Capture] = []
        self.held_up: set[int] = set()
        self.log = _Log()

    def run(self, progress: Callable[[float, float], None] | None) -> Outcome:
        """Step until everyone is captured, the time limit or Ctrl-C."""
        dt, status = self.timing.physics_step, Status.TIME_LIMIT
        try:
            self.begin()
            for k in range(self.timing.steps):
                if self.is_over:
                    break
                self.quarry.robots = self.work.positions[0]
                self.work.step(k * dt, dt)
                self.settle(k)
                if progress is not None and (k + 1) % self.timing.steps_per_belief == 0:
                    progress(self.log.times[-1], float(self.work.beliefs[0, 0]))
        except KeyboardInterrupt:
            status = Status.INTERRUPTED
        return self.outcome(status)

    @property
    def is_over(self) -> bool:
        """Whether everyone is captured."""
        return not self.work.crews[0].free.any()

    def begin(self) -> None:
        """Note how it begins, and let the robots look."""
        self._note(0.0)
        self._believe(0.0)
        self._look(0.0)

    def settle(self, k: int) -> None:
        """Let the evaders move in physics step ``k``, in which the team has moved already; then the robots look."""
        self.quarry.step(self.timing.physics_step)
        time = round((k + 1) * self.timing.physics_step, 6)  # 0.3, not 0.30000000000000004
        self._note(time)
        if (k + 1) % self.timing.steps_per_belief == 0:
            self.work.learn(self._ranges())
            self._believe(time)
        self._look(time)

    def _note(self, time: float) -> None:
        log, at, cells = self.log, self.quarry.positions.copy(), self.quarry.cells.copy()
        for caught in self.captures:
            at[caught.evader], cells[caught.evader] = caught.position, caught.cell
        log.headings.append(self.work.headings[0])
        log.pursuers.append(self.work.positions[0])
        log.evaders.append(at)
        log.pursuer_cells.append(self.work.cells[0])
        log.evaders_cells.append(cells)
        log.times.append(time)
        idle = np.concatenate([self.work.idle[0], self.quarry.idle])
        self.held_up.update(np.flatnonzero(idle >= HELD_UP).tolist())

    def _believe(self, time: float) -> None:
        self.log.beliefs.append(self.work.beliefs[0])
        self.log.own_beliefs.append(self.work.own_beliefs(0))
        self.log.belief_times.append(time)

    def _ranges(self) -> NDArray[np.float64] | None:
        """Measure the distance of every evader that is free from every robot, shape (P, E), metres; NaN of others."""
        noise = self.team.range_noise
        if noise is None:
            return None
        away = self.work.positions[0][:, np.newaxis] - self.quarry.positions
        read = np.hypot(away[..., 0], away[..., 1]) + noise * self.measuring.standard_normal(away.shape[:2])
        return np.where(self.work.crews[0].free, read, np.nan)

    def _look(self, time: float) -> None:
        """Let the robots look at every evader that is free; all are told of a capture."""
        free = self.work.crews[0].free
        for k in np.flatnonzero(free).tolist():
            captor = self._captor(k)
            if captor is not None:
                x, y = self.log.evaders[-1][k].tolist()
                self.captures.append(Capture(k, time, captor, (x, y), int(self.log.evaders_cells[-1][k])))
                free[k] = False

    def _captor(self, evader: int) -> int | None:
        # evaders are kept in single precision where thousands are, and a robot must see the same in both cases
        target = self.quarry.positions[evader].astype(np.float32).astype(np.float64)
        hidden = int(self.quarry.cells[evader])
        for i, (eye, cell) in enumerate(zip(self.work.positions[0], self.work.cells[0].tolist(), strict=True)):
            sensor = self.team.sensors[i]
            if self.capture == "cell":
                looks = cell == hidden
            else:
                looks = sensor.sees(self.quarry.world, eye, float(self.work.headings[0, i]), target)
            if looks:
                self.looked[evader, i] += sensor.attention * self.timing.physics_step
                if self.looked[evader, i] >= self.patience[evader, i]:
                    return i
        return None

    def outcome(self, status: Status) -> Outcome:
        """Tell how it ended: captured, or for the reason that is given."""
        status = Status.CAPTURED if self.is_over else status
        captured, several = status is Status.CAPTURED, len(self.quarry) > 1
        names = [f"Pursuer {i + 1}" for i in range(self.team.pursuers)]
        names += [f"Evader {k + 1}" for k in range(len(self.quarry))] if several else ["The evader"]
        notes = tuple(f"{names[k]} was held up at a wall for {HELD_UP:g} s or more." for k in sorted(self.held_up))
        self.log.decisions = [(choice.time, choice.pursuer, choice.path) for choice in self.work.choices]
        last = self.captures[-1] if captured else None
        return Outcome(
            status=status,
            time=self.log.times[-1],
            pursuer=None if last is None else last.pursuer,
            position=None if last is None else last.position,
            cell=None if last is None else last.cell,
            predicted=float(self.log.beliefs[-1][0]),
            notes=notes,
            evader=0 if last is None else last.evader,
            earlier=tuple(self.captures if last is None else self.captures[:-1]),
        )
