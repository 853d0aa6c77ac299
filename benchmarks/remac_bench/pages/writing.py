"""Pages to files."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path

from remac_bench.blame.labels import Blame
from remac_bench.board import Board
from remac_bench.errors import StorageError
from remac_bench.pages.episode_page import page, page_name
from remac_bench.pages.leaderboard import leaderboard
from remac_bench.pages.pictures import write_pictures
from remac_bench.pages.places import EPISODES, LEADERBOARD, TABLES
from remac_bench.records import Record
from remac_bench.report import read_board, read_folders, read_labels
from remac_bench.store import PICTURES, VIDEOS


def write(folder: Path, board: Board | None, sources: Sequence[Path]) -> Path:
    """See `remac_bench.pages.write_pages`."""
    board = board or read_board(*sources)
    records, blames = read_folders(sources), read_labels(sources)
    try:
        _clear(folder)
        for source in sources:
            bring(source, folder)
        for record, html in episode_pages(records, blames, folder=folder):
            _put(folder / EPISODES / page_name(record), html)
        write_pictures(board.sheets, folder / TABLES)
        # Last: whoever finds it finds all that it links to.
        _put(folder / LEADERBOARD, leaderboard(board, records, blames))
    except OSError as error:
        raise StorageError(
            f"{error.filename or folder}: {error.strerror or error}; make room, or print the tables with --no-pages"
        ) from error
    return folder / LEADERBOARD


def episode_pages(
    records: Sequence[Record], blames: Sequence[Blame], *, folder: Path
) -> Iterator[tuple[Record, str]]:
    """The page of every episode, with what is told of it elsewhere. `folder`: where videos and pictures lie."""
    labels = {(blame.job, blame.iteration): blame for blame in blames}
    jobs: dict[str, list[Record]] = {}
    for record in records:
        jobs.setdefault(record.job, []).append(record)
    for record in records:
        blame = labels.get((record.job, record.iteration))
        yield record, page(record, folder=folder, siblings=jobs[record.job], blame=blame)


def bring(source: Path, folder: Path) -> None:
    """Put the videos and pictures of a run into another folder: as links to the same data, or else as copies."""
    if source.resolve() == folder.resolve():
        return
    for path in [*(source / VIDEOS).glob("*.webm"), *(source / PICTURES).glob("*.png")]:
        target = folder / path.parent.name / path.name
        target.parent.mkdir(exist_ok=True)
        target.unlink(missing_ok=True)
        try:
            os.link(path, target)
        except OSError:  # another disk, or one without such links
            shutil.copyfile(path, target)


def _clear(folder: Path) -> None:
    """Remove pages and pictures of an earlier report; other files stay."""
    (folder / EPISODES).mkdir(parents=True, exist_ok=True)
    (folder / TABLES).mkdir(exist_ok=True)
    old = [*(folder / EPISODES).glob("*.html"), *(folder / TABLES).glob("*.svg"), *(folder / TABLES).glob("*.png")]
    for path in old:
        path.unlink()


def _put(path: Path, text: str) -> None:
    path.write_text(text, "utf-8", errors="replace")
