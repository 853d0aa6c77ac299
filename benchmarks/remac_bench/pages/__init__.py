"""A folder's records as static pages: a leaderboard and one page an episode, without a server or a request outside."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from remac_bench.pages.places import EPISODES, LEADERBOARD, TABLES

if TYPE_CHECKING:
    from remac_bench.board import Board

__all__ = ["EPISODES", "LEADERBOARD", "TABLES", "write_pages"]


def write_pages(folder: str | Path, board: Board | None = None, *, of: Sequence[str | Path] = ()) -> Path:
    """Write FOLDER/leaderboard.html, FOLDER/episodes/*.html and FOLDER/tables/*.svg|png anew; returns the first.

    Args:
        board: the tables, where they have been computed already.
        of: the folders with the records; by default the folder itself. Videos and pictures that lie in others come
            along, so that the folder can be sent as it is.

    Raises:
        UsageError, RecordFileError: if a folder has no records, or they cannot be read.
        StorageError: if the pages cannot be written.
    """
    from remac_bench.pages.writing import write

    return write(Path(folder), board, tuple(map(Path, of)) or (Path(folder),))
