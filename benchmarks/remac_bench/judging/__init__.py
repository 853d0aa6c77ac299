"""Everything that is computed from records: results, ranking, evolution, the audit of checkers, the paper's tables."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from remac_bench.blame.labels import Blame
    from remac_bench.board import Board
    from remac_bench.records import Record


def board(
    records: Iterable[Record], *, blames: Iterable[Blame] = (), title: str = "Leaderboard", folder: str = "DIR"
) -> Board:
    """All tables of these records.

    Args:
        records: in any order; of a job and iteration that is there twice, one that was scored counts.
        blames: labels of failed episodes, as `remac bench blame` writes them; without any there is no such table.
        title: of the board.
        folder: of the records, as it stands in the commands that print the tables.
    """
    from remac_bench.judging.assembly import assemble

    return assemble(records, blames=tuple(blames), title=title, folder=folder)
