"""The board: all sheets, in the order in which they are read."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from remac_bench.blame.labels import Blame
from remac_bench.blame.sheet import blame_sheets
from remac_bench.board import Board, Sheet
from remac_bench.judging.audit import audit_sheets
from remac_bench.judging.checkers import checkers_of, with_checkers
from remac_bench.judging.episodes import code_note, distinct
from remac_bench.judging.evolution import evolution_sheets
from remac_bench.judging.grades import grade_sheets
from remac_bench.judging.matrix import matrix_sheets
from remac_bench.judging.published import paper_sheets, phase_sheets
from remac_bench.judging.ranking import ranking_sheets
from remac_bench.judging.readers import given_of, with_readers
from remac_bench.judging.results import results_sheets
from remac_bench.judging.times import time_sheets
from remac_bench.metrics import overall, summarise
from remac_bench.records import Record


def assemble(records: Iterable[Record], *, blames: Sequence[Blame], title: str, folder: str) -> Board:
    """See `judging.board`."""
    known = distinct(records)
    rows, over_all = summarise(known), overall(known)
    sheets: list[Sheet] = [
        *grade_sheets(known, folder=folder),
        *matrix_sheets(rows, over_all, folder=folder),
        *results_sheets(rows, over_all, folder=folder),
        *ranking_sheets(known, folder=folder),
        *paper_sheets(rows, over_all, folder=folder),
        *phase_sheets(known, folder=folder),
        *time_sheets(known, folder=folder),
        *evolution_sheets(known, folder=folder),
        *audit_sheets(known, folder=folder),
        *blame_sheets(blames, folder=folder),
    ]
    told = with_readers(with_checkers(sheets, checkers_of(known)), given_of(known))
    return Board(title=title, note=code_note(known), sheets=tuple(told))
