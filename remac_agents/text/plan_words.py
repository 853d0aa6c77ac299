"""The words around a plan: thoughts, headings, bullets, and the ways in which robots are called."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from remac_agents.text.thoughts import split_thoughts
from remac_env.files import unmarked
from remac_env.words import normalise

_FENCE = re.compile(r"^[ \t]*(?:```|~~~)[\w+-]*[ \t]*$", re.M)
_TYPOGRAPHY = str.maketrans("\u2018\u2019\u201c\u201d\u2022\u2023\u2013\u00a0\u202f", "''\"\"---  ", "\ufeff")
"""Quotes, bullets, dashes and spaces of typesetters; letters stay as they are."""

_HEADING = re.compile(
    r"^[#>\s]*[*_`\"']{0,3}(?P<name>[^\W\d_][\w '-]{0,60}?)[*_`\"']{0,3}\s*:\s*[*_`]{0,3}\s*(?P<tail>.*)$", re.S
)
_TITLE = re.compile(r"^(?:#+\s*|\*\*)(?P<name>[^\W\d_][\w '-]{0,60}?)(?:\*\*)?\s*$")
_ITEM = re.compile(
    r"^(?:[-*+]\s+|-(?=[a-z])|\(?(?P<number>\d{1,4})[.):]\s*|(?:step|round|subtask) (?P<step>\d{1,4})[.:)]\s*)", re.I
)
_AROUND = re.compile(
    r"^(?:the )?(?:plan for |row of |row for )?(?P<who>.+?)(?:'s)?(?: plan| steps| actions| row| subtasks)?$"
)
_ROBOT = re.compile(r"^(?:robot|agent|arm) ?\d+$")
_PLANS = re.compile(
    r"^(?:(?:the|my|here is the|here is my|here's the|here's my) )?"
    r"(?:final |new |updated |corrected |initial |revised |action |full )?"
    r"(?:plan|answer|solution|result|response|json|steps|subtasks|actions|output)$"
)


def without_thoughts(text: str) -> str | None:
    """The text without thoughts, Markdown fences and typographic letters; None if it ends in a thought."""
    found = split_thoughts(text)
    if found.unfinished:
        return None
    return _FENCE.sub("", "\n".join(found.answer).translate(_TYPOGRAPHY))


def split_heading(line: str) -> tuple[str | None, str]:
    """The words before a colon, or of a title line, and what follows; None where the line has neither."""
    match = _HEADING.match(line)
    if match is not None:
        return match["name"], match["tail"].strip()
    title = _TITLE.match(line)
    return (title["name"], "") if title is not None else (None, line)


def list_item(line: str) -> tuple[int | None, str] | None:
    """(number or None, text) of a line that starts with a number or bullet."""
    match = _ITEM.match(line)
    if match is None:
        return None
    number = match["number"] or match["step"]
    return (int(number) if number else None), line[match.end() :].strip(" \t*`")


def opening(line: str) -> int | None:
    """Where the first bracket of a list or object opens."""
    found = [index for index in (line.find("["), line.find("{")) if index >= 0]
    return min(found, default=None)


class Names:
    """The robots of a plan, by all the ways in which answers call them. `unknown` words a complaint."""

    def __init__(self, robots: Sequence[str], lead: str, unknown: Callable[[object], str]) -> None:
        self.robots, self.lead, self.unknown = tuple(robots), lead, unknown
        self._called: dict[str, str] = {}
        numbered = [(name, match[0]) for name in robots if (match := re.search(r"\d+$", name))]
        for name, number in numbered:
            if [other for _, other in numbered].count(number) == 1:
                for word in ("robot", "agent", "arm"):
                    self._called |= {f"{word} {number}": name, f"{word}{number}": name}
        for name in robots:
            plain = normalise(name)
            self._called |= {plain: name, plain.replace(" ", ""): name}

    def robot(self, words: object) -> str | None:
        """The robot that is called so, or None; a byte order mark before its name is passed over."""
        words = unmarked(words) if isinstance(words, str) else words
        if words in self.robots:
            return str(words)
        if not isinstance(words, str) or not words.isascii():
            return None
        return self._called.get(normalise(words))

    def heading(self, words: str) -> str | None:
        """A robot, "plan", "unknown" for a robot that there is not, or None for other words."""
        plain = normalise(words)
        if _PLANS.match(plain):
            return "plan"
        match = _AROUND.match(plain)
        who = match["who"] if match is not None else plain
        if not words.isascii():
            return "unknown" if self._called.get(normalise(who)) else None
        return self.robot(who) or ("unknown" if _ROBOT.match(who) else None)

    def stranger(self, words: str) -> str:
        """That there is no such robot."""
        return f"unknown robot {words[:40]!a}; valid: {', '.join(self.robots)}"

    def rows(self, value: Mapping[Any, Any]) -> dict[str, Any] | str:
        """Robot -> row of a mapping that may hold them under "plan"; or what is wrong with its form.

        Rows of robots that there are not keep the name that they have.
        """
        for _ in range(3):
            inner = [key for key in value if isinstance(key, str) and normalise(unmarked(key)) == "plan"]
            if not inner:
                break
            if len(inner) > 1 or any(self.robot(key) for key in value):
                return "the answer holds two different plans: rows beside a plan"
            under = value[inner[0]]
            if not isinstance(under, Mapping):
                return {self.lead: under}
            value = under
        read: dict[str, Any] = {}
        for key, row in value.items():
            robot = self.robot(key) or str(key)
            if robot in read:
                return f"the answer holds two different plans: two rows for {robot}"
            read[robot] = row
        return read


def nearest(text: str, valid: Iterable[str]) -> str:
    """Up to three valid texts that read alike, quoted."""
    near = difflib.get_close_matches(normalise(text[:80]), list(valid), n=3, cutoff=0.5)
    return ", ".join(repr(name) for name in near)
