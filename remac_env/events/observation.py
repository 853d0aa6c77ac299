"""What robots see of time: the clock, and what each robot of the team is at."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from remac_env.events.clock import Doing

LONG = 60.0
"""s that what a robot is at has taken when the figure for it is 1: after so long a controller gives up."""

_CLOCK, _ROBOT = 1, 4


def time_size(robots: int) -> int:
    """How many figures the vector of `time_vector` has."""
    return _CLOCK + _ROBOT * robots


def time_vector(
    robot: str, robots: Sequence[str], doing: Mapping[str, Doing | None], *, now: float, deadline: float
) -> NDArray[np.float32]:
    """Time as a robot sees it; shape (1 + 4 * robots,), values 0..1.

    The share of the episode's time that is over; then for the robot itself and each other one, in their order: ready,
    thinking, at work, and how long it has been at what it is at, in units of LONG.
    """
    values = [min(now / deadline, 1.0)]
    for name in (robot, *(other for other in robots if other != robot)):
        each = doing[name]
        since = now if each is None else each.since
        kind = "" if each is None else each.kind
        values += [each is None, kind == "thinking", kind == "working", min((now - since) / LONG, 1.0)]
    return np.array(values, np.float32)
