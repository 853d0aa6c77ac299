"""The board of a folder in text: for people in a terminal, as Markdown and as CSV."""

from __future__ import annotations

import csv
import io
import shlex
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from rich.console import RenderableType
from rich.markup import escape

from remac_bench import judging
from remac_bench.blame.labels import Blame
from remac_bench.blame.sheet import read_blames
from remac_bench.board import Board, Cell, Column, Sheet
from remac_bench.columns import Footnotes
from remac_bench.console import plain
from remac_bench.errors import UsageError
from remac_bench.judging.checkers import with_checkers
from remac_bench.judging.episodes import code_note
from remac_bench.judging.grades import chosen
from remac_bench.judging.readers import with_readers
from remac_bench.judging.results import results_sheets
from remac_bench.metrics import Row, overall, summarise
from remac_bench.records import Record
from remac_bench.sheets import DASH
from remac_bench.sheets import tables as sheet_tables
from remac_bench.store import FILE, Store, latest
from remac_env.files import prepare_file, prepare_folder

COMPACT = (
    *("task", "agent", "checker", "given", "n", "problems", "tsr", "interval", "scr", "seconds", "ipl", "fpl"),
    *("crashed", "infrastructure"),
)
"""Columns of the results that stand in the main table; the others come with `--all`."""

FIRST = ("grades", "learning", "results", "ranking", "blame")
"""Sheets that are shown without `--all`, by the beginning of their key."""

LEGEND = (
    "TSR: goal holds at the end, with Wilson's 95% interval. SCR: rounds done of the final plans. "
    "Time (simulated), IPL and FPL (rounds of the first and of the final plan): means over successes. "
    "Crashed: failures by an exception of the agent. Infra: not scored, run again at the next call."
)

_FORMULA = ("=", "+", "-", "@", "\t", "\r")  # text that begins so is taken for a formula by spreadsheets


def read_records(folder: str | Path) -> list[Record]:
    """The records of a folder.

    Raises:
        UsageError: if the folder does not exist or holds no records.
        RecordFileError: if its records cannot be read.
    """
    path = Path(folder)
    if not path.is_dir():
        raise UsageError(f"there is no folder {str(path)!r}; give the --out of a `remac bench run`")
    records = Store(path).read()
    if not records:
        raise UsageError(f"no records in {str(path)!r} ({FILE} is missing or empty); run `remac bench run --out` first")
    return records


def read_folders(folders: Sequence[str | Path]) -> list[Record]:
    """The records of several folders together; an episode that is in more than one counts once, as the last has it.

    Raises: as `read_records`.
    """
    return latest(record for folder in folders for record in read_records(folder))


def read_labels(folders: Sequence[str | Path]) -> list[Blame]:
    """The labels of several folders together; RecordFileError where they cannot be read."""
    found = {(blame.job, blame.iteration): blame for folder in folders for blame in read_blames(folder)}
    return list(found.values())


def read_rows(folder: str | Path) -> list[Row]:
    """The rows of a folder's main table; errors as those of `read_records`."""
    return _with_overall(read_records(folder))


def main_table(folder: str | Path, *, across: int) -> list[RenderableType]:
    """The main table of a folder; errors as those of `read_records`."""
    records = read_records(folder)
    return tables(_with_overall(records), note=code_note(records), across=across)


def read_board(*folders: str | Path, grades: Sequence[str] = (), templates: Sequence[str] = ()) -> Board:
    """All tables of folders together, the labels of `remac bench blame` among them; errors as of `read_records`.

    Args:
        grades: only generated tasks of these grades.
        templates: only generated tasks of templates whose names hold one of these words.

    Raises:
        UsageError: also where no record is left.
    """
    named = shlex.join(map(str, folders))
    records = chosen(read_folders(folders), grades=grades, templates=templates)
    if not records:
        raise UsageError("no record of these grades and templates is there; `remac bench report DIR --all` lists them")
    return judging.board(records, blames=read_labels(folders), folder=named)


def tables(rows: Sequence[Row], *, note: str = "", across: int) -> list[RenderableType]:
    """The main table: one rich table for each setting, or parts of it, and the legend.

    Args:
        note: of which code the records are; see `remac_bench.judging.episodes.code_note`.
        across: columns of the terminal.
    """
    sheets = with_checkers(results_sheets(rows, (), folder="DIR"), {row.agent: row.checker for row in rows})
    sheets = with_readers(sheets, {row.agent: row.given for row in rows})
    legend = f"[dim]{escape(plain(f'{LEGEND} {note}'))}[/dim]"
    notes = Footnotes()
    return [*(part for sheet in sheets for part in sheet_tables(sheet, compact(sheet), across, notes)), legend]


def board_tables(board: Board, *, everything: bool = False, across: int) -> list[RenderableType]:
    """The sheets of a board in rich; unless `everything` is asked for, the first ones, and the main columns alone.

    Args:
        across: columns of the terminal; a wider sheet comes in parts.
    """
    made: list[RenderableType] = []
    notes = Footnotes()
    for sheet in shown(board, everything=everything):
        narrow = sheet.key.startswith("results") and not everything
        made += sheet_tables(sheet, compact(sheet) if narrow else sheet.columns, across, notes)
        if sheet.caption and not narrow:
            made.append(f"[dim]{escape(plain(sheet.caption))}[/dim]\n")
    return [*made, *([f"[dim]{escape(plain(f'{LEGEND} {board.note}'))}[/dim]"] if _has_results(board) else [])]


def board_markdown(board: Board, *, everything: bool = False) -> str:
    """The same as Markdown."""
    lines: list[str] = []
    for sheet in shown(board, everything=everything):
        narrow = sheet.key.startswith("results") and not everything
        lines += _markdown(sheet, compact(sheet) if narrow else sheet.columns)
        lines += [] if narrow or not sheet.caption else [_text(sheet.caption), ""]
    return "\n".join([*lines, *([f"{LEGEND} {_text(board.note)}", ""] if _has_results(board) else [])])


def prepare_csv(target: str | Path) -> None:
    """See that `write_csv` can write there, before anything is computed; OptionError where it cannot."""
    if Path(target).suffix == ".csv":
        prepare_file(target, "--csv")
    else:
        prepare_folder(target, "--csv")


def write_csv(board: Board, target: str | Path) -> list[Path]:
    """Write one file a sheet into a folder, or, for a name that ends in .csv, the results of all settings into it.

    A cell with an interval has two more columns, `_low` and `_high`; rates are fractions.
    """
    path = Path(target)
    prepare_csv(path)
    if path.suffix == ".csv":
        sheets = [sheet for sheet in board.sheets if sheet.key.startswith("results")]
        files = {path: csv_text(sheets)}
    else:
        files = {path / f"{sheet.key}.csv": csv_text([sheet]) for sheet in board.sheets}
    for file, text in files.items():
        file.write_text(text, "utf-8", newline="")
    return list(files)


def csv_text(sheets: Sequence[Sheet]) -> str:
    """Sheets with the same columns as CSV, with a first column that says the setting."""
    columns = sheets[0].columns if sheets else ()
    ranged = {key for sheet in sheets for row in sheet.rows for key, cell in row.items() if cell.low is not None}
    heads = [
        head
        for column in columns
        for head in (column.key, *((f"{column.key}_low", f"{column.key}_high") if column.key in ranged else ()))
    ]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["setting", *heads])
    for sheet in sheets:
        for index, row in enumerate(sheet.rows):
            where = sheet.facts[index].get("setting", "") if index < len(sheet.facts) else ""
            writer.writerow([_safe(where), *_csv_cells(row, columns, ranged)])
    return text.getvalue()


def shown(board: Board, *, everything: bool) -> list[Sheet]:
    """The sheets to be shown."""
    return [sheet for sheet in board.sheets if everything or sheet.key.split("-")[0] in FIRST]


def compact(sheet: Sheet) -> tuple[Column, ...]:
    """The main columns of the results."""
    return tuple(column for column in sheet.columns if column.key in COMPACT)


def _has_results(board: Board) -> bool:
    return any(sheet.key.startswith("results") for sheet in board.sheets)


def _with_overall(records: Sequence[Record]) -> list[Row]:
    rows = [*summarise(records), *overall(records)]
    settings = sorted({row.setting for row in rows})
    return [row for where in settings for row in rows if row.setting == where]


def _markdown(sheet: Sheet, columns: Sequence[Column]) -> list[str]:
    lines = [
        f"**{_text(sheet.title)}**",
        "",
        f"| {' | '.join(_text(column.title) for column in columns)} |",
        "|" + "".join("---:|" if column.numeric else "---|" for column in columns),
    ]
    for row in sheet.rows:
        lines.append(f"| {' | '.join(_text(row.get(column.key, DASH).text) for column in columns)} |")
    return [*lines, ""]


def _text(text: str) -> str:
    return plain(text).replace("|", "\\|").replace("<", "&lt;")


def _csv_cells(row: Mapping[str, Cell], columns: Iterable[Column], ranged: set[str]) -> list[object]:
    cells: list[object] = []
    for column in columns:
        cell = row.get(column.key)
        known = cell is not None and cell.value is not None
        cells.append("" if cell is None else cell.value if known else _safe(cell.text))
        if column.key in ranged:
            cells += ["", ""] if cell is None or cell.low is None else [cell.low, cell.high]
    return cells


def _safe(text: str) -> str:
    text = plain(text)
    return f"'{text}" if text.startswith(_FORMULA) else text
