"""The matrix: the success rate of every agent on every task, with its interval, a sheet a setting."""

from __future__ import annotations

from collections.abc import Sequence

from remac_bench.board import Cell, Column, Sheet
from remac_bench.judging.cells import Cells, only_known, rate, word
from remac_bench.judging.results import facts
from remac_bench.metrics import ALL_TASKS, Row

KEY = "matrix"

CAPTION = (
    "Share of scored episodes in which the goal holds at the end, with Wilson's 95% interval. Two agents whose "
    "intervals overlap may still differ: the ranking compares them on the episodes that both have played."
)


def matrix_sheets(rows: Sequence[Row], over_all: Sequence[Row], *, folder: str) -> list[Sheet]:
    """One sheet for each setting, in the order of the rows: all tasks together first, then each."""
    settings = list(dict.fromkeys(row.setting for row in rows))
    return [
        _sheet(
            where,
            [row for row in (*over_all, *rows) if row.setting == where],
            key=KEY if len(settings) == 1 else f"{KEY}-{number}",
            folder=folder,
        )
        for number, where in enumerate(settings, start=1)
    ]


def _sheet(where: str, rows: Sequence[Row], *, key: str, folder: str) -> Sheet:
    tasks = sorted(dict.fromkeys(row.task for row in rows), key=lambda task: task != ALL_TASKS)
    agents: dict[str, dict[str, Row]] = {}
    for row in rows:
        agents.setdefault(row.agent, {})[row.task] = row
    columns = [Column(key=f"task-{index}", title=task) for index, task in enumerate(tasks)]
    return Sheet(
        key=key,
        title=f"Success by agent and task: {where}",
        caption=CAPTION,
        command=f"remac bench report {folder} --all",
        columns=(Column(key="agent", title="Method", numeric=False), *columns),
        rows=tuple(_cells(agent, tasks, row) for agent, row in agents.items()),
        facts=tuple(_facts(next(iter(row.values()))) for row in agents.values()),
    )


def _cells(agent: str, tasks: Sequence[str], row: dict[str, Row]) -> Cells:
    shares = {f"task-{index}": _share(row[task]) for index, task in enumerate(tasks) if task in row}
    return only_known({"agent": word(agent), **shares})


def _share(row: Row) -> Cell:
    return rate(row.successes, row.n, note=f"{row.successes} of {row.n}" if row.n else "")


def _facts(row: Row) -> dict[str, str]:
    return {name: fact for name, fact in facts(row).items() if name != "task"}
