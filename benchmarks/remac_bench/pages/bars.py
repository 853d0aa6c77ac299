"""Bars: how often each agent succeeds on each task."""

from __future__ import annotations

from dataclasses import dataclass

from remac_bench.board import Cell, Sheet

_DASH = Cell(text="-")


@dataclass(frozen=True, kw_only=True)
class Bar:
    """An agent's share, and its interval, as x positions in 0..100."""

    agent: str
    setting: str
    text: str
    value: float
    low: float
    high: float


@dataclass(frozen=True, kw_only=True)
class TaskBars:
    """A task's bars, one an agent."""

    task: str
    bars: tuple[Bar, ...]


def bars(sheet: Sheet) -> tuple[TaskBars, ...]:
    """The columns of a matrix as bars."""
    return tuple(
        TaskBars(
            task=column.title,
            bars=tuple(
                _bar(facts["agent"], facts["setting"], row.get(column.key, _DASH))
                for row, facts in zip(sheet.rows, sheet.facts, strict=True)
            ),
        )
        for column in sheet.columns
        if column.key.startswith("task-")
    )


def _bar(agent: str, setting: str, cell: Cell) -> Bar:
    value, low, high = (round(100 * (part or 0.0), 1) for part in (cell.value, cell.low, cell.high))
    return Bar(agent=agent, setting=setting, text=cell.text, value=value, low=low, high=high)
