"""Search of all paths to a depth, every pursuer for itself: Algorithm 1, decoupled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from planners.clock import FOREVER, Clock
from planners.costs import Cost, Hops, find_cost
from planners.policy import Decision, PursuerState, SearchProblem, SearchState
from planners.simulation import SearchModel
from planners.team import PlannerError, at_least, at_most

__all__ = ["Decoupled"]

# Costs that differ by less than this share are equal: the order of a sum must not decide between mirror images.
TIE = 1e-9

# Even where all cells have one neighbour, so that there is one path only, a path has at most so many hops.
DEEPEST = 100

# Numbers in the beliefs at the ends of all paths, of which there are some copies at a time: 160 MB.
LARGEST = 20_000_000


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
        Number of hops to look ahead, 1 to 100.
    seconds : float
        Thinking time for one decision, shared alike by the pursuers that have yet to decide: whose time is over looks
        less far ahead. With a limit, results depend on the machine.

    Raises
    ------
    CostError
        If there is no such heuristic.
    PlannerError
        If the depth is below 1 or above 100, or the time below 0.
    """

    cost: str = "entropy"
    depth: int = 5
    seconds: float = float("inf")

    def __post_init__(self) -> None:
        find_cost(self.cost)
        at_least(1, depth=self.depth)
        at_least(0, seconds=self.seconds)
        at_most(DEEPEST, depth=self.depth)

    def solve(self, problem: SearchProblem, rng: np.random.Generator) -> DecoupledPolicy:
        """Prepare a policy; ``rng`` decides between paths of equal cost.

        Raises
        ------
        PlannerError
            If there are too many paths of this depth.
        """
        model = SearchModel(problem)
        check_depth(model, self.depth)
        return DecoupledPolicy(model, find_cost(self.cost), self.depth, self.seconds, rng)


@dataclass(frozen=True, slots=True)
class DecoupledPolicy:
    """The policy of :class:`Decoupled` for one problem."""

    model: SearchModel
    cost: Cost
    depth: int
    seconds: float
    rng: np.random.Generator = field(repr=False)

    def decide(self, state: SearchState) -> Sequence[Decision | None]:
        """Return a path of ``depth`` cells for each pursuer at a checkpoint, None for the others."""
        team, clock = state.pursuers, Clock(self.seconds)
        waiting = sum(pursuer.target is None for pursuer in team)
        decisions: list[Decision | None] = [None] * len(team)
        later = self._unseen_by_later(team)
        earlier = self.model.unseen([])
        for i, pursuer in enumerate(team):
            now = pursuer
            if pursuer.target is None:
                unseen = self.model.together(earlier, later[i])
                share = Clock(clock.left / waiting)
                waiting -= 1
                decision = self._best_path(i, pursuer.cell, state.belief[1:], unseen, share)
                decisions[i] = decision
                now = self._under_way(i, pursuer.cell, decision.path[0])
            earlier = self.model.together(earlier, self.model.unseen([self.model.timeline(i, now)]))
        return decisions

    def _unseen_by_later(self, team: Sequence[PursuerState]) -> dict[int, NDArray[np.float64]]:
        """Return for each pursuer at a checkpoint what those after it leave unseen, as they are before they decide."""
        found = {}
        unseen = self.model.unseen([])
        for i in reversed(range(len(team))):
            if team[i].target is None:
                found[i] = unseen
            unseen = self.model.together(unseen, self.model.unseen([self.model.timeline(i, team[i])]))
        return found

    def _under_way(self, pursuer: int, cell: int, target: int) -> PursuerState:
        if target == cell:
            return PursuerState(cell)
        steps = self.model.moves[pursuer].steps[self.model.move(cell, target)]
        return PursuerState(cell, target, float(steps) * self.model.step)

    def _best_path(
        self, pursuer: int, cell: int, belief: NDArray[np.float64], unseen: NDArray[np.float64], clock: Clock
    ) -> Decision:
        if len(self.model.graph.neighbours(cell)) == 0:
            return Decision((cell,))
        tree = grow_tree(self.model, pursuer, cell, belief, unseen, self.cost, self.depth, clock)
        total = tree.costs[-1]
        best = total.min()
        leaf = int(self.rng.choice(np.flatnonzero(total <= best + TIE * abs(best))))
        return Decision(tree.path(leaf), float(total[leaf]))


def check_depth(model: SearchModel, depth: int) -> None:
    """Raise PlannerError if there are more paths of a depth from some cell than there is memory for."""
    most = LARGEST // model.states
    count = float(model.graph.count_walks(depth).max())
    if count <= most:
        return
    fits = max((d for d in range(1, depth) if model.graph.count_walks(d).max() <= most), default=0)
    advice = f"the largest depth that would do is {fits}" if fits else "no depth would do"
    raise PlannerError(
        f"A lookahead to depth {depth} has up to {count:.3g} paths to search in a map of {len(model.graph)} cells, of "
        f"which at most {most} are possible; {advice}."
    )


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
    limit: Clock = FOREVER,
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
    limit : Clock
        Hops that would take longer than this, by the time that shorter walks took, are left out; but not the first.
    """
    graph, moves = model.graph, model.moves[pursuer]
    tree = PathTree([], [], [])
    cells, total = np.array([cell], dtype=np.intp), np.zeros(1)
    beliefs, clock = belief[np.newaxis], np.zeros(1, dtype=np.intp)
    before = limit.left
    for level in range(depth):
        count = graph.degree[cells]
        if level > 0 and (before - limit.left) * count.sum() / len(cells) > limit.left:
            break
        parent = np.repeat(np.arange(len(cells)), count)
        edge = np.arange(len(parent)) + np.repeat(graph.indptr[cells] - (np.cumsum(count) - count), count)
        move = edge + cells[parent] + 1
        order = np.argsort(-moves.steps[move], kind="stable")
        parent, edge, move = parent[order], edge[order], move[order]
        cells = graph.indices[edge]
        set_out = beliefs[parent]
        beliefs = _simulate(model, beliefs, parent, clock, moves.steps[move], moves.views[move], unseen)
        clock = clock[parent] + moves.steps[move]
        chance = model.looks.chance(set_out, moves.views[move, -1])
        total = total[parent] + cost(Hops(set_out, beliefs, chance, graph.length[edge]))
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
    after: NDArray[np.float64] = model.disperse(beliefs)[parent]
    clock = clock[parent]
    last = len(unseen) - 1
    for k in range(int(steps[0])):
        going = int(np.searchsorted(-steps, -k, side="left"))
        active = after[:going]
        if k > 0:
            active[:] = model.disperse(active)
        active *= unseen[np.minimum(clock[:going] + k, last)] if last else unseen[0]
        model.looks.take(active, views[:going, k])
    return after
