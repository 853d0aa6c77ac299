"""The event queue of what takes its time by itself: which processes go on, since when, and which end next."""

from __future__ import annotations

import math
from collections.abc import Mapping

from remac_env.rules.facts import Process, Rules
from remac_env.rules.processes import came_true, going_on
from remac_env.state import WorldState

DIGITS = 6
"""Decimals of a second that are kept."""

Key = tuple[Process, str]
"""A process, and the object or fixture that it is about."""


def in_words(running: Mapping[Key, float], now: float) -> dict[str, float]:
    """What goes on by itself as infos tell it: "process object" -> for how long it has gone on, s."""
    return {f"{process.name} {name}": round(now - since, DIGITS) for (process, name), since in running.items()}


class ProcessQueue:
    """The processes of one episode. What ceases to be so ends its process without an outcome.

    A door that has fallen shut before its time has come to its end then.
    """

    def __init__(self, rules: Rules) -> None:
        self._rules = rules
        self._since: dict[Key, float] = {}
        self._shut: frozenset[Key] = frozenset()
        self.known = bool(rules.processes)
        self.moves = any(process.does == "shut" for process in rules.processes)

    def look(self, world: WorldState, now: float) -> None:
        """Begin what can go on in this world, and forget what cannot any more."""
        if self._rules.processes:
            before, self._since = self._since, {key: self._since.get(key, now) for key in going_on(self._rules, world)}
            shut = {key for key in before if key[0].does == "shut" and came_true(world, *key)} if self.moves else ()
            self._shut = frozenset(shut)
            self._since |= {key: before[key] for key in before if key in self._shut}

    @property
    def next(self) -> float:
        """When the next one ends, s; infinite where none goes on."""
        return min([self._ends(key) for key in self._since], default=math.inf)

    def over(self, now: float) -> list[tuple[Process, str, float]]:
        """The processes that have come to their end, with when they began; they are forgotten."""
        ended = [(*key, since) for key, since in self._since.items() if self._ends(key) <= now or key in self._shut]
        for process, name, _ in ended:
            del self._since[process, name]
        return ended

    @property
    def running(self) -> dict[Key, float]:
        """What goes on, and since when, s."""
        return dict(self._since)

    def put_back(self, running: dict[Key, float]) -> None:
        """Go on from what `running` said."""
        self._since, self._shut = dict(running), frozenset()

    def _ends(self, key: Key) -> float:
        return round(self._since[key] + key[0].seconds, DIGITS)
