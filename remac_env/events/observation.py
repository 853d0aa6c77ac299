"""What robots see of time: the clock, what each robot of the team is at, and what takes its time by itself."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from remac_env.events.clock import EventClock
from remac_env.rules.processes import known
from remac_env.state import WorldState

LONG = 60.0
"""s that what a robot is at has taken when the figure for it is 1: after so long a controller gives up."""

_CLOCK, _ROBOT = 1, 4


class TimeFacts:
    """Writes time as vectors, of the same size in all kitchens of a task.

    Layout: the share of the episode's time that is over; then for the robot itself and each other one, in their order,
    ready, thinking, at work, and how long it has been at what it is at, in units of LONG; then for each process of the
    task and each noun of the vocabulary how much of its time is over, 1 once it has come to its end.

    Args:
        robots: all robots.
        processes: names of those of the task.
        nouns: what they may be about.
        deadline: s at which the episode is over.
    """

    def __init__(
        self, robots: Sequence[str], processes: Iterable[str], nouns: Iterable[str], *, deadline: float
    ) -> None:
        self._robots, self._deadline = tuple(robots), deadline
        self._processes = [known()[name] for name in processes]
        nouns = tuple(nouns) if self._processes else ()
        self._places = {
            (process.name, noun): _CLOCK + _ROBOT * len(robots) + index * len(nouns) + at
            for index, process in enumerate(self._processes)
            for at, noun in enumerate(nouns)
        }
        self.size = _CLOCK + _ROBOT * len(robots) + len(self._places)

    def vector(self, robot: str, clock: EventClock, world: WorldState) -> NDArray[np.float32]:
        """Time as a robot sees it; shape (size,), values 0..1."""
        now, values = clock.now, np.zeros(self.size, np.float32)
        values[0] = min(now / self._deadline, 1.0)
        others = (other for other in self._robots if other != robot)
        for index, name in enumerate((robot, *others)):
            each, at = clock.doing(name), _CLOCK + _ROBOT * index
            kind = "" if each is None else each.kind
            values[at : at + 3] = (each is None, kind == "thinking", kind == "working")
            values[at + 3] = 0.0 if each is None else min((now - each.since) / LONG, 1.0)
        for (process, about), since in clock.processes.items():
            values[self._places[process.name, about]] = min((now - since) / process.seconds, 1.0)
        for process in self._processes:
            for name, item in world.objects.items() if process.mark else ():
                if process.mark in item.marks:
                    values[self._places[process.name, name]] = 1.0
        return values
