"""Who was given rules or the truth, said in every table in which a planner, or a role that was chosen, was."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from remac_bench.board import Column, Sheet
from remac_bench.judging.checkers import behind_agent
from remac_bench.records import Record

COLUMN = Column(
    key="given",
    title="Given",
    numeric=False,
    help="planners, and roles that were chosen, that were given the rules of the skill table or the true state; who "
    "checks has a column of its own",
)


def given_of(records: Iterable[Record]) -> dict[str, str]:
    """Agent -> what its planner was given beyond names, and what the other roles that were chosen for it."""
    found: dict[str, set[str]] = {}
    for record in records:
        found.setdefault(record.agent, set()).update(_given(record))
    return {agent: "; ".join(sorted(told)) for agent, told in found.items()}


def with_readers(sheets: Sequence[Sheet], given: Mapping[str, str]) -> list[Sheet]:
    """The sheets with a column behind the agent's, where there is something to be said."""
    said = any(given.values())
    return [behind_agent(sheet, COLUMN, given) for sheet in sheets] if said else list(sheets)


def _given(record: Record) -> Iterable[str]:
    chosen = record.options.get("agent", {})
    for role in sorted({*record.truth_readers, *record.rule_readers} - {"checker"}):
        if role == "planner" or role in chosen:
            yield f"{role}: {'truth' if role in record.truth_readers else 'rules'}"
