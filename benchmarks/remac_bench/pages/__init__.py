"""A folder's records as static pages: a leaderboard and one page an episode, without a server or a request outside."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from remac_bench.pages.places import EPISODES, LEADERBOARD, TABLES

if TYPE_CHECKING:
    from remac_bench.board import Board

__all__ = ["EPISODES", "LEADERBOARD", "TABLES", "write_pages"]


def write_pages(folder: str | Path, board: Board | None = None) -> Path:
    """Write DIR/leaderboard.html, DIR/episodes/*.html and DIR/tables/*.svg|png anew; returns the first.

    Args:
        board: the folder's tables, where they have been computed already.

    Raises:
        UsageError, RecordFileError: if the folder has no records, or they cannot be read.
        StorageError: if the pages cannot be written.
    """
    from remac_bench.pages.writing import write

    return write(Path(folder), board)
