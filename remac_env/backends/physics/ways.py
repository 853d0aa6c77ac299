"""Ways of robots that drive at the same time: each with its path once that is asked for, and the order of combinations.

A combination is a way for each robot, and by how many samples each starts late.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from remac_env.backends.physics.controllers.scripted.paths import Path
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.backends.physics.routes import Course, Departure, Outline, candidates, periods
from remac_env.kitchen.floor_plan import Station
from remac_env.robots.body import Body
from remac_env.robots.rotation import Array, quaternion

SAMPLE = 3  # control periods between checks
LATER = 7  # samples between the moments at which a drive may begin that waits for others
_DELAYS = tuple(range(0, 112, LATER))  # samples


@dataclass(eq=False)
class Way:
    """One way of one robot: its course, how long it takes, and, once asked for, its path or None if not free."""

    course: Course
    periods: int
    path: Path | None = None
    checked: bool = False

    @property
    def moments(self) -> Path:
        """Every so many configurations of the path, and its last."""
        path = self.path or []
        return [*path[::SAMPLE], *path[-1:]]


@dataclass(frozen=True)
class Driver:
    """A robot with its ways, quickest first, its outline while it drives, and its goal.

    ``obstacles``: corners (m, 3) of boxes around all that it must keep off, other robots apart.
    """

    here: Workspace
    ways: list[Way]
    outline: Outline
    obstacles: tuple[Array, Array]
    goal: Station


@dataclass(frozen=True)
class Moving:
    """A robot that drives already: how, and what is left of its way from now on."""

    driver: Driver
    way: Way

    @property
    def name(self) -> str:
        """The robot."""
        return self.driver.here.robot.name

    @property
    def bases(self) -> Array:
        """Base poses (t, 3) on what is left, world frame."""
        return np.array(self.way.moments)[:, :3]

    @staticmethod
    def along(driver: Driver, left: Path) -> Moving:
        """A drive with so much of its path left, one configuration a period."""
        return Moving(driver, Way(Course(left, (0, "under way")), len(left), left, True))


Combination = tuple[tuple[Way, ...], tuple[int, ...]]
"""A way for each robot, and by how many samples each starts late."""


def ways_to(start: Departure, goal: Station, body: Body) -> list[Way]:
    """All ways to a place, quickest first, not yet checked."""
    ways = [Way(course, periods(course.corners, body)) for course in candidates(start, goal)]
    return sorted(ways, key=lambda way: way.periods)


def held_pose(here: Workspace, q: Array) -> tuple[int, Array] | None:
    """Address and pose (7,) of what a robot holds when it is in configuration ``q``."""
    attached = here.clear.checker.held
    if attached is None:
        return None
    position, rotation = here.robot.kinematics.forward(q)
    turned = quaternion(rotation @ attached.rotation)
    return attached.address, np.concatenate([position + rotation @ attached.position, turned])


def ordered(ways: Sequence[Sequence[Way]]) -> Iterator[Combination]:
    """Ways with delays, of which at least one is zero, by the last arrival and then by all arrivals together."""
    starts = np.array([delays for delays in product(_DELAYS, repeat=len(ways)) if min(delays) == 0])
    chosen = list(product(*ways))
    lasts = np.array([[way.periods for way in each] for each in chosen], int).reshape(-1, len(ways))
    ends = (lasts[:, None] + SAMPLE * starts).reshape(-1, len(ways))
    for number in np.lexsort((ends.sum(axis=1), ends.max(axis=1))).tolist():
        which, delays = divmod(number, len(starts))
        yield chosen[which], tuple(starts[delays].tolist())
