"""The paper's metrics, computed from records alone (docs/judging.md says what each is, with its formula)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from remac_bench.judging.checkers import checkers_of
from remac_bench.judging.episodes import cap_rounds, cap_seconds, cell, distinct, idle_share, problem, setting
from remac_bench.judging.readers import given_of
from remac_bench.judging.statistics import mean, wilson
from remac_bench.records import Record
from remac_env.oracle import LITTER_ROUNDS

ALL_TASKS = "all tasks"
"""Stands in place of a task's name in a row over all of them."""

Spot = tuple[object, ...]
"""What the episodes of a row share: setting, task, agent and the like."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One agent on one task (or on all) in one setting. None stands where nothing was measured.

    Attributes ending in `_all` (`seconds_all`, `ipl_all`, `fpl_all`, `rounds_all`, `optimum_all`) are free of survivor
    bias: a failure counts with the cap, not at all as a success.

    Attributes:
        setting, task, agent, method, robots: what was played, and by whom.
        checker: who judged its conditions; "" where nobody is asked.
        given: planners, and roles that were chosen, that were given rules or the truth (`judging.readers`).
        tries: episodes that a job has, the scored one included: the agent's budget.
        tasks, cells, problems: how many different ones there are among the scored episodes.
        n, successes: scored episodes, and those in which the goal held at the end.
        low, high: Wilson's 95% interval of the task success rate.
        scr: subtask completion rate: rounds done of the plans in force at the end, over their lengths;
            successes and failures pooled, as the paper's fractions are (70/110). A crash without a plan counts as
            nothing done of a plan of the others' mean length.
        scr_all: mean over all scored episodes of that fraction, 0 where an episode left no plan.
        progress: mean fraction of the goal's parts that hold at the end, over all scored episodes.
        seconds, ipl, fpl, rounds: means over successes: simulated seconds, lengths of the first and the final plan,
            rounds played.
        optimum: rounds played over those of the shortest plan for as many robots, mean over successes; an object that
            was let fall counts as LITTER_ROUNDS more. Episodes whose shortest plan is not known do not count.
        speedup: rounds of the shortest plan for one robot over rounds played, mean over the successes of a team.
        best_speedup: the same for the team's own shortest plan.
        idle: share of the robots' time in which they wait. contacts, near_misses: control steps an episode.
        calls, tokens, money, wall: of a job with all its iterations: calls and tokens of language models, US dollars,
            seconds of the clock on the wall. unpriced: calls whose price is not known, in all; money leaves them
            out, and is None where there are no others.
        crashed: scored episodes that a crash of the agent ended; they are failures.
        infrastructure: jobs without a score because something else broke; the next call runs them again.
    """

    setting: str
    task: str
    agent: str
    method: str
    checker: str
    given: str
    robots: int
    tries: int
    tasks: int
    cells: int
    problems: int
    n: int
    successes: int
    low: float | None
    high: float | None
    scr: float | None
    scr_all: float | None
    progress: float | None
    seconds: float | None
    seconds_all: float | None
    ipl: float | None
    ipl_all: float | None
    fpl: float | None
    fpl_all: float | None
    rounds: float | None
    rounds_all: float | None
    optimum: float | None
    optimum_all: float | None
    speedup: float | None
    best_speedup: float | None
    idle: float | None
    contacts: float | None
    near_misses: float | None
    calls: float | None
    tokens: float | None
    money: float | None
    wall: float | None = field(compare=False)  # no result: two runs of the same jobs have the same rows
    unpriced: int
    crashed: int
    infrastructure: int

    @property
    def tsr(self) -> float | None:
        """Task success rate."""
        return self.successes / self.n if self.n else None


def summarise(records: Iterable[Record]) -> list[Row]:
    """One row for each task, agent and setting, in the order of tasks and methods, unknown ones last."""
    known = distinct(records)
    single = _single_optima(known)
    groups: dict[tuple[str, str, str], list[Record]] = {}
    for record in known:
        groups.setdefault((record.task, record.agent, setting(record)), []).append(record)
    return sorted((_row(key, group, single) for key, group in groups.items()), key=_rank)


def overall(records: Iterable[Record]) -> list[Row]:
    """One row for each agent and setting over all its tasks, episodes pooled; none where a setting has one task."""
    known = distinct(records)
    single = _single_optima(known)
    groups: dict[tuple[str, str], list[Record]] = {}
    tasks: dict[str, set[str]] = {}
    for record in known:
        groups.setdefault((record.agent, setting(record)), []).append(record)
        tasks.setdefault(setting(record), set()).add(record.task)
    rows = [
        _row((ALL_TASKS, agent, where), group, single)
        for (agent, where), group in groups.items()
        if len(tasks[where]) > 1
    ]
    return sorted(rows, key=_rank)


def _row(key: tuple[str, str, str], group: Sequence[Record], single: dict[Spot, int]) -> Row:
    task, agent, where = key
    scored = [record for record in group if record.scored]
    won = [record for record in scored if record.success]
    finished = {record.job for record in scored}
    broken = {record.job for record in group if record.infrastructure_error} - finished
    low, high = wilson(len(won), len(scored)) if scored else (None, None)
    row = Row(
        setting=where,
        task=task,
        agent=agent,
        method=group[0].method,
        checker=checkers_of(group)[agent],
        given=given_of(group)[agent],
        robots=max(record.robots for record in group),
        tries=1 + max(record.iteration for record in group),
        tasks=len({record.task for record in scored}),
        cells=len({cell(record) for record in scored}),
        problems=len({problem(record) for record in scored}),
        n=len(scored),
        successes=len(won),
        low=low,
        high=high,
        idle=mean(idle_share(record) for record in scored),
        contacts=mean(record.robot_contacts for record in scored),
        near_misses=mean(record.near_misses for record in scored),
        crashed=sum(record.error is not None for record in scored),
        infrastructure=len(broken),
        progress=mean(record.progress for record in scored),
        unpriced=sum(record.usage.unpriced for record in group if record.job in finished),
        **dict.fromkeys(_LATER),
    )
    costs = _costs([record for record in group if record.job in finished], len(finished))
    return replace(row, **_completion(scored), **_lengths(scored, won), **_against_best(scored, won, single), **costs)


_LATER: dict[str, Any] = dict.fromkeys(
    ("scr", "scr_all", "seconds", "seconds_all", "ipl", "ipl_all", "fpl", "fpl_all", "rounds", "rounds_all")
    + ("optimum", "optimum_all", "speedup", "best_speedup", "calls", "tokens", "money", "wall")
)
"""Fields of a Row that the functions below fill."""


def _completion(scored: Sequence[Record]) -> dict[str, Any]:
    planned = [record for record in scored if record.final_plan_length is not None]
    # An episode that a crash left without a plan has done nothing of one as long as the others' are.
    crashed = sum(record.error is not None and record.final_plan_length is None for record in scored)
    usual = mean(record.final_plan_length for record in planned) or 0.0
    length = sum(record.final_plan_length or 0 for record in planned) + usual * crashed
    shares = [record.subtasks_done / record.final_plan_length if record.final_plan_length else 0.0 for record in scored]
    return {
        "scr": sum(record.subtasks_done for record in planned) / length if length else None,
        "scr_all": mean(shares),
    }


def _lengths(scored: Sequence[Record], won: Sequence[Record]) -> dict[str, Any]:
    """Means over successes, and over all with failures at the cap; a planner without a first plan has no IPL."""
    has_first = any(record.initial_plan_length is not None for record in scored)

    def capped(name: str) -> float | None:
        return mean(getattr(record, name) if record.success else cap_rounds(record) for record in scored)

    return {
        "seconds": mean(record.sim_seconds for record in won),
        "seconds_all": mean(r.sim_seconds if r.success else cap_seconds(r) for r in scored),
        "ipl": mean(record.initial_plan_length for record in won),
        "ipl_all": capped("initial_plan_length") if has_first else None,
        "fpl": mean(record.final_plan_length for record in won),
        "fpl_all": capped("final_plan_length"),
        "rounds": mean(record.rounds for record in won),
        "rounds_all": capped("rounds"),
    }


def _against_best(scored: Sequence[Record], won: Sequence[Record], single: dict[Spot, int]) -> dict[str, Any]:
    known = [record for record in scored if record.optimum_rounds]
    teams = [record for record in won if record.robots > 1 and record.rounds and _spot(record) in single]
    certified = [record for record in teams if record.optimum_rounds]
    return {
        "optimum": mean(_cost(r) / (r.optimum_rounds or 1) for r in known if r.success),
        "optimum_all": mean((_cost(r) if r.success else cap_rounds(r)) / (r.optimum_rounds or 1) for r in known),
        "speedup": mean(single[_spot(record)] / record.rounds for record in teams),
        "best_speedup": mean(single[_spot(record)] / (record.optimum_rounds or 1) for record in certified),
    }


def _cost(record: Record) -> int:
    """What the oracle would count for what was played: rounds, and more for what fell."""
    return record.rounds + LITTER_ROUNDS * record.littered


def _costs(records: Sequence[Record], jobs: int) -> dict[str, Any]:
    """What a job took, all its iterations together: what was learnt had to be paid for."""
    if not jobs:
        return {}
    spent, unpriced = math.fsum(record.usage.money for record in records), any(r.usage.unpriced for r in records)
    tokens = sum(record.usage.prompt_tokens + record.usage.completion_tokens for record in records)
    return {
        "calls": sum(record.usage.calls for record in records) / jobs,
        "tokens": tokens / jobs,
        "money": None if unpriced and not spent else spent / jobs,
        "wall": math.fsum(record.wall_seconds for record in records) / jobs,
    }


def _single_optima(records: Iterable[Record]) -> dict[Spot, int]:
    """Episode -> rounds of the shortest plan for one robot, where a record of one robot tells it."""
    return {_spot(r): r.optimum_rounds for r in records if r.robots == 1 and r.optimum_rounds}


def _spot(record: Record) -> Spot:
    return (setting(record), *cell(record), record.seed)


def _rank(row: Row) -> tuple[Any, ...]:
    import remac_env
    from remac_bench.playing import agents

    tasks, methods = [*remac_env.tasks(), ALL_TASKS], agents.methods_to_compare()
    task = tasks.index(row.task) if row.task in tasks else len(tasks) - 1.5
    method = methods.index(row.method) if row.method in methods else len(methods)
    return (row.setting, task, row.task, method, row.agent)
