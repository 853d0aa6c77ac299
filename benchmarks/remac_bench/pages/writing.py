"""Pages to files."""

from __future__ import annotations

from pathlib import Path

from remac_bench.blame.sheet import read_blames
from remac_bench.board import Board
from remac_bench.errors import StorageError
from remac_bench.pages.episode_page import page, page_name
from remac_bench.pages.leaderboard import leaderboard
from remac_bench.pages.pictures import write_pictures
from remac_bench.pages.places import EPISODES, LEADERBOARD, TABLES
from remac_bench.records import Record
from remac_bench.report import read_board, read_records


def write(folder: Path, board: Board | None) -> Path:
    """See `remac_bench.pages.write_pages`."""
    board = board or read_board(folder)
    records, blames = read_records(folder), read_blames(folder)
    labels = {(blame.job, blame.iteration): blame for blame in blames}
    jobs: dict[str, list[Record]] = {}
    for record in records:
        jobs.setdefault(record.job, []).append(record)
    try:
        _clear(folder)
        for record in records:
            blame = labels.get((record.job, record.iteration))
            html = page(record, folder=folder, siblings=jobs[record.job], blame=blame)
            _put(folder / EPISODES / page_name(record), html)
        write_pictures(board.sheets, folder / TABLES)
        # Last: whoever finds it finds all that it links to.
        _put(folder / LEADERBOARD, leaderboard(board, records, blames))
    except OSError as error:
        raise StorageError(
            f"{error.filename or folder}: {error.strerror or error}; make room, or print the tables with --no-pages"
        ) from error
    return folder / LEADERBOARD


def _clear(folder: Path) -> None:
    """Remove pages and pictures of an earlier report; other files stay."""
    (folder / EPISODES).mkdir(parents=True, exist_ok=True)
    (folder / TABLES).mkdir(exist_ok=True)
    old = [*(folder / EPISODES).glob("*.html"), *(folder / TABLES).glob("*.svg"), *(folder / TABLES).glob("*.png")]
    for path in old:
        path.unlink()


def _put(path: Path, text: str) -> None:
    path.write_text(text, "utf-8", errors="replace")
