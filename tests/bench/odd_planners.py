"""Planners that do what no planner should, in the episodes of one kitchen: the one that ODD_SCENE describes."""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys
import time
from typing import Any

from remac_agents.planners.literal import LiteralPlanner


class Odd(Exception):
    """Has no words."""

    def __str__(self) -> str:
        raise TypeError("no words")


class Half(Exception):
    """Says half a pair."""

    def __str__(self) -> str:
        return "half a pair: \ud83d"


class Deep(BaseException):
    """Is no Exception."""


class Sour:
    """Raises whatever it is asked."""

    def __getattribute__(self, name: str) -> Any:
        raise Odd

    def __iter__(self) -> Any:
        raise Odd

    def __repr__(self) -> str:
        raise Odd

    __str__ = __repr__

    def __eq__(self, other: object) -> bool:
        raise Odd

    def __hash__(self) -> int:
        raise Odd


def _raises(error: Any) -> Any:
    raise error


def _spin() -> Any:
    while True:
        pass


def _deep() -> Any:
    return _deep()


DEEDS: dict[str, Any] = {
    "hangs": lambda: time.sleep(10_000),
    "spins": _spin,
    "counts": lambda: any(iter(int, 1)),
    "exits": lambda: sys.exit("enough"),
    "leaves": lambda: os._exit(0),
    "fails": lambda: ctypes.string_at(0),
    "stops": lambda: _raises(KeyboardInterrupt),
    "closes": lambda: _raises(GeneratorExit),
    "ends": lambda: _raises(StopIteration),
    "deep": lambda: _raises(Deep),
    "full": lambda: _raises(MemoryError),
    "recurses": _deep,
    "odd": lambda: _raises(Odd),
    "half": lambda: _raises(Half),
    "sour": Sour,
    "sour row": lambda: [Sour()],
    "sour rows": lambda: {Sour(): []},
    "sour plan": lambda: {"robot_0": Sour()},
}


class Misbehaves(LiteralPlanner):
    """A literal planner, but in one kitchen."""

    def __init__(self, deed: str, once: bool = False) -> None:
        self.deed, self.once, self.done = deed, once, False

    def plan(self, request: Any) -> Any:
        """A literal plan, or the deed."""
        if request.scene != os.environ["ODD_SCENE"] or (self.once and self.done):
            return super().plan(request)
        self.done = True
        return DEEDS[self.deed]()


class LeavesBehind(LiteralPlanner):
    """Starts something that goes on when its job is over."""

    def __init__(self) -> None:
        """Nothing of its own."""

    def plan(self, request: Any) -> Any:
        """A literal plan."""
        subprocess.Popen(["sleep", "1000"])
        return super().plan(request)


class Reviews:
    """A reflector that fails at the end of an episode."""

    def reflect(self, request: Any) -> list[str]:
        """Nothing."""
        return []

    def review(self, lessons: Any, *, success: bool) -> Any:
        """Cannot choose."""
        raise Odd
