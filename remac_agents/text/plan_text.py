"""Finds the plans that a text states, as rows of strings. What it does not recognise it does not guess at.

    Plan: [first command, second command]     a list after a heading, in a sentence, or as JSON
    agent0: [...]   Robot 1: ...              a row of its own for each robot
    {"plan": {"robot_0": [...]}}              JSON, also in a Markdown fence
    1. first command                          lists with numbers or bullets
    first command, second command             lines that hold nothing but commands
Thoughts (thoughts.py) are passed over, and so is prose. A list or line in which some parts are commands is taken
with all of its parts, so that what is not a command in it comes to light.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from remac_agents.text.plan_words import Names, list_item, opening, split_heading, without_thoughts
from remac_env.rules.skills import SKILLS
from remac_env.words import normalise

Rows = dict[str, list[object]]

MAX_VALUES = 100
"""Lists and objects that one text may hold."""

MAX_DEPTH = 12
"""How deep they may be nested."""

_PAIRS = re.compile(r"[\"']?(?P<name>\w[\w ]{0,39}?)[\"']?\s*:\s*\[(?P<row>[^\[\]{}]*)\]\s*(?:,\s*|$)")


class UnreadableError(Exception):
    """The text is not a plan; the message says why, for its author."""


class PlanText:
    """Reads one text. `legal` says whether a string is a command; `names` knows the robots.

    `problems`: what is wrong in a text that can be read all the same, so that all of it can be told at once.
    """

    def __init__(self, legal: Callable[[str], bool], names: Names) -> None:
        self._legal, self._names = legal, names
        self._plans: list[Rows] = []
        self._rows: Rows = {}
        self._robot = names.lead
        self._headed = False
        self._items: list[str] = []
        self._lines: list[str] = []
        self._number: int | None = None
        self._goes_on = False
        self._stated = False
        self._values = 0
        self.problems: list[str] = []
        self._doubtful = ""
        self._last_resort: list[object] = []

    def read(self, text: str) -> list[Rows]:
        """Every plan in the text, one or more.

        Raises:
            UnreadableError: if there is none, or if part of it is broken.
        """
        told = without_thoughts(text)
        if told is None:
            raise UnreadableError("the answer ends in the middle of its thoughts")
        lines = told.splitlines()[::-1]
        while lines:
            self._line(lines.pop().strip(), lines)
        self._close_plan()
        if self._plans:
            return self._plans
        if self._last_resort:
            return [{self._names.lead: self._last_resort}]
        if self._doubtful:
            raise UnreadableError(self._doubtful)
        raise UnreadableError("the text names no command")

    # -- lines -----------------------------------------------------------------------------------------------

    def _line(self, line: str, following: list[str]) -> None:
        """One line; `following` are those after it, the next one last."""
        if not line:
            self._end_lines()
            self._headed = False
            return
        name, tail = split_heading(line)
        headed = name is not None and self._heading(name)
        if headed:
            line, self._headed = tail, True
            if not line:
                return
        item = None if headed else list_item(line)
        if item is not None:
            self._item(*item)
        elif (start := opening(line)) is not None and self._value(line, start, following):
            return
        else:
            self._end_items()
            self._lines.append(line)

    def _heading(self, name: str) -> bool:
        """Take in a heading; False when it is none."""
        kind = self._names.heading(name)
        if kind is None:
            return False
        if kind == "unknown":
            self.problems.append(self._names.stranger(name))
            kind = name
        self._end_block()
        if kind == "plan" or kind in self._rows:
            self._close_plan()
        if kind != "plan":
            self._robot = kind
            self._rows[kind] = []
        return True

    def _item(self, number: int | None, text: str) -> None:
        self._end_lines()
        if self._items and number is not None and number != (self._number or 0) + 1:
            self._end_items()
        if not self._items:
            self._goes_on = number is not None and number > 1 and number == (self._number or 0) + 1
        self._number = number
        self._items.append(text)

    def _end_block(self) -> None:
        self._end_items()
        self._end_lines()
        self._headed = False

    def _end_items(self) -> None:
        items, self._items = self._items, []
        if items:
            self._add(_parts(items), strict=False, goes_on=self._goes_on)

    def _end_lines(self) -> None:
        lines, self._lines = self._lines, []
        headed, self._headed = self._headed, self._headed and not lines
        if lines and lines[0].endswith(":") and not self._legal(lines[0]):
            lines = lines[1:]
        if lines:
            self._add(_parts(lines), strict=headed, goes_on=False)

    # -- lists and objects -----------------------------------------------------------------------------------

    def _value(self, line: str, start: int, following: list[str]) -> bool:
        """Read the list or object that opens at `start`; False when the line is prose with a bracket in it."""
        first = self._headed or start == 0
        if any(self._legal(part) for part in _parts([line[:start]])):
            raise UnreadableError(f"a command stands right before a list: {line[:80]!a}")
        word = None if self._headed else split_heading(line[:start])[0]
        if word is not None and " " not in word.strip():
            self.problems.append(self._names.stranger(word))
            self._headed = True
        self._values += 1
        if self._values > MAX_VALUES:
            raise UnreadableError(f"the text holds more than {MAX_VALUES} lists")
        text = "\n".join([line[start:], *following[::-1]]) if first else line[start:]
        end = _closing(text)
        if end is None and not first:
            return False
        if end is None:
            raise UnreadableError("the text starts like JSON but is none: a bracket is not closed")
        headed, rest = self._headed, text[end + 1 :]
        if not first and text.startswith("{") and "[" not in text[:end]:
            return False
        self._end_block()
        self._take(_parse(text[: end + 1]), strict=headed)
        more = rest.splitlines()
        if first:
            following[:] = more[:0:-1]
        if more and (left := more[0].strip(" \t,;.")):
            self._line(left, following)
        return True

    def _take(self, value: object, *, strict: bool) -> None:
        if isinstance(value, Mapping):
            rows = self._names.rows(value)
            if isinstance(rows, str):
                raise UnreadableError(rows)
            self._close_plan()
            self._plans.append(rows)
        elif isinstance(value, list):
            self._add(value, strict=strict, whole=True)

    # -- plans -----------------------------------------------------------------------------------------------

    def _add(self, parts: Sequence[object], *, strict: bool, goes_on: bool = False, whole: bool = False) -> None:
        """Add a row or the end of one, unless it is prose: then its first words are kept for the complaint."""
        legal = [part for part in parts if isinstance(part, str) and self._legal(part)]
        idle = {skill.form for skill in SKILLS.values() if skill.still}
        telling = [part for part in legal if normalise(part) not in idle]
        sure = strict or telling or whole or goes_on or self._rows.get(self._robot) == []
        if not sure and len(legal) == len(parts):
            self._last_resort = list(parts)  # "Done." ends many an answer, and is also an answer
            return
        if not sure or (whole and parts and not legal and not strict):
            self._doubtful = self._doubtful or self._names.unknown(parts[0] if parts else "")
            return
        if self._rows.get(self._robot) and not goes_on:
            robot = self._robot
            self._close_plan()
            self._robot = robot
        self._rows.setdefault(self._robot, []).extend(parts)
        self._stated = self._stated or whole

    def _close_plan(self) -> None:
        self._end_block()
        if self._stated or any(self._rows.values()):
            self._plans.append(self._rows)
        self._rows, self._robot = {}, self._names.lead
        self._stated, self._number = False, None


def _parts(lines: Sequence[str]) -> list[str]:
    parts = (part.strip(" \t*`") for line in lines for part in re.split(r"[,;]", line))
    return [part for part in parts if part.strip(" .")]


def _closing(text: str) -> int | None:
    """Index of the bracket that closes the first one; None where there is none.

    Raises:
        UnreadableError: if brackets are nested too deep.
    """
    depth, quoted, escaped = 0, False, False
    for index, letter in enumerate(text):
        if quoted:
            quoted = letter != '"' or escaped
            escaped = letter == "\\" and not escaped
        elif letter == '"':
            quoted, escaped = True, False
        elif letter in "[{":
            depth += 1
            if depth > MAX_DEPTH:
                raise UnreadableError(f"the JSON is nested deeper than {MAX_DEPTH}")
        elif letter in "]}":
            depth -= 1
            if depth == 0:
                return index
    return None


def _parse(text: str) -> Any:
    """JSON, or a list or mapping of lists without quotes.

    Raises:
        UnreadableError: for anything else, and for a key that stands twice in one object.
    """
    try:
        return json.loads(text, object_pairs_hook=_object)
    except (ValueError, RecursionError) as error:
        problem = str(error)
    inner = text[1:-1].strip()
    if text.startswith("[") and not re.search(r"[\[\]{}]", inner):
        return [part for part in (part.strip(" \t\n\"'") for part in re.split(r"[,;\n]", inner)) if part]
    pairs, position = [], 0
    while text.startswith("{") and inner[position:].strip():
        match = _PAIRS.match(inner, position)
        if match is None:
            break
        row = [part.strip(" \t\n\"'") for part in match["row"].split(",")]
        pairs.append((match["name"], [part for part in row if part]))
        position = match.end()
    if pairs and not inner[position:].strip():
        return _object(pairs)
    raise UnreadableError(f"the text starts like JSON but is none: {problem[:120]}")


def _object(pairs: Sequence[tuple[str, Any]]) -> dict[str, Any]:
    read = dict(pairs)
    if len(read) < len(pairs):
        raise UnreadableError("the answer holds two different plans: a key stands twice in one JSON object")
    return read
