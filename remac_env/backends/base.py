"""What the two backends share: an exact start going in, the result of a round coming out."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from remac_env.errors import LifecycleError, check_choice
from remac_env.rules.facts import Process
from remac_env.rules.outcomes import Outcome
from remac_env.rules.subtasks import Subtask
from remac_env.start import Offset, Start
from remac_env.state import WorldState


@dataclass(frozen=True)
class Counters:
    """What a round cost and whether robots came near one another; all zero in the symbolic backend.

    `robot_contacts` and `near_misses` count control steps in which two robots touched, or were within 0.05 m.
    """

    control_steps: int = 0
    physics_steps: int = 0
    robot_contacts: int = 0
    near_misses: int = 0

    def __add__(self, other: Counters) -> Counters:
        return self if other is NOTHING_COUNTED else Counters(
            self.control_steps + other.control_steps,
            self.physics_steps + other.physics_steps,
            self.robot_contacts + other.robot_contacts,
            self.near_misses + other.near_misses,
        )


NOTHING_COUNTED = Counters()


@dataclass(frozen=True)
class RoundResult:
    """The kitchen at rest after a round. `seconds` is the round's simulated time, as long as its slowest robot."""

    world: WorldState
    outcomes: Mapping[str, Outcome]
    seconds: float
    counters: Counters = NOTHING_COUNTED


class Backend(Protocol):
    """A kitchen that can be put into a start and run round by round, or subtask by subtask.

    A round is: `begin` all, `advance` until nobody is busy, let the kitchen come to rest, judge. `watch` is called once
    a control period (in the symbolic backend once a round, or once an `advance`) while something moves. `pictures`
    draws what a robot's cameras show, for controllers that look.
    """

    watch: Callable[[], None] | None
    pictures: Callable[[str], Mapping[str, NDArray[np.uint8]]] | None

    def reset(self, start: Start) -> WorldState:
        """Put the kitchen into this start; the world that results."""

    def begin(self, subtasks: Mapping[str, Subtask]) -> Mapping[str, Outcome]:
        """Start subtasks of idle robots, as claims allow; time stands still.

        What busy robots claim - where they began, where they end, what they take - is theirs until they have ended.

        Returns:
            The outcomes of those that are refused; the other robots are busy from now on.

        Raises:
            LifecycleError: before reset, or for a robot that is busy. Nothing has begun then.
            UnknownNameError: for a robot that is not in the kitchen.
        """

    def advance(self, *, until: float = math.inf) -> Mapping[str, Outcome]:
        """Run until the next subtask ends; the outcomes of all that end then, nothing where nobody is busy.

        Each is judged by the world as it is then. When the last robot ends the kitchen comes to rest first.

        Args:
            until: what the `clock` shows at most, s: where nothing has ended by then, time has passed until then.
        """

    def stop(self, robot: str) -> None:
        """Tell a busy robot to stop: its controller ends at its next safe pose, time stands still until then.

        For a drive that is where it goes, as others reckon with it; for another skill its home pose at the station.
        What it has moved by then stays as it is. `advance` tells the outcome, `interrupted` unless the subtask has
        done what it says.

        Raises:
            LifecycleError: for a robot that is not busy.
        """

    def happen(self, process: Process, name: str) -> None:
        """Let what comes of a process come true of the object or fixture that it is about; time stands still.

        What moves by itself while a process goes on, see `go_on`, has moved by then, or something is in its way.
        """

    def go_on(self, processes: Mapping[tuple[Process, str], float]) -> None:
        """Take note of what takes its time by itself from now on, where that moves anything, and since when, s."""

    def run_round(self, subtasks: Mapping[str, Subtask]) -> RoundResult:
        """Every robot runs its subtask at the same time, until each has ended and the kitchen is at rest.

        Raises:
            LifecycleError: before reset, or while a robot is busy with what it began.
        """

    @property
    def world(self) -> WorldState:
        """The world after the last round, `begin` or `advance`."""

    @property
    def settled(self) -> WorldState:
        """The world in which what is under way has changed nothing yet: what takes its time begins and ends by it."""

    @property
    def busy(self) -> frozenset[str]:
        """The robots whose subtasks have begun and not ended."""

    @property
    def clock(self) -> float:
        """Simulated seconds since the start."""

    @property
    def counters(self) -> Counters:
        """What has been counted since the start."""

    def positions(self) -> NDArray[np.float64] | None:
        """Joint positions now (qpos, rad and m), or None where nothing is simulated."""

    def close(self) -> None:
        """Free what the backend holds; may be called twice."""


def check_idle(robots: Iterable[str], known: Sequence[str], busy: Collection[str]) -> None:
    """Refuse to begin anything for robots that are busy or not in the kitchen; see :meth:`Backend.begin`."""
    for robot in robots:
        if robot not in known:
            check_choice("robot", robot, known)
        if robot in busy:
            idle = ", ".join(name for name in known if name not in busy) or "none, until advance() ends a subtask"
            raise LifecycleError(f"{robot} is busy; valid: {idle}")


def check_busy(robot: str, busy: Collection[str]) -> None:
    """Refuse to stop a robot that does nothing; see :meth:`Backend.stop`."""
    if robot not in busy:
        raise LifecycleError(f"{robot} is not busy; valid: {', '.join(sorted(busy)) or 'none'}")


def check_all_idle(busy: Collection[str]) -> None:
    """Refuse a round while robots are busy; see :meth:`Backend.run_round`."""
    if busy:
        names = ", ".join(sorted(busy))
        raise LifecycleError(f"a round needs every robot idle, and {names} is busy; valid: advance() until none is")


__all__ = ["Backend", "Counters", "Offset", "RoundResult", "Start", "check_all_idle", "check_busy", "check_idle"]
