"""Navigate: which base pose a command means. The driving itself is in :mod:`remac_env.backends.physics.multi_robot`."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from itertools import permutations

import numpy as np

from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.robots.rotation import Array


def parking(layout: Layout, robots: Mapping[str, Array], taken: Collection[Array]) -> dict[str, Station]:
    """A parking place for every robot in ``robots`` (base poses), none at a base pose that is ``taken``.

    The assignment with the least way in all is taken; robots' names play no part.
    """
    names = sorted(robots, key=lambda name: tuple(robots[name]))
    free = [place for place in layout.asides if not any(_stands(place, pose) for pose in taken)]
    best, least = None, np.inf
    for places in permutations(free, len(names)):
        way = sum(float(np.linalg.norm(robots[n][:2] - [p.x, p.y])) for n, p in zip(names, places, strict=True))
        if way < least - 1e-9:
            best, least = places, way
    return {} if best is None else dict(zip(names, best, strict=True))


def _stands(place: Station, pose: Array) -> bool:
    return float(np.hypot(pose[0] - place.x, pose[1] - place.y)) < 0.8
