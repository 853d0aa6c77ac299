"""Who judged the conditions, said in every table in which it is not the same, or not the truth."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from remac_bench.board import Column, Sheet
from remac_bench.judging.cells import DASH, only_known, word
from remac_bench.playing.sight import checked_by
from remac_bench.records import Record

DEFAULT = "truth"
"""What `remac_agents.make` fills the role with: it need not be named where nobody else checks."""

COLUMN = Column(key="checker", title="Checked by", numeric=False, help="who judged conditions; - if nobody is asked")


def checkers_of(records: Iterable[Record]) -> dict[str, str]:
    """Agent -> who judges its conditions; "" where nobody does."""
    found: dict[str, set[str]] = {}
    for record in records:
        found.setdefault(record.agent, set()).add(checked_by(record))
    return {agent: ", ".join(sorted(names)) for agent, names in found.items()}


def need_naming(checkers: Iterable[str]) -> bool:
    """Whether tables must say who checks."""
    return bool(set(checkers) - {"", DEFAULT})


def with_checkers(sheets: Sequence[Sheet], checkers: Mapping[str, str]) -> list[Sheet]:
    """The sheets with a column behind the agent's that says who checks, where that must be said."""
    named = need_naming(checkers.values())
    return [behind_agent(sheet, COLUMN, checkers) for sheet in sheets] if named else list(sheets)


def behind_agent(sheet: Sheet, column: Column, texts: Mapping[str, str]) -> Sheet:
    """The sheet with a column behind the agent's: agent -> text. One without agents stays as it is."""
    keys = [each.key for each in sheet.columns]
    if "agent" not in keys or column.key in keys:
        return sheet
    behind = keys.index("agent") + 1
    columns = (*sheet.columns[:behind], column, *sheet.columns[behind:])
    names = [texts.get(row["agent"].text, "") if "agent" in row else "" for row in sheet.rows]
    cells = [word(name) if name else DASH for name in names]
    rows = [only_known({**row, column.key: cell}) for row, cell in zip(sheet.rows, cells, strict=True)]
    return replace(sheet, columns=columns, rows=tuple(rows))
