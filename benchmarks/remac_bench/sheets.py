"""A sheet of a board as tables for a terminal."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

from rich import box
from rich.cells import cell_len
from rich.console import JustifyMethod, RenderableType
from rich.markup import escape
from rich.table import Table

from remac_bench.board import Cell, Column, Sheet
from remac_bench.columns import Footnotes, with_first
from remac_bench.console import plain

ALARMS = ("crashed", "infrastructure", "crash", "unclear", "unknown", "retries", "cannot_tell", "unmatched")
"""Columns that a terminal shows only where one of their numbers is not 0."""

ACROSS = 118
"""Characters side by side at most, however wide the terminal is; a wider sheet is shown in parts."""

_GAP = 3  # characters between two columns

DASH = Cell(text="-")
"""What stands where nothing was measured."""


def tables(sheet: Sheet, columns: Sequence[Column], across: int, notes: Footnotes) -> list[RenderableType]:
    """A sheet as one table, or in parts that fit the terminal, with footnotes where names are too long for both; what
    is too wide for all that is shown as lists. Columns without a cell are left out."""
    used = _loud(sheet, [column for column in columns if any(column.key in row for row in sheet.rows)])
    if made := _side_by_side(sheet, used, across):
        return made
    made, told = _side_by_side(*_shortened(sheet, used, notes), across), notes.told()
    return [*made, *told] if made else [_table(sheet, used)]


def _side_by_side(sheet: Sheet, used: Sequence[Column], across: int) -> list[RenderableType]:
    """The sheet as one table, or in parts that fit; none where it is too wide for both."""
    parts = _parts(sheet, used, min(across, ACROSS))
    return [_table(sheet, part, title=not index) for index, part in enumerate(parts)]


def _shortened(sheet: Sheet, columns: Sequence[Column], notes: Footnotes) -> tuple[Sheet, tuple[Column, ...]]:
    """The sheet and its columns with footnotes in place of long names."""
    names = [column.key for column in columns if not column.numeric]
    rows = [
        {**row, **{key: replace(row[key], text=notes.short(plain(row[key].text))) for key in names if key in row}}
        for row in sheet.rows
    ]
    return replace(sheet, rows=tuple(rows)), tuple(replace(each, title=notes.short(each.title)) for each in columns)


def _loud(sheet: Sheet, columns: Sequence[Column]) -> tuple[Column, ...]:
    """Without the columns of alarms that are all silent."""
    quiet = {key for key in ALARMS if all(row.get(key, DASH).text in ("0", "-") for row in sheet.rows)}
    return tuple(column for column in columns if column.key not in quiet)


def _parts(sheet: Sheet, used: Sequence[Column], across: int) -> list[tuple[Column, ...]]:
    """The columns in parts, each with the first words; none where most parts would have one column."""
    front = len(list(itertools.takewhile(lambda column: not column.numeric, used)))
    return [tuple(part) for part in with_first([(each, _width(sheet, each)) for each in used], front, across)]


def _width(sheet: Sheet, column: Column) -> int:
    texts = (plain(row.get(column.key, DASH).text) for row in sheet.rows)
    return _GAP + max(cell_len(column.title), *(cell_len(text) for text in texts), 1)


def _table(sheet: Sheet, columns: Sequence[Column], *, title: bool = True) -> Table:
    """One sheet. Columns never shrink: a number cut short would be another number."""
    heading = escape(plain(sheet.title)) if title else None
    table = Table(title=heading, box=box.SIMPLE_HEAD, title_justify="left", pad_edge=False)
    texts = [[plain(row.get(column.key, DASH).text) for column in columns] for row in sheet.rows]
    for index, column in enumerate(columns):
        least = max(cell_len(column.title), *(cell_len(row[index]) for row in texts), 1)
        side: JustifyMethod = "right" if column.numeric else "left"
        table.add_column(column.title, justify=side, no_wrap=True, min_width=least)
    firsts, before = [row[0] for row in texts], None
    for cells in texts:
        group = cells[0]
        if before not in (None, group) and len(set(firsts)) < len(firsts):
            table.add_section()
        before = group
        table.add_row(*(escape(text) for text in cells))
    return table
