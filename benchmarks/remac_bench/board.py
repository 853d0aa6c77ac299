"""Tables as values: what judging computes, and terminals, Markdown, pages and pictures show."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One entry of a table.

    Attributes:
        text: as it is shown; "-" where nothing was measured.
        value: the number behind it, for sorting and plots; None where there is none.
        low, high: the ends of its 95% interval, in the unit of `value`.
        note: why it stands out, or what is special about it; "" where nothing is.
    """

    text: str
    value: float | None = None
    low: float | None = None
    high: float | None = None
    note: str = ""


@dataclass(frozen=True, kw_only=True)
class Column:
    """A column: its `key` in the rows, its `title`, and in `help` what that means. `numeric`: set to the right."""

    key: str
    title: str
    help: str = ""
    numeric: bool = True


@dataclass(frozen=True, kw_only=True)
class Sheet:
    """One table.

    Attributes:
        key: its name in file names and links.
        title, caption: what it is, and what to know when reading it.
        command: the command that prints it.
        columns: in order.
        rows: column key -> cell; a key that is missing is "-".
        facts: for each row, what pages filter by: task, method, agent, robots, starts, where they apply.
    """

    key: str
    title: str
    columns: tuple[Column, ...]
    rows: tuple[Mapping[str, Cell], ...]
    facts: tuple[Mapping[str, str], ...] = ()
    caption: str = ""
    command: str = ""


@dataclass(frozen=True, kw_only=True)
class Board:
    """All tables of a folder of records, `sheets`. `title`: what they are of; `note`: of which code."""

    title: str
    note: str = ""
    sheets: tuple[Sheet, ...] = field(default_factory=tuple)
