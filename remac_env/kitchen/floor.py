"""Where the axis of a robot's base can be on the floor: a grid, and shortest ways on it. No simulator needed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from heapq import heappop, heappush
from math import hypot

import numpy as np
from numpy.typing import NDArray

from remac_env.kitchen.blocks import Block

TALL = 1.45
"""A driving robot with its arm folded passes under what hangs higher than this, m."""

_FROM_WALL = 0.42  # m from the axis to a side wall: robots do not turn there
_CELL = 0.10  # m
_MOVES = [(dx, dy, hypot(dx, dy)) for dx in (-1, 0, 1) for dy in (-1, 0, 1) if dx or dy]

Place = tuple[float, float]


class Floor:
    """The floor between low and high corners (x, y), m, with rectangles on it that a robot must keep clear of."""

    def __init__(self, low: Place, high: Place, blocks: Iterable[Block], radius: float) -> None:
        """Keep the axis of a robot `radius`, m, away from blocks that reach below `TALL`, and off the edges."""
        self._low = low
        count = [max(1, int((high[axis] - low[axis]) / _CELL)) for axis in (0, 1)]
        x = low[0] + _CELL * (np.arange(count[0]) + 0.5)
        y = low[1] + _CELL * (np.arange(count[1]) + 0.5)
        gap = np.full((count[0], count[1]), np.inf)
        for block in blocks:
            if block.low[2] < TALL:
                dx = np.maximum(np.maximum(block.low[0] - x, x - block.high[0]), 0.0)
                dy = np.maximum(np.maximum(block.low[1] - y, y - block.high[1]), 0.0)
                gap = np.minimum(gap, np.hypot(dx[:, None], dy[None, :]))
        edge = np.minimum(x - low[0], high[0] - x)
        self.free: NDArray[np.bool_] = (gap >= radius) & (edge >= _FROM_WALL)[:, None]
        self.free &= (high[1] - y >= _FROM_WALL)[None, :]

    def without(self, low: Place, high: Place) -> Floor:
        """The same floor with one more rectangle taken away, which the axis itself must not enter."""
        other = object.__new__(Floor)
        other._low, other.free = self._low, self.free.copy()
        first, last = self._cell(low), self._cell(high)
        other.free[first[0] : last[0] + 1, first[1] : last[1] + 1] = False
        return other

    def reachable(self, start: Place) -> NDArray[np.bool_]:
        """Which cells can be reached from a place; none where the place itself is not free."""
        seen = np.zeros_like(self.free)
        cell = self._cell(start)
        if not self.free[cell]:
            return seen
        seen[cell] = True
        # Unbroken runs of free cells along each axis, by number: a run is reached all at once, so that few turns do.
        rows, columns = _runs(self.free), _runs(self.free.T)
        count = 0
        while count < (count := int(seen.sum())):
            seen = _whole_runs(seen, rows) & self.free
            seen = _whole_runs(seen.T, columns).T & self.free
        return seen

    def holds(self, cells: NDArray[np.bool_], place: Place) -> bool:
        """Whether a place lies in one of these cells."""
        return bool(cells[self._cell(place)])

    def way(self, start: Place, end: Place) -> list[Place] | None:
        """Corners of a short way, both ends included, that keeps to free cells; None where there is none."""
        first, last = self._cell(start), self._cell(end)
        if not (self.free[first] and self.free[last]):
            return None
        cost, before = {first: 0.0}, {first: first}
        queue = [(0.0, first)]
        while queue:
            _, cell = heappop(queue)
            if cell == last:
                break
            for near, length in self._near(cell):
                total = cost[cell] + length
                if total < cost.get(near, np.inf) - 1e-9:
                    cost[near], before[near] = total, cell
                    heappush(queue, (total + hypot(near[0] - last[0], near[1] - last[1]), near))
        if last not in before:
            return None
        cells = [last]
        while cells[-1] != first:
            cells.append(before[cells[-1]])
        return [start, *(self._place(cell) for cell in self._pulled(cells[::-1])[1:-1]), end]

    def _pulled(self, cells: list[tuple[int, int]]) -> list[tuple[int, int]]:
        """The corners that remain when the way is pulled tight."""
        kept, at = [cells[0]], 0
        while at < len(cells) - 1:
            far = next(k for k in range(len(cells) - 1, at, -1) if k == at + 1 or self._sees(cells[at], cells[k]))
            kept.append(cells[far])
            at = far
        return kept

    def _sees(self, one: tuple[int, int], other: tuple[int, int]) -> bool:
        steps = 2 * max(abs(one[0] - other[0]), abs(one[1] - other[1]), 1)
        along = np.linspace(0.0, 1.0, steps + 1)
        x = np.rint(one[0] + along * (other[0] - one[0])).astype(int)
        y = np.rint(one[1] + along * (other[1] - one[1])).astype(int)
        return bool(self.free[x, y].all())

    def _near(self, cell: tuple[int, int]) -> Iterator[tuple[tuple[int, int], float]]:
        for dx, dy, length in _MOVES:
            near = cell[0] + dx, cell[1] + dy
            inside = 0 <= near[0] < self.free.shape[0] and 0 <= near[1] < self.free.shape[1]
            if inside and self.free[near] and self.free[cell[0], near[1]] and self.free[near[0], cell[1]]:
                yield near, length

    def _cell(self, place: Place) -> tuple[int, int]:
        x, y = (int((place[axis] - self._low[axis]) / _CELL) for axis in (0, 1))
        return min(max(x, 0), self.free.shape[0] - 1), min(max(y, 0), self.free.shape[1] - 1)

    def _place(self, cell: tuple[int, int]) -> Place:
        return self._low[0] + _CELL * (cell[0] + 0.5), self._low[1] + _CELL * (cell[1] + 0.5)


def _runs(free: NDArray[np.bool_]) -> NDArray[np.int_]:
    """For every cell of a grid the number of the unbroken run of free cells, along its row, that it lies in."""
    walled = np.pad(free, ((0, 0), (1, 0)))  # a wall before each row, so that no run goes on into the next
    runs: NDArray[np.int_] = np.cumsum(~walled, dtype=np.int_).reshape(walled.shape)
    return runs[:, 1:]


def _whole_runs(cells: NDArray[np.bool_], runs: NDArray[np.int_]) -> NDArray[np.bool_]:
    """The cells, and all others of the runs that they lie in."""
    reached = np.zeros(int(runs[-1, -1]) + 1, dtype=np.bool_)
    reached[runs[cells]] = True
    return reached[runs]
