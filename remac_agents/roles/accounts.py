"""What a planner is told of what has happened: commands that were run, the try before, answers that were refused."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from remac_env.rules.conditions import Condition
from remac_env.rules.subtasks import WAIT, Subtask

_LINE = re.compile(
    r"(?:round (?P<round>\d{1,6}), )?(?P<robot>.+?): (?P<command>.+) \((?P<status>success|failure)(?:: (?P<why>.+))?\)"
)
_STATUS = {True: "success", False: "failure", None: "unknown"}


@dataclass(frozen=True)
class Ran:
    """A command that was run.

    Attributes:
        round: of the episode, from 1; 0 where nobody wrote it down.
        robot, command: who ran what.
        succeeded: as the kitchen reported it, None where it said nothing.
        reason: why it failed, only where the kitchen's feedback gives it.
    """

    round: int
    robot: str
    command: str
    succeeded: bool | None = None
    reason: str | None = None

    @property
    def failed(self) -> bool:
        """Whether it was reported as a failure."""
        return self.succeeded is False

    @property
    def status(self) -> str:
        """success, failure or unknown, with the reason where there is one."""
        return f"{_STATUS[self.succeeded]}: {self.reason}" if self.reason else _STATUS[self.succeeded]

    @property
    def line(self) -> str:
        """The same as a line of the memory."""
        return f"round {self.round}, {self.robot}: {self.command} ({self.status})"

    @classmethod
    def read(cls, line: str) -> Ran | None:
        """What a line of the memory says; None where it tells of no command that ended."""
        match = _LINE.fullmatch(line)
        if match is None:
            return None
        number, robot, command, status, why = match.groups()
        return cls(int(number or 0), robot, command, status == "success", why)


@dataclass(frozen=True)
class Attempt:
    """A step of this episode as its planner hears of it.

    Attributes:
        robot, subtask: whose step it is, and which.
        ran: False for a step that was only proposed and then refused.
        succeeded: how it ended, None where nobody said.
        false: what the checker found false about it.
        reason: why it failed, where the kitchen's feedback gives it.
    """

    robot: str
    subtask: Subtask
    ran: bool
    succeeded: bool | None = None
    false: tuple[Condition, ...] = ()
    reason: str | None = None


@dataclass(frozen=True)
class PreviousTry:
    """The iteration before this one.

    Attributes:
        plan: its first plan, robot -> commands.
        success: whether it reached the goal.
        ran: what was run, in order.
    """

    plan: Mapping[str, tuple[str, ...]]
    success: bool
    ran: tuple[Ran, ...] = ()

    @property
    def rounds(self) -> int | None:
        """How many rounds were played, as far as commands were run in them; None where that was not written down."""
        return max((ran.round for ran in self.ran), default=0) or None

    @property
    def failed(self) -> dict[str, int]:
        """ "robot: command" -> how often it failed, those that did."""
        failed = [f"{ran.robot}: {ran.command}" for ran in self.ran if ran.failed]
        return {what: failed.count(what) for what in failed}

    @property
    def changed(self) -> bool:
        """Whether other commands were run than those of the plan, tries that were repeated not counted."""
        robots = dict.fromkeys([*self.plan, *(ran.robot for ran in self.ran)])
        rows = {name: _tried(ran.command for ran in self.ran if ran.robot == name) for name in robots}
        return any(row != _tried(self.plan.get(name, ()))[: len(row)] for name, row in rows.items())


@dataclass(frozen=True)
class Repair:
    """An `answer` that could not be used, as text ("" where none came), and all its `problems`, each a sentence."""

    answer: str
    problems: tuple[str, ...]


def _tried(commands: Iterable[str]) -> list[str]:
    return [command for command, _ in itertools.groupby(text for text in commands if text != WAIT.text)]
