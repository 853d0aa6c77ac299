"""The paper's metrics, computed from scored records alone (design, section 4)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from remac_bench.records import Record
from remac_env.options import Options

Z_95 = 1.959964
"""Two-sided 95% quantile of the standard normal distribution."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One agent on one task in one setting. None stands where nothing was measured.

    Attributes:
        n, successes: scored episodes, and those in which the goal held at the end.
        low, high: Wilson's 95% interval of the task success rate.
        scr: subtask completion rate: rounds done of the plans in force at the end, over their lengths;
            successes and failures pooled, as the paper's fractions are (70/110).
        seconds, ipl, fpl: means over successes: simulated seconds, lengths of the first and the final plan.
        crashed: scored episodes that a crash of the agent ended; they are failures.
        infrastructure: jobs without a score because something else broke; the next call runs them again.
    """

    task: str
    agent: str
    method: str
    setting: str
    n: int
    successes: int
    low: float | None
    high: float | None
    scr: float | None
    seconds: float | None
    ipl: float | None
    fpl: float | None
    crashed: int
    infrastructure: int

    @property
    def tsr(self) -> float | None:
        """Task success rate."""
        return self.successes / self.n if self.n else None


def wilson(successes: int, n: int) -> tuple[float, float]:
    """Wilson's 95% interval of a rate.

    Raises:
        ValueError: if n is not positive, or successes are not in 0..n.
    """
    if n <= 0 or not 0 <= successes <= n:
        raise ValueError(f"{successes} successes of {n} are not valid; valid: 0..n of n > 0")
    rate, squared = successes / n, Z_95**2
    middle = (rate + squared / (2 * n)) / (1 + squared / n)
    half = Z_95 / (1 + squared / n) * math.sqrt(rate * (1 - rate) / n + squared / (4 * n * n))
    # At the ends the exact bound is 0 or 1; rounding must not put it a hair inside or outside.
    return (0.0 if successes == 0 else middle - half), (1.0 if successes == n else middle + half)


def summarise(records: Iterable[Record]) -> list[Row]:
    """One row for each task, agent and setting, in the order of tasks and methods, unknown ones last."""
    groups: dict[tuple[str, str, str], list[Record]] = {}
    for record in records:
        groups.setdefault((record.task, record.agent, setting(record)), []).append(record)
    rows = [_row(key, group) for key, group in groups.items()]
    return sorted(rows, key=_rank)


def setting(record: Record) -> str:
    """Backend, starts and whatever else makes an episode harder or easier, but not its cell and seed."""
    kitchen = dict(record.options.get("kitchen", {}))
    parts = [record.backend, f"{record.starts} starts"]
    skipped = ("backend", "starts", "style", "layout", "robots", "render_mode", "image_size")
    defaults: dict[str, Any] = {name: f.default for name, f in Options.__dataclass_fields__.items()}
    changed = {n: v for n, v in kitchen.items() if n not in skipped and n in defaults and v != defaults[n]}
    return ", ".join([*parts, *(f"{name}={value}" for name, value in sorted(changed.items()))])


def _row(key: tuple[str, str, str], group: Sequence[Record]) -> Row:
    task, agent, where = key
    scored = [record for record in group if record.scored]
    won = [record for record in scored if record.success]
    finished = {record.job for record in scored}
    broken = {record.job for record in group if record.infrastructure_error} - finished
    low, high = wilson(len(won), len(scored)) if scored else (None, None)
    planned = [record for record in scored if record.final_plan_length is not None]
    length = sum(record.final_plan_length or 0 for record in planned)
    return Row(
        task=task,
        agent=agent,
        method=group[0].method,
        setting=where,
        n=len(scored),
        successes=len(won),
        low=low,
        high=high,
        scr=sum(record.subtasks_done for record in planned) / length if length else None,
        seconds=_mean([record.sim_seconds for record in won]),
        ipl=_mean([record.initial_plan_length for record in won]),
        fpl=_mean([record.final_plan_length for record in won]),
        crashed=sum(record.error is not None for record in scored),
        infrastructure=len(broken),
    )


def _mean(values: Sequence[float | None]) -> float | None:
    """The mean of what is there; the sum is exact, so that the order of the records does not matter."""
    known = [value for value in values if value is not None]
    return math.fsum(known) / len(known) if known else None


def _rank(row: Row) -> tuple[Any, ...]:
    import remac_env
    from remac_bench import agents

    tasks, methods = remac_env.tasks(), agents.methods()
    task = tasks.index(row.task) if row.task in tasks else len(tasks)
    method = methods.index(row.method) if row.method in methods else len(methods)
    return (row.setting, task, row.task, method, row.agent)
