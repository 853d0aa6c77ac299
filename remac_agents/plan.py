"""Plans, and how planners' replies become plans. What is no plan becomes a PlanError, not an exception."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from remac_env.state import FrozenMap
from remac_env.subtasks import SKILLS, WAIT, Subtask
from remac_env.vocabulary import normalise

MAX_STEPS = 200
"""A longer row of a plan is refused: no episode has so many rounds."""

_MARKER = re.compile(r"^\s*(?:[-*]|\(?\d+[.):])\s*")


@dataclass(frozen=True)
class PlanError:
    """Why a reply is no plan, in words that its planner can use to do better."""

    problem: str


@dataclass(frozen=True)
class Plan:
    """For each robot its subtasks, one a round. A robot whose row has ended waits."""

    rows: FrozenMap[tuple[Subtask, ...]]

    @classmethod
    def of(cls, rows: Mapping[str, Iterable[Subtask]]) -> Plan:
        """A plan from rows; waits at the end of a row say nothing and are cut off."""
        return cls(FrozenMap({robot: _without_last_waits(tuple(row)) for robot, row in rows.items()}))

    @property
    def robots(self) -> tuple[str, ...]:
        """The robots that the plan commands."""
        return tuple(self.rows)

    @property
    def length(self) -> int:
        """Number of rounds: subtasks that run at the same time count once."""
        return max((len(row) for row in self.rows.values()), default=0)

    def row(self, robot: str) -> tuple[Subtask, ...]:
        """The subtasks of one robot; empty for a robot that the plan does not command."""
        return self.rows.get(robot, ())

    def round(self, index: int = 0) -> dict[str, Subtask]:
        """What every robot of the plan does in round `index`."""
        return {robot: row[index] if index < len(row) else WAIT for robot, row in self.rows.items()}

    def rest(self) -> Plan:
        """The plan without its first round."""
        return Plan.of({robot: row[1:] for robot, row in self.rows.items()})

    def as_text(self) -> dict[str, tuple[str, ...]]:
        """Robot -> commands."""
        return {robot: tuple(subtask.text for subtask in row) for robot, row in self.rows.items()}

    def with_row(self, robot: str, row: Sequence[Subtask]) -> Plan:
        """The plan with another row for `robot`; its later rounds stay side by side with those of the others.

        Steps that were put in front make the others wait as long; where steps fell away the robot itself
        waits. Rounds at the front in which nobody does anything are dropped.
        """
        extra = len(row) - len(self.row(robot))
        rows = {name: (WAIT,) * max(0, extra) + old for name, old in self.rows.items()}
        rows[robot] = (WAIT,) * max(0, -extra) + tuple(row)
        plan = Plan.of(rows)
        while plan.length and all(subtask == WAIT for subtask in plan.round().values()):
            plan = plan.rest()
        return plan


def _without_last_waits(row: tuple[Subtask, ...]) -> tuple[Subtask, ...]:
    while row and row[-1] == WAIT:
        row = row[:-1]
    return row


class Commands(Mapping[str, Subtask]):
    """The legal commands of a kitchen: text -> subtask. Case, spaces and quotes do not matter."""

    def __init__(self, texts: Iterable[str]) -> None:
        """Args: texts: the commands as the kitchen lists them; those that no skill reads are left out."""
        parsed = {normalise(text): _subtask(normalise(text)) for text in texts}
        self._subtasks = {text: subtask for text, subtask in parsed.items() if subtask is not None}

    def __getitem__(self, text: str) -> Subtask:
        return self._subtasks[normalise(text)]

    def __iter__(self) -> Iterator[str]:
        return iter(self._subtasks)

    def __len__(self) -> int:
        return len(self._subtasks)

    def parse(self, text: str) -> Subtask | None:
        """The subtask that a text names exactly, or None."""
        return self._subtasks.get(normalise(text))

    def allows(self, subtask: Subtask) -> bool:
        """True when the subtask is one of these commands."""
        return self._subtasks.get(normalise(subtask.text)) == subtask


def _subtask(text: str) -> Subtask | None:
    """The subtask whose text this is, by the forms of the skill table; skills without target come first."""
    for name, skill in sorted(SKILLS.items(), key=lambda item: "{}" in item[1].form):
        before, gap, after = skill.form.partition("{}")
        if not gap:
            if text == before:
                return Subtask(name)
        elif text.startswith(before) and text.endswith(after) and len(text) > len(before) + len(after):
            return Subtask(name, text[len(before) : len(text) - len(after)])
    return None


def read_plan(reply: object, commands: Commands, robots: Sequence[str], lead: str) -> Plan | PlanError:
    """A planner's reply as a plan.

    Args:
        reply: a Plan, a mapping robot -> commands, a list of commands (for the leading robot), or text.
        commands: what is legal in this kitchen.
        robots: whom the plan may command.
        lead: whose row a bare list is.
    """
    if isinstance(reply, PlanError):
        return reply
    if isinstance(reply, str):
        return parse_text(reply, commands, robots, lead)
    if isinstance(reply, Plan):
        reply = reply.rows
    if isinstance(reply, Mapping):
        return _from_mapping(reply, commands, robots)
    if isinstance(reply, Iterable):
        return _from_mapping({lead: list(reply)}, commands, robots)
    return PlanError(f"a plan is a mapping from robots to lists of commands, not {type(reply).__name__}")


def parse_text(text: str, commands: Commands, robots: Sequence[str], lead: str) -> Plan | PlanError:
    """A plan from simple text: JSON, or one command a line with rows headed by `robot name:`.

    Lines without a heading belong to the leading robot; bullets and numbers at their start are ignored.
    """
    stripped = text.strip()
    if stripped.startswith(("{", "[")):
        try:
            return read_plan(json.loads(stripped), commands, robots, lead)
        except (json.JSONDecodeError, RecursionError) as error:
            return PlanError(f"the text starts like JSON but is none: {error}")
    rows: dict[str, list[object]] = {}
    robot = lead
    for line in stripped.splitlines():
        head, colon, tail = line.partition(":")
        named = normalise(head).replace(" ", "_")
        known = {normalise(name).replace(" ", "_"): name for name in robots}
        if colon and named in known:
            robot, line = known[named], tail
            rows.setdefault(robot, [])
        parts = (_MARKER.sub("", part).strip() for part in re.split(r"[,;]", line))
        rows.setdefault(robot, []).extend(part for part in parts if part)
    if not any(rows.values()):
        return PlanError("the text names no command")
    return _from_mapping(rows, commands, robots)


def _from_mapping(rows: Mapping[Any, Any], commands: Commands, robots: Sequence[str]) -> Plan | PlanError:
    read: dict[str, list[Subtask]] = {}
    for robot, row in rows.items():
        if robot not in robots:
            return PlanError(f"unknown robot {robot!r}; valid: {', '.join(robots)}")
        if isinstance(row, str) or not isinstance(row, Iterable):
            return PlanError(f"the row of {robot} is not a list of commands")
        entries = list(row)
        if len(entries) > MAX_STEPS:
            return PlanError(f"the row of {robot} has {len(entries)} subtasks; valid: at most {MAX_STEPS}")
        subtasks = [_read_step(entry, commands) for entry in entries]
        for entry, subtask in zip(entries, subtasks, strict=True):
            if subtask is None:
                return PlanError(f"{str(entry)[:80]!r} is not a command; valid: {', '.join(commands)}")
        read[str(robot)] = [subtask for subtask in subtasks if subtask is not None]
    return Plan.of(read)


def _read_step(entry: object, commands: Commands) -> Subtask | None:
    if isinstance(entry, Subtask):
        return entry if commands.allows(entry) else None
    return commands.parse(entry) if isinstance(entry, str) else None
