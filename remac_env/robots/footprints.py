"""What follows from a footprint: low and high corner (x, y), m, of a base around the axis that it turns about."""

from __future__ import annotations

import math

import numpy as np

from remac_env.robots.body import Array

Footprint = tuple[tuple[float, float], tuple[float, float]]

_WITHIN = 0.01  # m by which circles within a base stay off its sides
_DIGITS = 9  # of lengths, m: below what any measure is good for, and above what adding them up leaves


def middle_and_half(footprint: Footprint) -> tuple[Array, Array]:
    """The middle (2,) of a base in its own frame, and its half extents (2,)."""
    low, high = np.array(footprint)
    return 0.5 * (low + high), 0.5 * (high - low)


def width(footprint: Footprint) -> float:
    """How much floor a base takes from side to side, m."""
    (_, right), (_, left) = footprint
    return left - right


def radius(footprint: Footprint) -> float:
    """Distance of the farthest corner of a base from its axis, m, rounded up to whole centimetres."""
    farthest = max(math.hypot(x, y) for x, _ in footprint for _, y in footprint)
    return math.ceil(100.0 * round(farthest, _DIGITS)) / 100.0


def cores(footprint: Footprint) -> tuple[Array, float]:
    """Two circles within a base, one at each of its short sides: their middles (2, 2) in its frame, and the radius."""
    middle, half = middle_and_half(footprint)
    off = half - half.min()  # nothing across, and on the long axis what lies beyond a square
    return np.round(np.stack([middle - off, middle + off]), _DIGITS), round(float(half.min()) - _WITHIN, _DIGITS)
