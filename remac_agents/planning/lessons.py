"""Reflections in a fixed form that people and rules can both read.

Before "<command>", do "<command>", "<command>".
With the <object> in hand, use "<command>" instead of "<command>".
Leave out "<command>": it is done already.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from remac_agents.plan import Commands
from remac_env.rules.subtasks import Subtask

_BEFORE = re.compile(r'^Before "([^"]+)", do ("[^"]+"(?:, "[^"]+")*)\.$')
_INSTEAD = re.compile(r'^With the (.+) in hand, use "([^"]+)" instead of "([^"]+)"\.$')
_LEAVE_OUT = re.compile(r'^Leave out "([^"]+)": it is done already\.$')


@dataclass(frozen=True)
class Before:
    """`steps` belong before `anchor`."""

    anchor: Subtask
    steps: tuple[Subtask, ...]

    @property
    def text(self) -> str:
        """The lesson in words."""
        return f'Before "{self.anchor.text}", do ' + ", ".join(f'"{step.text}"' for step in self.steps) + "."


@dataclass(frozen=True)
class Instead:
    """With `held` in hand, `use` is to be run where `not_this` stands."""

    held: str
    use: Subtask
    not_this: Subtask

    @property
    def text(self) -> str:
        """The lesson in words."""
        return f'With the {self.held} in hand, use "{self.use.text}" instead of "{self.not_this.text}".'


@dataclass(frozen=True)
class LeaveOut:
    """`subtask` has nothing to do."""

    subtask: Subtask

    @property
    def text(self) -> str:
        """The lesson in words."""
        return f'Leave out "{self.subtask.text}": it is done already.'


Lesson = Before | Instead | LeaveOut


def read_lesson(text: str, commands: Commands) -> Lesson | None:
    """The lesson that a reflection states, or None for other words or commands that this kitchen lacks."""
    if match := _BEFORE.match(text.strip()):
        anchor = commands.parse(match[1])
        steps = _read_all(re.findall(r'"([^"]+)"', match[2]), commands)
        return Before(anchor, steps) if anchor is not None and steps else None
    if match := _INSTEAD.match(text.strip()):
        use, other = commands.parse(match[2]), commands.parse(match[3])
        return Instead(match[1], use, other) if use is not None and other is not None else None
    if match := _LEAVE_OUT.match(text.strip()):
        subtask = commands.parse(match[1])
        return LeaveOut(subtask) if subtask is not None else None
    return None


def is_leave_out(text: str) -> bool:
    """Whether a reflection says that a step is superfluous."""
    return _LEAVE_OUT.match(text.strip()) is not None


def looked_for(text: str) -> str | None:
    """The way to which a reflection sends a robot round by another place; None for other reflections."""
    match = _BEFORE.match(text.strip())
    return match[1] if match is not None and match[1].startswith("navigate to ") else None


def _read_all(texts: Sequence[str], commands: Commands) -> tuple[Subtask, ...]:
    steps = [commands.parse(text) for text in texts]
    return tuple(step for step in steps if step is not None) if None not in steps else ()
