"""Search of all paths to a depth, every pursuer for itself: Algorithm 1, decoupled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from maps import GeomsimError
from planners.costs import Cost, Hops, find_cost
from planners.policy import Decision, PursuerState, SearchProblem, SearchState
from planners.simulation import SearchModel

__all__ = ["Decoupled", "PlannerError"]

# Costs that differ by less than this share are equal: the order of a sum must not decide between mirror images.
TIE = 1e-9


class PlannerError(GeomsimError):
    """A planner that does not exist, or a parameter that it cannot take."""


@dataclass(frozen=True, slots=True)
class Decoupled:
    """Every pursuer takes the cheapest of all its paths to a depth while the others stand still.

    Algorithm 1 of the paper with decoupled planning (Section IV-E): O(b^d) paths for branching factor b and depth
    d, whatever the number of pursuers. A path is a walk over ``depth`` hops to neighbours. It may come back to a
    cell that it was in, since the evader may have moved there meanwhile; it does not wait, since a wait has no
    length of its own to be compared with a hop's, unless the cell has no neighbour. Its cost is the sum over the
    cells that it visits (Eq. 8; the starting cell's term is the same for all paths and left out), each judged with
    the belief simulated to the moment of arrival.

    The others' states are fixed as in the paper, except that whoever is between two checkpoints, or has decided at
    this same instant, ends that hop before it stands still. Pursuers that stand at a checkpoint decide one after
    another in the order of their numbers. Among paths of equal cost (within a share of 1e-9) chance decides. So
    two pursuers in one place part ways: the second one finds the first one's next cell taken.

    Attributes
    ----------
    cost : str
        Name of a heuristic in :data:`planners.COSTS`.
    depth : int
        Number of hops to look ahead, at least 1.

    Raises
    ------
    CostError
        If there is no such heuristic.
    PlannerError
        If the depth is below 1.
    """

    cost: str = "entropy"
    depth: int = 5

    def __post_init__(self) -> None:
        find_cost(self.cost)
        if self.depth < 1:
            raise PlannerError(f"The depth of a lookahead must be at least 1; got {self.depth}.")

    def solve(self, problem: SearchProblem, rng: np.random.Generator) -> DecoupledPolicy:
        """Prepare a policy; ``rng`` decides between paths of equal cost."""
        return DecoupledPolicy(SearchModel(problem), find_cost(self.cost), self.depth, rng)


@dataclass(frozen=True, slots=True)
class DecoupledPolicy:
    """The policy of :class:`Decoupled` for one problem."""

    model: SearchModel
    cost: Cost
    depth: int
    rng: np.random.Generator = field(repr=False)

    def decide(self, state: SearchState) -> Sequence[Decision | None]:
        """Return a path of ``depth`` cells for each pursuer at a checkpoint, None for the others."""
        team = list(state.pursuers)
        decisions: list[Decision | None] = [None] * len(team)
        for i, pursuer in enumerate(team):
            if pursuer.target is not None:
                continue
            others = [self.model.timeline(k, other) for k, other in enumerate(team) if k != i]
            decision = self._best_path(i, pursuer.cell, state.belief[1:], self.model.unseen(others))
            decisions[i] = decision
            team[i] = self._under_way(i, pursuer.cell, decision.path[0])
        return decisions

    def _under_way(self, pursuer: int, cell: int, target: int) -> PursuerState:
        if target == cell:
            return PursuerState(cell)
        hops = self.model.hops[pursuer].steps[self.model.graph.edge(cell, target)]
        return PursuerState(cell, target, float(hops) * self.model.step)

    def _best_path(self, pursuer: int, cell: int, belief: NDArray[np.float64], unseen: NDArray[np.float64]) -> Decision:
        if len(self.model.graph.neighbours(cell)) == 0:
            return Decision((cell,))
        tree = grow_tree(self.model, pursuer, cell, belief, unseen, self.cost, self.depth)
        total = tree.costs[-1]
        best = total.min()
        leaf = int(self.rng.choice(np.flatnonzero(total <= best + TIE * abs(best))))
        return Decision(tree.path(leaf), float(total[leaf]))


@dataclass(frozen=True, slots=True)
class PathTree:
    """All walks of a pursuer from one cell, level by level.

    Attributes
    ----------
    cells : list of ndarray of intp
        For each depth the last cell of every walk.
    parents : list of ndarray of intp
        For each depth the walk, one level higher, that every walk continues.
    costs : list of ndarray
        For each depth the cost of every walk.
    """

    cells: list[NDArray[np.intp]]
    parents: list[NDArray[np.intp]]
    costs: list[NDArray[np.float64]]

    def path(self, leaf: int) -> tuple[int, ...]:
        """Return the cells of a walk of full depth, the starting cell left out."""
        path: list[int] = []
        for cells, parents in zip(reversed(self.cells), reversed(self.parents), strict=True):
            path.append(int(cells[leaf]))
            leaf = int(parents[leaf])
        return tuple(reversed(path))


def grow_tree(
    model: SearchModel,
    pursuer: int,
    cell: int,
    belief: NDArray[np.float64],
    unseen: NDArray[np.float64],
    cost: Cost,
    depth: int,
) -> PathTree:
    """Simulate the belief along every walk of ``depth`` hops, common beginnings once.

    Parameters
    ----------
    model : SearchModel
        The problem.
    pursuer : int
        Who walks.
    cell : int
        Where it starts.
    belief : ndarray, shape (N,)
        Probability of each state now.
    unseen : ndarray, shape (T, N)
        Share of each state that the other pursuers leave unseen at each step to come, the last row from then on.
    cost : Cost
        The heuristic.
    depth : int
        Number of hops.
    """
    graph, hops = model.graph, model.hops[pursuer]
    tree = PathTree([], [], [])
    cells, total = np.array([cell], dtype=np.intp), np.zeros(1)
    beliefs, clock = belief[np.newaxis], np.zeros(1, dtype=np.intp)
    for _ in range(depth):
        count = graph.degree[cells]
        parent = np.repeat(np.arange(len(cells)), count)
        edge = np.arange(len(parent)) + np.repeat(graph.indptr[cells] - (np.cumsum(count) - count), count)
        order = np.argsort(-hops.steps[edge], kind="stable")
        parent, edge = parent[order], edge[order]
        cells = graph.indices[edge]
        before = beliefs[parent]
        beliefs = _simulate(model, beliefs, parent, clock, hops.steps[edge], hops.views[edge], unseen)
        clock = clock[parent] + hops.steps[edge]
        chance = model.looks.chance(before, cells)
        total = total[parent] + cost(Hops(before, beliefs, chance, graph.length[edge]))
        tree.cells.append(cells)
        tree.parents.append(parent)
        tree.costs.append(total)
    return tree


def _simulate(
    model: SearchModel,
    beliefs: NDArray[np.float64],
    parent: NDArray[np.intp],
    clock: NDArray[np.intp],
    steps: NDArray[np.intp],
    views: NDArray[np.intp],
    unseen: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the beliefs after one more hop each; hops are sorted, those of most steps first."""
    # The first dispersion is the same for all hops from one node, so it is done before they part.
    after: NDArray[np.float64] = (beliefs @ model.dispersion)[parent]
    clock = clock[parent]
    last = len(unseen) - 1
    for k in range(int(steps[0])):
        going = int(np.searchsorted(-steps, -k, side="left"))
        active = after[:going]
        if k > 0:
            active[:] = active @ model.dispersion
        active *= unseen[np.minimum(clock[:going] + k, last)] if last else unseen[0]
        model.looks.apply(active, views[:going, k])
    return after
