"""How episodes ended, in words that need no explanation."""

from __future__ import annotations

from remac_bench.records import Record

SUCCESS, CRASHED, NOT_SCORED, FAILED = "success", "crashed", "not scored", "failed"

ENDINGS = {
    "success": SUCCESS,
    "lost": "failed: goal out of reach",
    "done": "failed: stopped too early",
    "truncated": "failed: out of rounds",
}
"""The record's `end` -> what it means: nothing can reach the goal any more; every robot said `done`; the rounds are
up."""


def ending(record: Record) -> str:
    """How an episode ended."""
    if record.infrastructure_error:
        return NOT_SCORED
    if record.success:
        return SUCCESS
    if record.error is not None:
        return CRASHED
    return ENDINGS.get(record.end or "", f"{FAILED}: {record.end}" if record.end else FAILED)
