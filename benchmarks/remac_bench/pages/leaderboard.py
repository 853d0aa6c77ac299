"""What the leaderboard shows: all tables of a folder, with filters, plots and links to episodes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from remac_bench.blame.labels import Blame
from remac_bench.board import Board, Cell, Column, Sheet
from remac_bench.judging.episodes import setting
from remac_bench.judging.matrix import KEY as MATRIX
from remac_bench.judging.published import PAPER
from remac_bench.pages.bars import TaskBars, bars
from remac_bench.pages.episode_rows import FILTERS, EpisodeRow, episode_rows
from remac_bench.pages.plots import Interval, Scatter, interval, scatter
from remac_bench.pages.rendering import render
from remac_bench.records import Record
from remac_bench.report import COMPACT, LEGEND
from remac_bench.sheets import ALARMS

SCRIPTS = (
    *("tables.js", "statistics.js", "episodes.js", "address.js", "filters.js"),
    *("counting.js", "compare.js", "copying.js"),
)

COUNTED = (MATRIX, "ranking", "results")
"""Sheets, by the beginning of their key, that the page counts again when it is filtered."""

NARROW = ("task", "agent", "rank", "n", "tsr", "failed", "first", "second", "alone", "verdict")
"""Columns that stay on a phone, where a table has some of them."""

_DASH = Cell(text="-")


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A cell on the page. `sort`: what it is sorted by."""

    cell: Cell
    column: Column
    plot: Interval | None
    style: str

    @property
    def sort(self) -> str:
        """The number behind the cell; a rate's interval by its lower end; "" where there is none."""
        value = self.cell.value if self.cell.value is not None else self.cell.low
        return "" if value is None else repr(value)

    @property
    def span(self) -> str:
        """The ends of the interval of a rate, in percent; "" where there is none."""
        if self.plot is None or self.cell.low is None or self.cell.high is None:
            return ""
        return f"{100 * self.cell.low:.0f}\u2013{100 * self.cell.high:.0f}"


@dataclass(frozen=True, kw_only=True)
class Line:
    """A row, and what it is filtered by."""

    facts: Mapping[str, str]
    entries: tuple[Entry, ...]


@dataclass(frozen=True, kw_only=True)
class Table:
    """A sheet on the page.

    Attributes:
        styles: for each column, the classes of its cells: `num`; `extra`, shown on demand; `wide`, not on a phone.
        kind: the first word of the sheet's key.
        counted: whether the page counts it again when it is filtered.
    """

    sheet: Sheet
    columns: tuple[Column, ...]
    styles: tuple[str, ...]
    lines: tuple[Line, ...]
    open: bool
    plot: Scatter | None
    bars: tuple[TaskBars, ...]

    @property
    def kind(self) -> str:
        """The first word of the sheet's key."""
        return self.sheet.key.split("-")[0]

    @property
    def counted(self) -> bool:
        """Whether the page counts it again when it is filtered."""
        return self.kind in COUNTED

    @property
    def extra(self) -> bool:
        """Whether it has columns that are shown on demand."""
        return any("extra" in style for style in self.styles)


def leaderboard(
    board: Board, records: Sequence[Record], blames: Iterable[Blame] = (), *, live: bool = False
) -> str:
    """The page of a board.

    Args:
        records: those that its episodes are linked to.
        live: it is served while a run may go on, and asks its server how far that is.
    """
    tables = tuple(table(sheet) for sheet in board.sheets)
    episodes = episode_rows(records, blames)
    return render(
        "leaderboard.html",
        scripts=(*SCRIPTS, *(("live.js",) if live else ())),
        asks=live,
        board=board,
        tables=tables,
        filters=_filters(tables, episodes),
        episodes=episodes,
        agents=sorted({row.record.agent for row in episodes if row.record.scored}),
        legend=f"{LEGEND} {board.note}",
        counts={
            "episodes": len(records),
            "scored": sum(record.scored for record in records),
            "agents": len({record.agent for record in records}),
            "tasks": len({record.task for record in records}),
        },
        suites=sorted({f"{r.suite} version {r.suite_version}" for r in records if r.suite}),
        settings=sorted({setting(record) for record in records}),
        live=live,
    )


def table(sheet: Sheet) -> Table:
    """A sheet without the columns that hold nothing; alarms that are all silent are shown on demand."""
    kind = sheet.key.split("-")[0]
    columns = tuple(column for column in sheet.columns if any(column.key in row for row in sheet.rows))
    silent = {key for key in ALARMS if all(row.get(key, _DASH).text in ("0", "-") for row in sheet.rows)}
    styles = tuple(_style(column, kind, silent) for column in columns)
    lines = tuple(
        Line(
            facts=_facts(sheet.facts[index]) if index < len(sheet.facts) else {},
            entries=tuple(
                _entry(row.get(column.key, _DASH), column, style)
                for column, style in zip(columns, styles, strict=True)
            ),
        )
        for index, row in enumerate(sheet.rows)
    )
    return Table(
        sheet=sheet,
        columns=columns,
        styles=styles,
        lines=lines,
        open=kind in (*COUNTED, "blame"),
        plot=scatter(sheet) if kind == "results" else None,
        bars=bars(sheet) if kind == MATRIX else (),
    )


def _style(column: Column, kind: str, silent: set[str]) -> str:
    words = ["num"] if column.numeric else []
    if kind == "results" and (column.key not in COMPACT or column.key in silent):
        words.append("extra")
    if kind != MATRIX and column.key not in NARROW:
        words.append("wide")
    return " ".join(words)


def _entry(cell: Cell, column: Column, style: str) -> Entry:
    plot = interval(cell) if cell.value is not None else None
    return Entry(cell=cell, column=column, plot=plot, style=f"{style} paper" if cell.note.startswith(PAPER) else style)


def _facts(facts: Mapping[str, str]) -> dict[str, str]:
    return {name: facts[name] for name in (*FILTERS, "agent") if name in facts}


def _filters(tables: Iterable[Table], episodes: Sequence[EpisodeRow]) -> dict[str, list[str]]:
    """Filter -> what can be chosen."""
    rows = [line.facts for each in tables if not each.counted for line in each.lines]
    rows += [row.facts for row in episodes]
    found = {name: sorted({facts[name] for facts in rows if name in facts}) for name in FILTERS}
    # Settings part episodes as the tables are parted: where there is one, it says nothing.
    return {name: choices for name, choices in found.items() if len(choices) > (name == "setting")}
