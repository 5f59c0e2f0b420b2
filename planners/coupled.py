"""Search of all joint paths to a depth: Algorithm 1, coupled."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from planners.costs import Cost, Hops, find_cost
from planners.lookahead import DEEPEST, TIE
from planners.policy import Decision, SearchProblem, SearchState
from planners.simulation import SearchModel
from planners.team import PlannerError, at_least, at_most

__all__ = ["Coupled"]

# More joint paths than this are refused: the paper could not search them either.
MOST_PATHS = 200_000


@dataclass(frozen=True, slots=True)
class Coupled:
    """The team takes the cheapest of all its joint paths to a depth.

    Algorithm 1 of the paper with coupled planning (Section IV-D): O(b^(d n)) joint paths of n pursuers. All pursuers
    that stand at a checkpoint plan together; one that is between two checkpoints ends its hop and stands still. The
    cost of a joint path is the sum over pursuers and over the cells that each visits (Eq. 8), judged with the belief
    at that pursuer's arrival there, simulated with all of them moving. A pursuer that has ended its path stands
    still. Among joint paths of equal cost (within a share of 1e-9) chance decides.

    Attributes
    ----------
    cost : str
        Name of a heuristic in :data:`planners.COSTS`.
    depth : int
        Number of hops to look ahead, 1 to 100.

    Raises
    ------
    CostError
        If there is no such heuristic.
    PlannerError
        If the depth is below 1 or above 100; when deciding, if there are more than 200,000 joint paths.
    """

    cost: str = "entropy"
    depth: int = 1

    def __post_init__(self) -> None:
        find_cost(self.cost)
        at_least(1, depth=self.depth)
        at_most(DEEPEST, depth=self.depth)

    def solve(self, problem: SearchProblem, rng: np.random.Generator) -> CoupledPolicy:
        """Prepare a policy; ``rng`` decides between joint paths of equal cost."""
        return CoupledPolicy(SearchModel(problem), find_cost(self.cost), self.depth, rng)


@dataclass(frozen=True, slots=True)
class CoupledPolicy:
    """The policy of :class:`Coupled` for one problem."""

    model: SearchModel
    cost: Cost
    depth: int
    rng: np.random.Generator = field(repr=False)

    def decide(self, state: SearchState) -> Sequence[Decision | None]:
        """Return a path of ``depth`` cells for each pursuer at a checkpoint, None for the others."""
        team = state.pursuers
        who = [i for i, pursuer in enumerate(team) if pursuer.target is None]
        ways = self.model.graph.count_walks(self.depth)
        count = float(np.prod([max(1.0, ways[team[i].cell]) for i in who]))
        if count > MOST_PATHS:
            raise PlannerError(
                f"Coupled planning to depth {self.depth} has {count:.3g} joint paths for {len(who)} pursuers; "
                f"at most {MOST_PATHS} are searched. Use a smaller depth, or 'decoupled'."
            )
        walks = [self._walks(team[i].cell, self.depth) for i in who]
        unseen = self.model.unseen([self.model.timeline(k, p) for k, p in enumerate(team) if k not in who])
        joint = np.array(list(itertools.product(*(range(len(w)) for w in walks))), dtype=np.intp)
        cost = self._cost(who, [team[i].cell for i in who], walks, joint, state.belief[1:], unseen)
        best = cost.min()
        pick = int(self.rng.choice(np.flatnonzero(cost <= best + TIE * abs(best))))
        decisions: list[Decision | None] = [None] * len(team)
        for i, walk, k in zip(who, walks, joint[pick], strict=True):
            decisions[i] = Decision(walk[k], float(cost[pick]))
        return decisions

    def _walks(self, cell: int, depth: int) -> list[tuple[int, ...]]:
        """Return all walks over ``depth`` hops; in a cell without neighbours that is to stay."""
        if depth == 0:
            return [()]
        ways = self.model.graph.neighbours(cell).tolist() or [cell]
        return [(way, *rest) for way in ways for rest in self._walks(way, depth - 1)]

    def _cost(
        self,
        who: Sequence[int],
        cells: Sequence[int],
        walks: Sequence[Sequence[tuple[int, ...]]],
        joint: NDArray[np.intp],
        belief: NDArray[np.float64],
        unseen: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """Return the cost of each joint path, shape (K,); row ``k`` of ``joint`` names a walk of each pursuer."""
        model = self.model
        moves = [
            np.array([[model.move(a, b) for a, b in itertools.pairwise((cell, *walk))] for walk in options])
            for cell, options in zip(cells, walks, strict=True)
        ]
        free = np.repeat(belief[np.newaxis], len(joint), axis=0)
        set_out = [free.copy() for _ in who]
        on = [chosen[joint[:, j], 0] for j, chosen in enumerate(moves)]
        hop, done = np.zeros((2, len(who), len(joint)), dtype=np.intp)
        total, step = np.zeros(len(joint)), 0
        while (hop < self.depth).any():
            free = model.disperse(free) * unseen[min(step, len(unseen) - 1)]
            step += 1
            for j, i in enumerate(who):
                table = model.moves[i]
                model.looks.take(free, table.views[on[j], np.minimum(done[j], table.steps[on[j]] - 1)])
                done[j] += 1
            for j, i in enumerate(who):
                table = model.moves[i]
                rows = np.flatnonzero((done[j] == table.steps[on[j]]) & (hop[j] < self.depth))
                if not len(rows):
                    continue
                chance = model.looks.chance(set_out[j], table.views[on[j][rows], -1], rows)
                distance = model.length_of(on[j][rows])
                total[rows] += self.cost(Hops(set_out[j][rows], free[rows], chance, distance))
                set_out[j][rows] = free[rows]
                hop[j, rows] += 1
                going = rows[hop[j, rows] < self.depth]
                on[j][going] = moves[j][joint[going, j], hop[j, going]]
                done[j, going] = 0
        return total
