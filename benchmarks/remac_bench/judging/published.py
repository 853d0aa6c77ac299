"""The paper's tables with our numbers beside them. The paper's are data: published.toml."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from remac_bench.board import Cell, Column, Sheet
from remac_bench.judging.cells import Cells, count, number, only_known, percent, rate, word
from remac_bench.judging.episodes import setting
from remac_bench.judging.statistics import mean
from remac_bench.metrics import Row
from remac_bench.playing import agents
from remac_bench.records import Record

FILE = Path(__file__).parents[1] / "published.toml"

PAPER = "the paper's number"
"""The note of every cell that holds one."""


@cache
def published() -> Mapping[str, Any]:
    """What the paper prints, by table: table_1, figure_6, table_2, wording, table_3."""
    return tomllib.loads(FILE.read_text("utf-8"))


TABLE_1_COLUMNS = (
    Column(key="task", title="Task", numeric=False),
    Column(key="agent", title="Method", numeric=False),
    Column(key="n", title="n"),
    Column(key="tsr", title="TSR"),
    Column(key="paper_tsr", title="paper's TSR", help="the paper's TSR, of 10 episodes"),
    Column(key="scr", title="SCR"),
    Column(key="paper_scr", title="paper's SCR", help="the paper's SCR"),
    Column(key="ipl", title="IPL", help="by the paper's words: the first plan"),
    Column(key="fpl", title="FPL", help="what the paper's IPL column counts: the plan in force at the end"),
    Column(key="paper_length", title="paper's IPL", help="the paper's IPL column"),
    Column(key="seconds", title="Time s"),
    Column(key="paper_seconds", title="paper's s", help="the paper's seconds, which it does not define"),
)
FIGURE_6_COLUMNS = (
    Column(key="agent", title="Method", numeric=False),
    Column(key="n", title="n"),
    Column(key="tsr", title="TSR", help="over all tasks, with Wilson's 95% interval"),
    Column(key="paper_tsr", title="paper's TSR", help="read off the paper's figure"),
)


def phase_sheets(records: Sequence[Record], *, folder: str) -> list[Sheet]:
    """The paper's Table 3, for each setting in which its task was played and scored by phases."""
    table = published()["table_3"]
    kept = [r for r in records if r.scored and r.task == table["task"] and getattr(r, "phases", None)]
    settings = sorted({setting(record) for record in kept})
    return [
        _table_3(
            where,
            [record for record in kept if setting(record) == where],
            key="table-3" if len(settings) == 1 else f"table-3-{index}",
            folder=folder,
        )
        for index, where in enumerate(settings, start=1)
    ]


def paper_sheets(rows: Sequence[Row], over_all: Sequence[Row], *, folder: str) -> list[Sheet]:
    """The paper's Table 1 and Figure 6, for each setting that has paper starts and one of their cells."""
    settings = [where for where in dict.fromkeys(row.setting for row in rows) if _is_like_the_papers(where)]
    sheets: list[Sheet] = []
    for index, where in enumerate(settings, start=1):
        tail = "" if len(settings) == 1 else f"-{index}"
        sheets += _table_1(where, [row for row in rows if row.setting == where], tail, folder)
        sheets += _figure_6(where, [row for row in over_all if row.setting == where], tail, folder)
    return sheets


def paper_cell(value: float | None, *, percentage: bool = True) -> Cell:
    """A number of the paper's, marked as such."""
    return percent(value, note=PAPER) if percentage else number(value, note=PAPER)


def _is_like_the_papers(where: str) -> bool:
    table = published()["table_1"]
    return f"{table['starts']} starts" in where and "wording=" not in where


def _table_1(where: str, rows: Sequence[Row], tail: str, folder: str) -> list[Sheet]:
    table = published()["table_1"]
    kept = [row for row in rows if row.method in table.get(row.task, {})]
    if not kept:
        return []
    return [
        Sheet(
            key=f"table-1{tail}",
            title=f"The paper's {table['title']}; ours: {where}",
            caption=_caption(f"The paper plays {table['episodes']} episodes a task and method."),
            command=f"remac bench report {folder} --all",
            columns=TABLE_1_COLUMNS,
            rows=tuple(_table_1_cells(row, table[row.task][row.method]) for row in kept),
            facts=tuple(_facts(row) for row in kept),
        )
    ]


def _caption(note: str = "") -> str:
    paper = published()
    return " ".join(part for part in (f"The paper: {paper['source']}.", paper["differs"], note) if part)


def _table_1_cells(row: Row, paper: Mapping[str, float]) -> Cells:
    return only_known(
        {
            "task": word(row.task),
            "agent": word(row.agent),
            "n": count(row.n),
            "tsr": rate(row.successes, row.n),
            "scr": percent(row.scr),
            "ipl": number(row.ipl),
            "fpl": number(row.fpl),
            "seconds": number(row.seconds),
            "paper_tsr": paper_cell(paper.get("tsr")),
            "paper_scr": paper_cell(paper.get("scr")),
            "paper_length": paper_cell(paper.get("length"), percentage=False),
            "paper_seconds": paper_cell(paper.get("seconds"), percentage=False),
        }
    )


def _figure_6(where: str, over_all: Sequence[Row], tail: str, folder: str) -> list[Sheet]:
    figure = published()["figure_6"]
    kept = list(over_all)
    if not any(row.method in figure["tsr"] for row in kept):
        return []
    played = {row.method for row in kept}
    rows = [_figure_cells(row.agent, row, figure["tsr"].get(row.method)) for row in kept]
    facts = [_facts(row) for row in kept]
    for name, value in figure["tsr"].items():
        if name not in played:
            alone = " (planner alone)" if name in figure["plain_planners"] else ""
            rows.append(_figure_cells(f"{name}{alone}", None, value))
            facts.append({"method": name, "setting": where})
    return [
        Sheet(
            key=f"figure-6{tail}",
            title=f"The paper's {figure['title']}; ours: {where}",
            caption=_caption(figure["note"]),
            command=f"remac bench report {folder} --all",
            columns=FIGURE_6_COLUMNS,
            rows=tuple(rows),
            facts=tuple(facts),
        )
    ]


def _figure_cells(name: str, row: Row | None, value: float | None) -> Cells:
    paper = percent(value, note=PAPER, digits=1)
    if row is None:
        return only_known({"agent": word(name, note="the paper's alone"), "paper_tsr": paper})
    return only_known({"agent": word(name), "n": count(row.n), "tsr": rate(row.successes, row.n), "paper_tsr": paper})


def _table_3(where: str, records: Sequence[Record], *, key: str, folder: str) -> Sheet:
    table = published()["table_3"]
    names = list(getattr(max(records, key=lambda r: len(getattr(r, "phases", {}))), "phases", {}))
    groups: dict[str, list[Record]] = {}
    for record in sorted(records, key=lambda r: (_place(r.method), r.agent)):
        groups.setdefault(record.agent, []).append(record)
    rows, facts = [], []
    for agent, group in groups.items():
        labels = {"task": table["task"], "method": group[0].method, "agent": agent, "setting": where}
        won = [sum(bool(getattr(r, "phases", {}).get(name)) for r in group) for name in names]
        cells = {f"phase-{index}": rate(count_, len(group)) for index, count_ in enumerate(won, start=1)}
        seconds = mean(record.sim_seconds for record in group if record.success)
        rows.append(only_known({"agent": word(agent), "n": count(len(group)), **cells, "seconds": number(seconds)}))
        facts.append(labels)
        paper = table.get(group[0].method)
        if isinstance(paper, Mapping):
            rows.append(_table_3_paper(group[0].method, paper, table["episodes"]))
            facts.append(labels)
    phases = (Column(key=f"phase-{index}", title=name) for index, name in enumerate(names, start=1))
    return Sheet(
        key=key,
        title=f"The paper's {table['title']}; ours: {where}",
        caption=_caption("Its episodes were played by a real robot. A phase counts once those before it were reached."),
        command=f"remac bench report {folder} --all",
        columns=(
            Column(key="agent", title="Method", numeric=False),
            Column(key="n", title="n"),
            *phases,
            Column(key="seconds", title="Time s", help="mean over successes"),
        ),
        rows=tuple(rows),
        facts=tuple(facts),
    )


def _table_3_paper(method: str, paper: Mapping[str, Any], episodes: int) -> Cells:
    rates = {f"phase-{index}": paper_cell(value) for index, value in enumerate(paper["rates"], start=1)}
    return only_known(
        {
            "agent": word(f"{method}, the paper's"),
            "n": count(episodes, note=PAPER),
            **rates,
            "seconds": paper_cell(paper.get("seconds"), percentage=False),
        }
    )


def _place(method: str) -> int:
    names = agents.methods_to_compare()
    return names.index(method) if method in names else len(names)


def _facts(row: Row) -> dict[str, str]:
    return {"task": row.task, "method": row.method, "agent": row.agent, "setting": row.setting}
