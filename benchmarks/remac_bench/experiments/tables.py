"""Tables of the plan-only experiments, ours beside the paper's."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from importlib import resources
from typing import Any

from rich import box
from rich.markup import escape
from rich.table import Table

from remac_bench.asked import Asked
from remac_bench.experiments.desk import Trial
from remac_bench.experiments.trials import Count, counted, faults

Key = tuple[str, ...]


@lru_cache(maxsize=1)
def published() -> dict[str, Any]:
    """Experiment -> the paper's table: source, n, columns, rows."""
    text = resources.files("remac_bench").joinpath("experiments/published.toml").read_text("utf-8")
    return tomllib.loads(text)


def tables(experiment: str, trials: Sequence[Trial]) -> list[Table]:
    """The experiment's table for a terminal, and the paper's beside it where there is one."""
    if experiment == "validity":
        return [_validity(trials)]
    return [_rates(experiment, trials), _papers(experiment)]


def as_json(experiment: str, trials: Sequence[Trial], usage: Mapping[str, Asked] | None = None) -> dict[str, Any]:
    """The experiment's cells, every trial of it, the paper's numbers, and what each planner took of language models."""
    taken = {planner: asked.as_json() for planner, asked in (usage or {}).items()}
    return {
        "experiment": experiment,
        "cells": [
            {"row": list(row), "column": list(column), **count.as_json()}
            for (row, column), count in _counts(experiment, trials).items()
        ],
        "faults": {name: dict(faults(t for t in trials if t.planner == name)) for name in _planners(trials)},
        "trials": [
            {
                "planner": trial.planner,
                "task": trial.cell.task,
                **trial.cell.options,
                "seed": trial.cell.seed,
                "reflections": trial.told,
                "own": trial.own,
                "lessons": list(trial.lessons),
                **trial.judgement.as_json(),
            }
            for trial in trials
        ],
        "paper": published().get(experiment),
        **({"usage": taken} if taken else {}),
    }


_KEYS: dict[str, tuple[Callable[[Trial], Key], Callable[[Trial], Key]]] = {
    "reflection": (
        lambda trial: (trial.cell.starts, str(trial.cell.robots), trial.cell.task),
        lambda trial: (trial.planner, *(["own reflections"] if trial.own else [])),
    ),
    "wording": (
        lambda trial: (trial.cell.starts, str(trial.cell.robots), f"wording {trial.cell.wording}"),
        lambda trial: (trial.planner, ("own reflections" if trial.own else "reflections") if trial.told else ""),
    ),
    "validity": (
        lambda trial: (trial.cell.starts, str(trial.cell.robots), trial.cell.task),
        lambda trial: (trial.planner,),
    ),
}
"""Experiment -> (row, column) of a trial."""


def _counts(experiment: str, trials: Sequence[Trial]) -> dict[tuple[Key, Key], Count]:
    row, column = _KEYS[experiment]
    groups: dict[tuple[Key, Key], list[bool | None]] = {}
    for trial in trials:
        good = trial.judgement.optimal if experiment == "reflection" else trial.judgement.valid
        groups.setdefault((row(trial), column(trial)), []).append(good)
    return {key: counted(values) for key, values in groups.items()}


_TITLES = {
    "reflection": "Optimal plans after an earlier suboptimal plan and its reflections",
    "wording": "Valid initial plans by wording of the goal",
}


def _rates(experiment: str, trials: Sequence[Trial]) -> Table:
    """Rows by starts, robots and task or wording; a column a planner."""
    counts = _counts(experiment, trials)
    columns = list(dict.fromkeys(column for _, column in counts))
    made = Table(title=_TITLES[experiment], box=box.SIMPLE_HEAD, caption="with Wilson's 95% intervals")
    for head in ("Starts", "Robots", "Of"):
        made.add_column(head, no_wrap=True)
    for column in columns:
        made.add_column(escape("\n".join(part for part in column if part)), justify="right")
    for row in dict.fromkeys(row for row, _ in counts):
        made.add_row(*map(escape, row), *(_cell(counts.get((row, column))) for column in columns))
    return made


def _papers(experiment: str) -> Table:
    """The paper's own numbers, marked as such."""
    paper = published()[experiment]
    made = Table(title="The paper's numbers", box=box.SIMPLE_HEAD, caption=f"{paper['source']}, n = {paper['n']}")
    made.add_column("Of", no_wrap=True)
    for name in paper["columns"]:
        made.add_column(name.replace(", ", "\n"), justify="right")
    for name, values in paper["rows"].items():
        made.add_row(name, *(f"{value:.1%}" for value in values))
    return made


def _validity(trials: Sequence[Trial]) -> Table:
    """One row a planner, kind of start and number of robots."""
    groups: dict[Key, list[Trial]] = {}
    for trial in trials:
        groups.setdefault((trial.planner, trial.cell.starts, str(trial.cell.robots)), []).append(trial)
    made = Table(title="Initial plans and their first errors", box=box.SIMPLE_HEAD)
    for head in ("Planner", "Starts", "Robots", "Valid", "Optimal", "First errors"):
        made.add_column(head, justify="right" if head in ("Valid", "Optimal") else "left")
    for key, group in groups.items():
        valid = counted(trial.judgement.valid for trial in group)
        optimal = counted(trial.judgement.optimal for trial in group)
        seen = ", ".join(f"{name} {number}" for name, number in faults(group).most_common())
        made.add_row(*map(escape, key), _cell(valid), _cell(optimal), seen)
    return made


def _cell(count: Count | None) -> str:
    if count is None or count.interval is None:
        return "-"
    low, high = count.interval
    return f"{count.successes}/{count.n}\n{low:.0%}-{high:.0%}"


def _planners(trials: Sequence[Trial]) -> list[str]:
    return list(dict.fromkeys(trial.planner for trial in trials))
