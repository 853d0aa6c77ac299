"""Tables in terminals that are too narrow for them: no number and no name is ever broken."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TypeVar

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from remac_bench.console import console

T = TypeVar("T")

_AROUND = 3  # letters between the texts of two columns: a blank on each side, and a line


def across() -> int:
    """Columns of the terminal that a table may take."""
    return console().width - 1


def show(*parts: RenderableType) -> None:
    """Print tables as wide as the terminal takes them, and what stands between them."""
    made = console()
    for part in parts:
        for piece in laid_out(part, made.width) if isinstance(part, Table) else [part]:
            made.print(piece, crop=False)


def laid_out(table: Table, width: int) -> list[RenderableType]:
    """The table with columns in which every word fits into a line; where that is too wide, its rows as lists."""
    heads = [_text(column.header) for column in table.columns]
    columns = [[_text(cell) for cell in column.cells] for column in table.columns]
    least = [
        max(column.min_width or 0, *(_longest(text, whole=column.no_wrap) for text in (head, *texts)))
        for column, head, texts in zip(table.columns, heads, columns, strict=True)
    ]
    wanted = [max(_longest(text, whole=True) for text in (head, *texts))
              for head, texts in zip(heads, columns, strict=True)]  # fmt: skip
    room = width - _AROUND * len(least) - 1 - sum(least)
    if room < 0:
        return list(_lists(table, heads, columns))
    for column, one, most in zip(table.columns, least, wanted, strict=True):
        column.width = one + min(room, most - one)
        room -= column.width - one
    return [table]


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


def _lists(table: Table, heads: Sequence[str], columns: Sequence[Sequence[str]]) -> Iterator[Text]:
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
                yield Text(f"{mark}{name}: {text}", overflow="ignore")
            mark = "" if name else f"{mark}{text} "
        if mark:
            yield Text(mark.rstrip(), overflow="ignore")
    if table.caption:
        yield Text(f"\n{_text(table.caption)}", style="dim")
    yield Text("")


def _text(cell: RenderableType | None) -> str:
    return cell.plain if isinstance(cell, Text) else Text.from_markup(str(cell or "")).plain


def _longest(text: str, *, whole: bool) -> int:
    """Letters of the longest line, or of the longest word."""
    return max((len(part) for part in (text.splitlines() if whole else text.split())), default=1)
