"""Pages to files."""

from __future__ import annotations

import os
import shutil
from bisect import bisect, bisect_left
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from remac_bench.blame.labels import Blame
from remac_bench.board import Board
from remac_bench.errors import StorageError
from remac_bench.pages.episode_page import Neighbours, page, page_name
from remac_bench.pages.episode_rows import order
from remac_bench.pages.leaderboard import leaderboard
from remac_bench.pages.pictures import write_pictures
from remac_bench.pages.places import EPISODES, LEADERBOARD, TABLES
from remac_bench.records import Record
from remac_bench.report import read_board, read_folders, read_labels, read_records
from remac_bench.store import PICTURES, VIDEOS


def write(folder: Path, board: Board | None, sources: Sequence[Path]) -> Path:
    """See `remac_bench.pages.write_pages`."""
    board = board or read_board(*sources)
    records, blames = read_folders(sources), read_labels(sources)
    homes = {(r.job, r.iteration): str(source) for source in sources for r in read_records(source)}
    try:
        _clear(folder)
        for source in sources:
            bring(source, folder)
        pages = EpisodePages(records, blames, folder=folder, homes=homes)
        for name in pages.names:
            _put(folder / EPISODES / name, pages.html(name))
        write_pictures(board.sheets, folder / TABLES)
        # Last: whoever finds it finds all that it links to.
        _put(folder / LEADERBOARD, leaderboard(board, records, blames))
    except OSError as error:
        raise StorageError(
            f"{error.filename or folder}: {error.strerror or error}; make room, or print the tables with --no-pages"
        ) from error
    return folder / LEADERBOARD


class EpisodePages:
    """The pages of episodes, each with what is told of it elsewhere; made when they are asked for."""

    def __init__(
        self,
        records: Iterable[Record],
        blames: Iterable[Blame],
        *,
        folder: Path,
        homes: Mapping[tuple[str, int], str],
    ) -> None:
        """Args: folder: where videos and pictures lie; homes: job and iteration -> the folder of its record."""
        self._folder, self._homes = folder, homes
        self._labels = {(blame.job, blame.iteration): blame for blame in blames}
        self._ordered = sorted(records, key=order)
        self._jobs: dict[str, list[Record]] = {}
        for record in self._ordered:
            self._jobs.setdefault(record.job, []).append(record)
        self._failed = [index for index, record in enumerate(self._ordered) if record.scored and not record.success]
        self._places = {page_name(record): index for index, record in enumerate(self._ordered)}

    @property
    def names(self) -> list[str]:
        """The pages' file names."""
        return list(self._places)

    def html(self, name: str) -> str:
        """One page; KeyError for a name that is none."""
        index = self._places[name]
        record, before, behind = self._ordered[index], bisect_left(self._failed, index), bisect(self._failed, index)
        neighbours = Neighbours(
            siblings=tuple(self._jobs[record.job]),
            failed_before=self._ordered[self._failed[before - 1]] if before else None,
            failed_behind=self._ordered[self._failed[behind]] if behind < len(self._failed) else None,
        )
        key = (record.job, record.iteration)
        return page(
            record, folder=self._folder, neighbours=neighbours, blame=self._labels.get(key), home=self._homes[key]
        )


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
