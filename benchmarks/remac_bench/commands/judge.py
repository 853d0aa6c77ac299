"""`remac bench report` and `remac bench blame`: what the records of a folder say."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from remac_bench.columns import across, show
from remac_bench.console import console
from remac_bench.errors import UsageError
from remac_bench.flags import takes
from remac_env.files import prepare_folder

Folder = Annotated[str, typer.Argument(help="The --out of a run.")]
Folders = Annotated[list[str], typer.Argument(help="The --out of a run; of several, one report together.")]


@takes(
    *("records.as_markdown", "report.everything", "report.grade", "report.template"),
    *("report.csv", "report.pages", "report.out"),
)
def report(
    folders: Folders,
    *,
    as_markdown: bool,
    everything: bool,
    grade: str | None,
    template: str | None,
    csv: str | None,
    pages: bool,
    out: str | None,
) -> None:
    """Print the tables of records, and write them as pages: FOLDER/leaderboard.html, or OUT/leaderboard.html."""
    from remac_bench.report import board_markdown, board_tables, prepare_csv, read_board, write_csv

    if csv is not None:
        prepare_csv(csv)
    if out is not None:
        prepare_folder(out, "--out")
    if len(folders) > 1 and pages and out is None:
        raise UsageError("--out is missing: a folder for the pages of several folders; or give --no-pages")
    board = read_board(*folders, grades=_parts(grade), templates=_parts(template))
    if pages and grade is None and template is None:  # the pages are of everything, and filter it themselves
        from remac_bench.pages import write_pages

        typer.echo(f"pages: {write_pages(out or folders[0], board, of=folders)}", err=True)
    if csv is not None:
        for path in write_csv(board, csv):
            typer.echo(str(path), err=True)
        return
    if as_markdown:
        typer.echo(board_markdown(board, everything=everything))
        return
    show(*board_tables(board, everything=everything, across=across()))


def _parts(given: str | None) -> list[str]:
    return [part.strip() for part in (given or "").split(",") if part.strip()]


@takes("records.as_markdown", "blame.rescue", "extensions", "records.bodies")
def blame(
    folder: Folder, *, as_markdown: bool, rescue: bool, extensions: list[str] | None, bodies: list[str] | None
) -> None:
    """Play a folder's failed episodes again, say why each failed, and write FOLDER/blame.jsonl."""
    from rich.progress import track

    from remac_bench.blame.labels import blame as label
    from remac_bench.blame.labels import failed
    from remac_bench.blame.sheet import FILE, blame_sheets, write_blames
    from remac_bench.board import Board
    from remac_bench.playing.extensions import load_named
    from remac_bench.report import board_markdown, board_tables, read_records
    from remac_env.files import prepare_file

    load_named(extensions, bodies)
    records = failed(read_records(folder))
    prepare_file(Path(folder) / FILE, "the file of labels")
    screen = console(stderr=True)
    blames = [label(record, rescuing=rescue) for record in track(records, "playing again", console=screen)]
    path = write_blames(folder, blames)
    board = Board(title="Blame", sheets=tuple(blame_sheets(blames, folder=folder)))
    if as_markdown:
        typer.echo(board_markdown(board, everything=True))
    else:
        show(*board_tables(board, everything=True, across=across()))
    typer.echo(f"{len(blames)} failed {'episode' if len(blames) == 1 else 'episodes'}; labels: {path}", err=True)
