"""The table of a folder: for people in a terminal, and as Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich import box
from rich.console import JustifyMethod, RenderableType
from rich.markup import escape
from rich.table import Table

from remac_bench.errors import UsageError
from remac_bench.metrics import Row, summarise
from remac_bench.store import FILE, Store

COLUMNS = ("Task", "Method", "n", "TSR", "95%", "SCR", "Time s", "IPL", "FPL", "Crashed", "Infra")
ALARMS = ("Crashed", "Infra")
"""Columns that a terminal shows only where one of their numbers is not 0."""

LEGEND = (
    "TSR: goal holds at the end, with Wilson's 95% interval. SCR: rounds done of the final plans. "
    "Time (simulated), IPL and FPL (rounds of the first and of the final plan): means over successes. "
    "Crashed: failures by an exception of the agent. Infra: not scored, run again at the next call."
)


def read_rows(folder: str | Path) -> list[Row]:
    """The rows of a folder's table.

    Raises:
        UsageError: if the folder does not exist or holds no records.
        RecordFileError: if its records cannot be read.
    """
    path = Path(folder)
    if not path.is_dir():
        raise UsageError(f"there is no folder {str(path)!r}; give the --out of a `remac bench run`")
    records = Store(path).read()
    if not records:
        raise UsageError(
            f"no records in {str(path)!r} ({FILE} is missing or empty); run `remac bench run --out` first"
        )
    return summarise(records)


def tables(rows: Sequence[Row]) -> list[RenderableType]:
    """One rich table for each setting, and the legend."""
    made: list[RenderableType] = []
    for where in dict.fromkeys(row.setting for row in rows):
        made.append(_table(where, [row for row in rows if row.setting == where]))
    return [*made, f"[dim]{LEGEND}[/dim]"]


def markdown(rows: Sequence[Row]) -> str:
    """The same as Markdown."""
    lines: list[str] = []
    for where in dict.fromkeys(row.setting for row in rows):
        lines += [
            f"**{where}**",
            "",
            f"| {' | '.join(COLUMNS)} |",
            "|---|---|" + "---:|" * (len(COLUMNS) - 2),
        ]
        lines += [f"| {' | '.join(_plain(c) for c in cells(row))} |" for row in rows if row.setting == where]
        lines.append("")
    return "\n".join([*lines, LEGEND, ""])


def _table(title: str, rows: Sequence[Row]) -> Table:
    """One setting. Columns never shrink: a number cut short would be another number."""
    table = Table(title=escape(title), box=box.SIMPLE_HEAD, title_justify="left", pad_edge=False)
    quiet = {name for i, name in enumerate(COLUMNS) if name in ALARMS and all(cells(row)[i] == "0" for row in rows)}
    shown = [index for index, name in enumerate(COLUMNS) if name not in quiet]
    for index in shown:
        least = max(len(COLUMNS[index]), *(len(cells(row)[index]) for row in rows))
        side: JustifyMethod = "left" if COLUMNS[index] in ("Task", "Method") else "right"
        table.add_column(COLUMNS[index], justify=side, no_wrap=True, min_width=least)
    before = None
    for row in rows:
        if before not in (None, row.task):
            table.add_section()
        before = row.task
        table.add_row(*(escape(cells(row)[index]) for index in shown))
    return table


def cells(row: Row) -> list[str]:
    """A row as text, in the order of COLUMNS; a dash where nothing was measured."""
    interval = "-" if row.low is None or row.high is None else f"{100 * row.low:.0f}-{100 * row.high:.0f}%"
    return [
        row.task,
        row.agent,
        str(row.n),
        _percent(row.tsr),
        interval,
        _percent(row.scr),
        _number(row.seconds),
        _number(row.ipl),
        _number(row.fpl),
        str(row.crashed),
        str(row.infrastructure),
    ]


def _percent(value: float | None) -> str:
    return "-" if value is None else f"{100 * value:.0f}%"


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.1f}"


def _plain(cell: str) -> str:
    return cell.replace("|", "\\|").replace("\n", " ")
