"""Triangles on integer points, into which edges are put.

M. V. Anglada, An improved incremental algorithm for constructing restricted Delaunay triangulations, 1997.
"""

__all__ = ["Edge", "Mesh", "Vertex", "orientation", "turns_left"]

Edge = tuple[int, int]
Vertex = tuple[int, int]


def orientation(a: Vertex, b: Vertex, c: Vertex) -> int:
    """Twice the signed area of a triangle of integer points: positive where a, b, c turn left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def turns_left(a: Vertex, b: Vertex, c: Vertex) -> bool:
    """Tell whether the way from a over b to c keeps left or goes straight.

    A vertex that a door has put on a slanted wall lies up to a step of the integers (1e-12 m) beside it; that much is
    straight. On the grid of one millimetre the test is exact: there no turn is that slight.
    """
    steps = abs(b[0] - a[0]) + abs(b[1] - a[1]) + abs(c[0] - b[0]) + abs(c[1] - b[1])
    return orientation(a, b, c) >= -steps


class Mesh:
    """Triangles that change while edges are put in.

    ``apex[u, v]`` is the third corner left of the edge u to v, ``star[w]`` the edges whose third corner is w.
    """

    def __init__(self, grid: list[Vertex], apex: dict[Edge, int]) -> None:
        self.grid = grid
        self.apex: dict[Edge, int] = {}
        self.star: dict[int, set[Edge]] = {k: set() for k in range(len(grid))}
        self.fixed: set[Edge] = set()
        for (u, v), w in apex.items():
            if u < v and u < w:
                self._put(u, v, w)

    def triangles(self) -> list[tuple[int, int, int]]:
        """Corners of every triangle, the smallest first, counter-clockwise."""
        return sorted((u, v, w) for (u, v), w in self.apex.items() if u < v and u < w)

    def insert(self, a: int, b: int) -> None:
        """Make the segment from a to b a chain of edges; leave it out where it would cross an earlier one."""
        at = self.grid
        while a != b:
            if (a, b) in self.apex or (b, a) in self.apex:
                self.fixed.add((min(a, b), max(a, b)))
                return
            end, left, right, gone = self._crossed(a, b, sorted(self.star[a]))
            if end < 0:
                return
            for u, v in gone:
                self._take(u, v)
            if gone:
                self._fill(a, end, left)
                self._fill(end, a, right[::-1])
            self.fixed.add((min(a, end), max(a, end)))
            if orientation(at[a], at[end], at[b]) != 0:
                return
            a = end

    def _put(self, a: int, b: int, c: int) -> None:
        for u, v, w in ((a, b, c), (b, c, a), (c, a, b)):
            self.apex[u, v] = w
            self.star[w].add((u, v))

    def _take(self, a: int, b: int) -> None:
        c = self.apex[a, b]
        for u, v, w in ((a, b, c), (b, c, a), (c, a, b)):
            del self.apex[u, v]
            self.star[w].discard((u, v))

    def _crossed(self, a: int, b: int, fan: list[Edge]) -> tuple[int, list[int], list[int], list[Edge]]:
        """Walk from a to b: the vertex reached, the vertices left and right of the way, an edge of each triangle.

        The vertex is -1 where a wall or an earlier door is in the way.
        """
        at = self.grid
        for u, v in fan:
            for w in (u, v):
                if orientation(at[a], at[b], at[w]) == 0 and _ahead(at[a], at[b], at[w]):
                    return w, [], [], []
        ways = [
            (u, v)
            for u, v in fan
            if orientation(at[a], at[b], at[u]) < 0 < orientation(at[a], at[b], at[v])
            and orientation(at[u], at[v], at[b]) < 0
        ]
        if not ways:
            return -1, [], [], []
        (u, v), gone = ways[0], [ways[0]]
        right, left = [u], [v]
        while (v, u) in self.apex and (min(u, v), max(u, v)) not in self.fixed:
            w = self.apex[v, u]
            gone.append((v, u))
            side = orientation(at[a], at[b], at[w])
            if side == 0:
                return w, left, right, gone
            if side > 0:
                left.append(w)
                v = w
            else:
                right.append(w)
                u = w
        return -1, [], [], []

    def _fill(self, a: int, b: int, chain: list[int]) -> None:
        """Triangulate what lies left of the edge from a to b, bounded by the chain of vertices from a to b."""
        if not chain:
            return
        best = 0
        for i in range(1, len(chain)):
            if _in_circle(self.grid[a], self.grid[b], self.grid[chain[best]], self.grid[chain[i]]):
                best = i
        c = chain[best]
        self._put(a, b, c)
        self._fill(a, c, chain[:best])
        self._fill(c, b, chain[best + 1 :])


def _ahead(a: Vertex, b: Vertex, p: Vertex) -> bool:
    return (p[0] - a[0]) * (b[0] - a[0]) + (p[1] - a[1]) * (b[1] - a[1]) > 0


def _in_circle(a: Vertex, b: Vertex, c: Vertex, d: Vertex) -> bool:
    """Tell whether d lies inside the circle through a, b and c, which turn left."""
    rows = [(p[0] - d[0], p[1] - d[1]) for p in (a, b, c)]
    (ax, ay), (bx, by), (cx, cy) = rows
    a2, b2, c2 = (x * x + y * y for x, y in rows)
    return ax * (by * c2 - b2 * cy) - ay * (bx * c2 - b2 * cx) + a2 * (bx * cy - by * cx) > 0
