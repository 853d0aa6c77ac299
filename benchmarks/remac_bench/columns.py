"""Tables in terminals that are too narrow for them: no number and no name is ever broken."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

from rich.cells import cell_len, set_cell_size
from rich.console import RenderableType
from rich.table import Column, Table
from rich.text import Text

from remac_bench.console import broken, console

T = TypeVar("T")

_AROUND = 3  # letters between the texts of two columns: a blank on each side, and a line
_LONG, _KEPT = 24, 16
"""Columns that a text takes which footnotes leave as it is at least; what they keep of another at most."""


def across() -> int:
    """Columns of the terminal that a table may take."""
    return console().width - 1


def show(*parts: RenderableType) -> None:
    """Print tables as wide as the terminal takes them, and what stands between them, lines that end with words."""
    made, notes = console(), Footnotes()
    for part in parts:
        for piece in laid_out(part, made.width, notes) if isinstance(part, Table) else [part]:
            if isinstance(piece, Table):
                made.print(piece, crop=False)
                continue
            text = piece if isinstance(piece, Text) else Text.from_markup(str(piece), emoji=False)
            for line in broken(text.plain, made.width):
                made.print(Text(line, style=_style(text)), soft_wrap=True)


@dataclass
class Footnotes:
    """Long texts, each with a number that stands for it in tables: the same number in all that are shown together."""

    _numbers: dict[str, int] = field(default_factory=dict)
    _used: dict[str, int] = field(default_factory=dict)

    def short(self, text: str) -> str:
        """The text, or, where it is long, how it begins, and the number of its note: "CC [2]"."""
        if cell_len(text) <= _LONG:
            return text
        self._used[text] = self._numbers.setdefault(text, len(self._numbers) + 1)
        head = re.split(r"[^\w.-]", text, maxsplit=1)[0] or text
        if cell_len(head) > _KEPT:
            head = f"{set_cell_size(head, _KEPT - 1).rstrip()}…"
        return f"{head} [{self._used[text]}]"

    def told(self) -> list[Text]:
        """The notes of what was made short since they were told last."""
        lines = [f"[{number}] {text}" for text, number in sorted(self._used.items(), key=lambda item: item[1])]
        self._used.clear()
        return [*map(_line, lines), Text("")] if lines else []


def laid_out(table: Table, width: int, notes: Footnotes | None = None) -> list[RenderableType]:
    """The table with columns in which every word fits into a line; where that is too wide, in parts or with long texts
    in footnotes; and where that is too wide still, its rows as lists."""
    if made := _side_by_side(table, width):
        return made
    notes = notes or Footnotes()
    made, told = _side_by_side(_shortened(table, notes), width), notes.told()
    return [*made, *told] if made else list(_lists(table))


def with_first(columns: Sequence[tuple[T, int]], first: int, room: int) -> list[list[T]]:
    """Columns, each with its width, in parts that fit, each with the first ones; none where these and another are too
    wide, or most parts would have one column besides."""
    front, rest = columns[:first], columns[first:]
    left = room - sum(width for _, width in front)
    parts = in_parts(rest, left)
    if left < max((width for _, width in rest), default=0) or len(parts) > (len(rest) + 1) // 2 > 0:
        return []
    return [[*(column for column, _ in front), *part] for part in parts]


def in_parts(columns: Sequence[tuple[T, int]], room: int) -> list[list[T]]:
    """Columns, each with its width, in as few parts as fit into so much room, and all about as wide."""
    parts = _filled(columns, room)
    while room > 0 and len(narrower := _filled(columns, room - 1)) == len(parts):
        parts, room = narrower, room - 1
    return parts


def _filled(columns: Sequence[tuple[T, int]], room: int) -> list[list[T]]:
    """One after the other; what is wider has a part of its own."""
    parts, left = [list[T]()], room
    for column, width in columns:
        left -= width
        if left < 0 and parts[-1]:
            parts.append([])
            left = room - width
        parts[-1].append(column)
    return parts


def _side_by_side(table: Table, width: int) -> list[RenderableType]:
    """The table, or parts that fit, each with the columns before the first number; none where it is too wide for both,
    or most parts would have one column."""
    if _fitted(table, width):
        return _framed(table)
    count = len(list(itertools.takewhile(lambda column: column.justify == "left", table.columns)))
    sizes = [(number, _least(column) + _AROUND) for number, column in enumerate(table.columns)]
    parts = with_first(sizes, count, width - 1) if 0 < count < len(sizes) else []
    made: list[RenderableType] = []
    for part in parts:
        one = _only(table, part, first=part is parts[0], last=part is parts[-1])
        made += _framed(one) if _fitted(one, width) else []
    return made


def _only(table: Table, numbers: Sequence[int], *, first: bool, last: bool) -> Table:
    """Some columns of a table; the title stands over the first part, the caption under the last."""
    made = _bare(table, title=first, caption=last)
    chosen = [table.columns[number] for number in numbers]
    for column in chosen:
        made.add_column(column.header, justify=column.justify, no_wrap=column.no_wrap, min_width=column.min_width)
    for row, cells in zip(table.rows, zip(*(column.cells for column in chosen), strict=True), strict=True):
        made.add_row(*cells, end_section=row.end_section)
    return made


def _bare(table: Table, *, title: bool = True, caption: bool = True) -> Table:
    """A table like this one, without columns."""
    return Table(title=table.title if title else None, caption=table.caption if caption else None, box=table.box,
                 pad_edge=table.pad_edge, title_justify=table.title_justify)  # fmt: skip


def _least(column: Column) -> int:
    """How wide a column has to be."""
    texts = (_text(cell) for cell in (column.header, *column.cells))
    return max(column.min_width or 0, *(_longest(text, whole=column.no_wrap) for text in texts))


def _fitted(table: Table, width: int) -> bool:
    """Whether every word fits; the columns then have their widths."""
    least = [_least(column) for column in table.columns]
    room = width - _AROUND * len(least) - 1 - sum(least)
    if room < 0:
        return False
    for column, one in zip(table.columns, least, strict=True):
        most = max(_longest(_text(cell), whole=True) for cell in (column.header, *column.cells))
        column.width = one + max(0, min(room, most - one))
        room -= column.width - one
    return True


def _framed(table: Table) -> list[RenderableType]:
    """The table; title and caption before and after it where it is too narrow for their words."""
    title, caption = _text(table.title), _text(table.caption)
    room = sum((column.width or 0) + _AROUND - 1 for column in table.columns)
    if max(_longest(title, whole=False), _longest(caption, whole=False)) <= room:
        return [table]
    table.title = table.caption = None
    before, after = Text(title, style="italic"), Text(caption, style="dim")
    return [*([before] if title else []), table, *([after] if caption else [])]


def _shortened(table: Table, notes: Footnotes) -> Table:
    """The table with footnotes in place of texts of which a word, or what may not be broken, is long."""
    made = _bare(table)
    cells: list[list[RenderableType]] = []
    for column in table.columns:
        head, *texts = (
            Text(notes.short(text)) if _longest(text, whole=column.no_wrap) > _LONG else cell
            for cell in (column.header, *column.cells) for text in [_text(cell)]
        )  # fmt: skip
        made.add_column(head, justify=column.justify, no_wrap=column.no_wrap)
        cells.append(texts)
    for row, across_ in zip(table.rows, zip(*cells, strict=True), strict=True):
        made.add_row(*across_, end_section=row.end_section)
    return made


def _lists(table: Table) -> Iterator[Text]:
    heads = [_text(column.header) for column in table.columns]
    columns = [[_text(cell) for cell in column.cells] for column in table.columns]
    if table.title:
        yield Text(_text(table.title), style="italic")
    for number in range(table.row_count):
        yield Text("")
        mark = ""  # the text of a column without a head, which stands before the next one's
        for head, texts in zip(heads, columns, strict=True):
            name, text = " ".join(head.split()), texts[number].strip()
            if not text:
                continue
            if name:
                yield _line(f"{mark}{name}: {text}")
            mark = "" if name else f"{mark}{text} "
        if mark:
            yield _line(mark.rstrip())
    if table.caption:
        yield Text(f"\n{_text(table.caption)}", style="dim")
    yield Text("")


def _line(text: str) -> Text:
    return Text(text, overflow="ignore")


def _style(text: Text) -> str:
    """The one style of a text."""
    return str(text.style or (text.spans[0].style if text.spans else ""))


def _text(cell: RenderableType | None) -> str:
    return cell.plain if isinstance(cell, Text) else Text.from_markup(str(cell or ""), emoji=False).plain


def _longest(text: str, *, whole: bool) -> int:
    """Columns that the longest line takes, or the longest word."""
    return max((cell_len(part) for part in (text.splitlines() if whole else text.split())), default=1)
