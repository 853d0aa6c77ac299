"""Points, spans and axis-aligned boxes: what fixtures, frames and floors are measured in."""

from __future__ import annotations

from dataclasses import dataclass

Point = tuple[float, float, float]
Span = tuple[float, float]


@dataclass(frozen=True)
class Block:
    """An axis-aligned box, m: low and high corner. Those of fixtures are in the frame of their wall."""

    low: Point
    high: Point

    def overlap(self, other: Block) -> float:
        """Return how deep two blocks reach into one another, m: the least over the axes; negative where apart."""
        return min(min(self.high[axis], other.high[axis]) - max(self.low[axis], other.low[axis]) for axis in range(3))

    def holds(self, point: Point) -> bool:
        """Say whether a point lies strictly inside."""
        (x, y, z), low, high = point, self.low, self.high
        return low[0] < x < high[0] and low[1] < y < high[1] and low[2] < z < high[2]
