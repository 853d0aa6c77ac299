"""How a method's turn is carried through the decision points of the event clock.

A method that plans in rounds sees rounds: whoever is done early waits until all are, and then it is sent all outcomes.
One that is made for the event clock is asked whenever a robot is ready, for those that are.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from remac_env.rules.subtasks import Subtask

Told = Mapping[str, Mapping[str, Any]]


class Pace:
    """Which robots are at what, and what has come of it since the method was asked.

    Args:
        in_step: the method plans in rounds.
    """

    def __init__(self, *, in_step: bool) -> None:
        self._in_step = in_step
        self._running: dict[str, Subtask] = {}
        self._ended: dict[str, tuple[Subtask, Mapping[str, Any]]] = {}
        self._turn: dict[str, Subtask] = {}
        self._timed = False

    def asked_for(self, turn: Mapping[str, Subtask], infos: Told) -> None:
        """Note what the method wants; robots that it leaves out are told something too (`sent`)."""
        self._timed = timed(infos)
        self._turn = (self._turn if self._timed else {}) | dict(turn)

    def sent(self, turn: Mapping[str, Subtask]) -> None:
        """Note what robots are told to do now."""
        self._running |= turn

    def take_in(self, infos: Told) -> bool:
        """Note what has ended; whether the method is to be asked now. With rounds it always is."""
        if not timed(infos):
            return True
        for robot, info in infos.items():
            if info["outcome"] and robot in self._running:
                self._ended[robot] = (self._running.pop(robot), info["outcome"])
        if self._in_step:
            return not self._running and all(info["ready"] for info in infos.values())
        return any(info["ready"] for info in infos.values())

    def gathered(self, infos: Told) -> dict[str, Mapping[str, Any]]:
        """The infos with the outcomes of all that has ended since the method was asked."""
        if not timed(infos):
            return dict(infos)
        return {robot: {**info, "outcome": self._ended[robot][1] if robot in self._ended else {}}
                for robot, info in infos.items()}  # fmt: skip

    def played(self) -> dict[str, Subtask]:
        """What has ended of what the method wanted, since it was asked; it is told once."""
        if not self._timed:
            return dict(self._turn)
        ended, self._ended = self._ended, {}
        return {robot: subtask for robot, (subtask, _) in ended.items() if self._turn.get(robot) == subtask}


def timed(infos: Told) -> bool:
    """Whether a kitchen runs by the event clock."""
    return any("ready" in info for info in infos.values())


def ready(infos: Told) -> tuple[str, ...]:
    """The robots that must decide now: with rounds all."""
    return tuple(robot for robot, info in infos.items() if info.get("ready", True))


def goes_on(infos: Told) -> bool:
    """Whether something takes its time by itself just now: whoever has nothing left to do waits for it."""
    return any(info.get("processes") for info in infos.values())
