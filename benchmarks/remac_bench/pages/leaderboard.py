"""What the leaderboard shows: all tables of a folder, with filters, plots and links to episodes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from remac_bench.blame.labels import Blame
from remac_bench.board import Board, Cell, Column, Sheet
from remac_bench.judging.episodes import setting
from remac_bench.judging.published import PAPER
from remac_bench.pages.episode_page import page_name
from remac_bench.pages.plots import Interval, Scatter, interval, scatter
from remac_bench.pages.rendering import render
from remac_bench.records import Record
from remac_bench.report import COMPACT, LEGEND

FILTERS = ("task", "method", "robots", "starts")
"""Facts of rows that the page can be filtered by."""

_DASH = Cell(text="-")


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A cell on the page. `sort`: what it is sorted by."""

    cell: Cell
    column: Column
    plot: Interval | None
    extra: bool
    paper: bool

    @property
    def sort(self) -> str:
        """The number behind the cell; a rate's interval by its lower end; "" where there is none."""
        value = self.cell.value if self.cell.value is not None else self.cell.low
        return "" if value is None else repr(value)


@dataclass(frozen=True, kw_only=True)
class Line:
    """A row, and what it is filtered by."""

    facts: Mapping[str, str]
    entries: tuple[Entry, ...]


@dataclass(frozen=True, kw_only=True)
class Table:
    """A sheet on the page. `extra`: keys of columns that are shown on demand."""

    sheet: Sheet
    columns: tuple[Column, ...]
    extra: frozenset[str]
    lines: tuple[Line, ...]
    open: bool
    plot: Scatter | None


def leaderboard(board: Board, records: Sequence[Record], blames: Iterable[Blame] = ()) -> str:
    """The page of a board; the records are those that its episodes are linked to."""
    tables = tuple(table(sheet) for sheet in board.sheets)
    labels = {(blame.job, blame.iteration): blame.label for blame in blames}
    episodes = sorted(records, key=_order)
    return render(
        "leaderboard.html",
        board=board,
        tables=tables,
        filters={name: _choices(name, tables, episodes) for name in FILTERS},
        episodes=[(record, page_name(record), labels.get((record.job, record.iteration), "")) for record in episodes],
        legend=f"{LEGEND} {board.note}",
        counts={
            "episodes": len(episodes),
            "scored": sum(record.scored for record in episodes),
            "agents": len({record.agent for record in episodes}),
            "tasks": len({record.task for record in episodes}),
        },
        suites=sorted({f"{r.suite} version {r.suite_version}" for r in records if r.suite}),
        settings=sorted({setting(record) for record in records}),
    )


def table(sheet: Sheet) -> Table:
    """A sheet without the columns that hold nothing."""
    results = sheet.key.startswith("results")
    columns = tuple(column for column in sheet.columns if any(column.key in row for row in sheet.rows))
    extra = frozenset(column.key for column in columns if results and column.key not in COMPACT)
    lines = tuple(
        Line(
            facts=_facts(sheet.facts[index]) if index < len(sheet.facts) else {},
            entries=tuple(_entry(row.get(column.key, _DASH), column, column.key in extra) for column in columns),
        )
        for index, row in enumerate(sheet.rows)
    )
    return Table(
        sheet=sheet,
        columns=columns,
        extra=extra,
        lines=lines,
        open=results or sheet.key.split("-")[0] in ("ranking", "blame"),
        plot=scatter(sheet) if results else None,
    )


def _entry(cell: Cell, column: Column, extra: bool) -> Entry:
    plot = interval(cell) if cell.value is not None else None
    return Entry(cell=cell, column=column, plot=plot, extra=extra, paper=cell.note.startswith(PAPER))


def _facts(facts: Mapping[str, str]) -> dict[str, str]:
    return {name: facts[name] for name in FILTERS if name in facts}


def _choices(name: str, tables: Iterable[Table], records: Iterable[Record]) -> list[str]:
    told = {line.facts[name] for table in tables for line in table.lines if name in line.facts}
    return sorted(told | {str(getattr(record, name)) for record in records})


def _order(record: Record) -> tuple[object, ...]:
    return (record.task, record.agent, record.seed, record.style or "", record.job, record.iteration)
