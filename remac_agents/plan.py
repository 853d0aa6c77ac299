"""Plans, and how planners' replies become plans. What is not a plan becomes a PlanError, not an exception."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, MappingView, Sequence, Set
from dataclasses import dataclass
from typing import Any

from remac_agents.text.plan_text import PlanText, UnreadableError
from remac_agents.text.plan_words import Names, nearest
from remac_agents.text.printable import quoted, type_name
from remac_env.files import unmarked
from remac_env.rules.skills import SKILLS
from remac_env.rules.subtasks import WAIT, Subtask
from remac_env.state import FrozenMap
from remac_env.words import normalise

BYTES = bytes | bytearray | memoryview
"""A text that nobody decoded: no list of numbers."""

MAX_STEPS = 200
"""A longer row of a plan is refused: no episode has so many rounds."""

MAX_CHARACTERS = 400_000
"""A longer text is refused unread; thoughts count."""

MAX_PROBLEMS = 12
"""Problems of one reply that are told and looked for."""

_UNORDERED: tuple[type, ...] = (Set, MappingView, type(iter(frozenset())))
"""What goes through its parts in an order that may differ from run to run, or that was not meant."""


@dataclass(frozen=True)
class PlanError:
    """Why a reply is not a plan, in words that its planner can use to do better.

    `entry`, with its `robot` and `index` in the row from 0, is what stands in a plan and is not a command of this
    kitchen; all three are None for a reply that cannot be read as a plan. `problem` comes first, `more` are the rest.
    """

    problem: str
    robot: str | None = None
    index: int | None = None
    entry: str | None = None
    more: tuple[str, ...] = ()

    @property
    def problems(self) -> tuple[str, ...]:
        """Everything that is wrong, each problem once."""
        return (self.problem, *self.more)

    @property
    def told(self) -> str:
        """Everything that is wrong, in one line."""
        return "; ".join(self.problems)

    @classmethod
    def of(cls, errors: Sequence[PlanError]) -> PlanError:
        """All that several errors say, as one; at least one is needed."""
        first = errors[0]
        others = [text for error in errors for text in error.problems]
        more = [text for text in dict.fromkeys(others) if text != first.problem]
        if len(more) >= MAX_PROBLEMS:
            more = [*more[: MAX_PROBLEMS - 2], "and more of this kind"]
        return cls(first.problem, first.robot, first.index, first.entry, tuple(more))


@dataclass(frozen=True)
class Plan:
    """`rows`: for each robot its subtasks, one a round. A robot whose row has ended waits."""

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
        """The subtask that a text names exactly, or None.

        Letters that only look like those of a command, or become them in lower case, do not name it. A byte order
        mark before it is passed over, as in texts.
        """
        text = unmarked(text.lstrip())
        if not text.isascii() and " ".join(text.split()) not in self._subtasks:
            return None
        return self._subtasks.get(normalise(text))

    def unknown(self, entry: object) -> str:
        """That something is not a command, with the nearest ones. It is quoted in ASCII, cut short."""
        told = str(entry)[:80] if isinstance(entry, str) else quoted(entry)
        near = nearest(told, self._subtasks)
        offered = f"; nearest: {near}" if near else "; valid: one of the listed commands"
        return f"{told!a} is not a command{offered}"

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
        reply: a Plan, a mapping robot -> commands (which may lie under "plan"), a list of commands (for the
            leading robot), or text.
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
    names = Names(robots, lead, commands.unknown)
    if isinstance(reply, Mapping):
        rows = names.rows(reply)
        return PlanError(rows) if isinstance(rows, str) else _from_rows(rows, commands, names)
    if is_unordered(reply):
        return PlanError(f"a {type_name(reply)} has no order; valid: a list of commands, or a mapping to lists")
    if not isinstance(reply, BYTES) and (steps := first_of(reply, MAX_STEPS + 1)) is not None:
        return _from_rows({lead: steps}, commands, names)
    return PlanError(f"a plan is a mapping from robots to lists of commands, not {type_name(reply)}")


def first_of(value: object, most: int) -> list[Any] | None:
    """The first parts of something that can be walked through; None for what cannot, whatever it says it can."""
    try:
        walk = iter(value) if isinstance(value, Iterable) else None
    except TypeError:  # such as an array of no dimensions
        return None
    return None if walk is None else list(itertools.islice(walk, most))


def is_unordered(value: object) -> bool:
    """Whether something is a set, a view of a mapping, or a walk through a set: nobody can know what comes first."""
    return isinstance(value, _UNORDERED)


def parse_text(text: str, commands: Commands, robots: Sequence[str], lead: str) -> Plan | PlanError:
    """The one plan that a text states, in any of the forms of `plan_text`; rows without a name are the lead's.

    A plan may stand there twice, but two different ones are an error: which is meant, nobody can know.
    """
    if len(text) > MAX_CHARACTERS:
        return PlanError(f"the text has {len(text)} characters; valid: at most {MAX_CHARACTERS}")
    names = Names(robots, lead, commands.unknown)
    reader = PlanText(lambda part: commands.parse(part) is not None, names)
    errors: list[PlanError] = []
    try:
        found = reader.read(text)
    except UnreadableError as error:
        found, errors = [], [PlanError(str(error))]
    plans: list[Plan] = []
    different: list[Mapping[str, Any]] = []
    for rows in itertools.takewhile(lambda _: len(errors) < MAX_PROBLEMS, found):
        plan = _from_rows(rows, commands, names)
        if isinstance(plan, PlanError):
            errors.append(plan)
            different += [rows] if rows not in different else []
        elif not any(_says_the_same(plan, other) for other in plans):
            plans.append(plan)
    errors = [*(PlanError(problem) for problem in reader.problems), *errors]
    if len(plans) + len(different) > 1:
        errors.append(PlanError(f"the answer holds {len(plans) + len(different)} different plans; give one"))
    return PlanError.of(errors) if errors else plans.pop()


def _says_the_same(plan: Plan, other: Plan) -> bool:
    """Whether two plans differ in empty rows at most."""
    return all(plan.row(robot) == other.row(robot) for robot in (*plan.robots, *other.robots))


def _from_rows(rows: Mapping[str, Any], commands: Commands, names: Names) -> Plan | PlanError:
    """The plan, or everything that is wrong with its rows."""
    read: dict[str, list[Subtask]] = {}
    errors = [PlanError(names.stranger(robot)) for robot in rows if robot not in names.robots]
    for robot, row in rows.items():
        if is_unordered(row):
            told = f"the row of {robot} is a {type_name(row)}, which has no order; valid: a list of commands"
            errors.append(PlanError(told))
            continue
        if isinstance(row, str | Mapping | BYTES) or not isinstance(row, Iterable):
            errors.append(PlanError(f"the row of {robot} is not a list of commands"))
            continue
        entries = list(itertools.islice(row, MAX_STEPS + 1))
        if len(entries) > MAX_STEPS:
            errors.append(PlanError(f"the row of {robot} has more subtasks than valid: at most {MAX_STEPS}"))
        steps = [_read_step(entry, commands) for entry in entries[:MAX_STEPS]]
        wrong = [(index, entries[index]) for index, step in enumerate(steps) if step is None]
        errors += [_no_command(entry, robot, index, commands) for index, entry in wrong[:MAX_PROBLEMS]]
        if len(wrong) > MAX_PROBLEMS:
            errors.append(PlanError(f"and {len(wrong) - MAX_PROBLEMS} more in the row of {robot}"))
        read[robot] = [step for step in steps if step is not None]
    return PlanError.of(errors) if errors else Plan.of(read)


def _no_command(entry: object, robot: str, index: int, commands: Commands) -> PlanError:
    told = entry[:80] if isinstance(entry, str) else quoted(entry)
    return PlanError(commands.unknown(entry), robot=robot, index=index, entry=told)


def _read_step(entry: object, commands: Commands) -> Subtask | None:
    if isinstance(entry, Subtask):
        return entry if commands.allows(entry) else None
    return commands.parse(entry) if isinstance(entry, str) else None
