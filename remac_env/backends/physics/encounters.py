"""Where two ways come near one another: for every moment of the one and every moment of the other."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from remac_env.backends.physics.routes import Outline, placed
from remac_env.robots.footprints import cores
from remac_env.robots.rotation import Array

_BLOCK = 48  # moments of one way looked at together, which bounds memory


class Encounter:
    """Two robots on two ways, given as base poses (t, 3) at equal intervals.

    Circles around the robots' parts tell moments that are surely clear, circles within their bases moments in which
    they surely meet; ``clear`` is asked, once, about what lies between: ``clear(i, j)`` for moments of the two.
    """

    def __init__(
        self, ways: tuple[Array, Array], outlines: tuple[Outline, Outline], apart: float,
        clear: Callable[[int, int], bool],
    ) -> None:
        (one, one_radius), (other, other_radius) = (cores(outline.footprint) for outline in outlines)
        self._meet = _gaps(placed(one, ways[0]), placed(other, ways[1])) < one_radius + other_radius + apart
        self._near = _near(ways, outlines, apart)
        self._last = tuple(len(way) - 1 for way in ways)
        self._clear, self._known = clear, dict[tuple[int, int], bool]()

    def passes(self, delays: tuple[int, int]) -> bool:
        """Whether the robots keep apart when they start that many intervals late."""
        one, other = (np.arange(max(d + n for d, n in zip(delays, self._last, strict=True)) + 1) - d for d in delays)
        i, j = np.clip(one, 0, self._last[0]), np.clip(other, 0, self._last[1])
        if self._meet[i, j].any():
            return False
        near = self._near[i, j]
        return all(self._ask(a, b) for a, b in zip(i[near].tolist(), j[near].tolist(), strict=True))

    def _ask(self, i: int, j: int) -> bool:
        if (i, j) not in self._known:
            self._known[i, j] = self._clear(i, j)
        return self._known[i, j]


def _gaps(one: Array, other: Array) -> Array:
    """Least distances (t, u) between points (t, n, 2) and (u, m, 2)."""
    return distances(one[:, None, :, None], other[None, :, None]).min(axis=(2, 3))


def distances(one: Array, other: Array) -> Array:
    """Distances between points (..., 2)."""
    x, y = one[..., 0] - other[..., 0], one[..., 1] - other[..., 1]
    return np.asarray(np.sqrt(x * x + y * y))


def _near(ways: tuple[Array, Array], outlines: tuple[Outline, Outline], apart: float) -> NDArray[np.bool_]:
    """Pairs of moments (t, u) in which circles around parts of the two robots come nearer than ``apart`` (m)."""
    reaches = [float(np.linalg.norm(np.maximum(-o.low, o.high)[:, :2], axis=1).max()) for o in outlines]
    near: NDArray[np.bool_] = distances(ways[0][:, None, :2], ways[1][None, :, :2]) < sum(reaches) + apart
    (one, one_radii), (other, other_radii) = (o.circles(w) for o, w in zip(outlines, ways, strict=True))
    i, j = np.nonzero(near)
    for start in range(0, len(i), _BLOCK * _BLOCK):
        a, b = i[start : start + _BLOCK * _BLOCK], j[start : start + _BLOCK * _BLOCK]
        between = distances(one[a][:, :, None], other[b][:, None])
        near[a, b] = (between - one_radii[:, None] - other_radii).min(axis=(1, 2)) < apart
    return near
