"""What robots see of time: the clock, what each robot of the team is at, and what takes its time by itself."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from remac_env.events.clock import EventClock
from remac_env.rules.processes import known
from remac_env.state import WorldState

LONG = 60.0
"""s that what a robot is at has taken when the figure for it is 1: after so long a controller gives up."""

_CLOCK, _ROBOT = 1, 4
_READY = [(0, 1.0)]
_KINDS = {"thinking": 1, "working": 2}


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
        self._deadline = deadline
        self._orders = {robot: (robot, *(other for other in robots if other != robot)) for robot in robots}
        self._processes = [known()[name] for name in processes]
        nouns = tuple(nouns) if self._processes else ()
        self._places = {
            (process.name, noun): _CLOCK + _ROBOT * len(robots) + index * len(nouns) + at
            for index, process in enumerate(self._processes)
            for at, noun in enumerate(nouns)
        }
        self.size = _CLOCK + _ROBOT * len(robots) + len(self._places)

    def write(
        self, seen: Mapping[str, NDArray[np.float32]], clock: EventClock, world: WorldState, unseen: Collection[str]
    ) -> None:
        """Write time as each robot sees it, values 0..1, where the last `size` figures of what it has seen are 0.

        unseen: objects of which nothing is told.
        """
        now, start = clock.now, -self.size
        over, at_work = min(now / self._deadline, 1.0), self._at_work(clock, now)
        slow = self._slow(clock, world, now, unseen) if self._processes else ()
        for robot, values in seen.items():
            values[start], block = over, start + _CLOCK
            for name in self._orders[robot]:
                for place, value in at_work[name]:
                    values[block + place] = value
                block += _ROBOT
            for place, value in slow:
                values[start + place] = value

    def _at_work(self, clock: EventClock, now: float) -> dict[str, list[tuple[int, float]]]:
        """Of each robot, the places in its block that are not 0, and what stands there."""
        found = {}
        for name in self._orders:
            each = clock.doing(name)
            if each is None:
                found[name] = _READY
                continue
            kind = _KINDS.get(each.kind)
            since = (_ROBOT - 1, min((now - each.since) / LONG, 1.0))
            found[name] = [since] if kind is None else [(kind, 1.0), since]
        return found

    def _slow(
        self, clock: EventClock, world: WorldState, now: float, unseen: Collection[str]
    ) -> list[tuple[int, float]]:
        """Places of what goes on by itself or is over, and how much of its time is."""
        places = self._places
        goes_on = [(*key, since) for key, since in clock.processes.items() if key[1] not in unseen]
        found = [(places[each.name, name], min((now - since) / each.seconds, 1.0)) for each, name, since in goes_on]
        for process in self._processes:
            for name, item in world.objects.items() if process.mark else ():
                if process.mark in item.marks and name not in unseen:
                    found.append((places[process.name, name], 1.0))
        return found
