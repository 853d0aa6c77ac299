"""How agents change from iteration to iteration of their jobs."""

from __future__ import annotations

from collections.abc import Sequence

from remac_bench.board import Column, Sheet
from remac_bench.judging.cells import Cells, count, number, only_known, percent, rate, word
from remac_bench.judging.episodes import setting
from remac_bench.judging.statistics import mean
from remac_bench.metrics import ALL_TASKS
from remac_bench.records import Record

COLUMNS = (
    Column(key="task", title="Task", numeric=False),
    Column(key="agent", title="Method", numeric=False),
    Column(key="iteration", title="Iteration"),
    Column(key="n", title="n", help="jobs with a score"),
    Column(key="tsr", title="Success", help="with Wilson's 95% interval"),
    Column(key="ipl", title="IPL", help="rounds of the first plan, mean over successes"),
    Column(key="fpl", title="FPL", help="rounds of the final plan, mean over successes"),
    Column(key="rounds", title="Rounds", help="mean over successes"),
    Column(key="seconds", title="Time s", help="simulated, mean over successes"),
    Column(key="adjusted", title="Adjusted", help="episodes in which the plan was changed on the way"),
    Column(key="retries", title="Retries", help="mean over all"),
    Column(key="alarms", title="Alarms", help="pre-conditions found false, mean over all"),
    Column(key="tokens", title="Tokens", help="mean over all"),
)


def evolution_sheets(records: Sequence[Record], *, folder: str) -> list[Sheet]:
    """One sheet for each setting in which a job has more than one iteration; jobs without a score are left out."""
    finished = {record.job for record in records if record.scored}
    several = {record.job for record in records if record.iteration > 0}
    kept = [record for record in records if record.job in finished & several]
    settings = sorted({setting(record) for record in kept})
    return [
        _sheet(
            where,
            [record for record in kept if setting(record) == where],
            key="evolution" if len(settings) == 1 else f"evolution-{index}",
            folder=folder,
        )
        for index, where in enumerate(settings, start=1)
    ]


def _sheet(where: str, records: Sequence[Record], *, key: str, folder: str) -> Sheet:
    tasks = sorted({record.task for record in records})
    groups: dict[tuple[str, str, int], list[Record]] = {}
    for record in records:
        for task in (record.task, *((ALL_TASKS,) if len(tasks) > 1 else ())):
            groups.setdefault((task, record.agent, record.iteration), []).append(record)
    order = sorted(groups, key=lambda key: (key[0] == ALL_TASKS, *key))
    return Sheet(
        key=key,
        title=f"Evolution: {where}",
        caption="Every iteration of a job plays the same episode; only the last one is scored.",
        command=f"remac bench report {folder} --all",
        columns=COLUMNS,
        rows=tuple(_cells(task, agent, at, groups[task, agent, at]) for task, agent, at in order),
        facts=tuple(
            {"task": task, "agent": agent, "method": groups[task, agent, at][0].method, "setting": where}
            for task, agent, at in order
        ),
    )


def _cells(task: str, agent: str, iteration: int, group: Sequence[Record]) -> Cells:
    won = [record for record in group if record.success]
    return only_known(
        {
            "task": word(task),
            "agent": word(agent),
            "iteration": count(iteration),
            "n": count(len(group)),
            "tsr": rate(len(won), len(group)),
            "ipl": number(mean(record.initial_plan_length for record in won)),
            "fpl": number(mean(record.final_plan_length for record in won)),
            "rounds": number(mean(record.rounds for record in won)),
            "seconds": number(mean(record.sim_seconds for record in won)),
            "adjusted": percent(mean(float(record.adjusted) for record in group)),
            "retries": number(mean(record.retries for record in group)),
            "alarms": number(mean(_alarms(record) for record in group)),
            "tokens": number(mean(r.usage.prompt_tokens + r.usage.completion_tokens for r in group), 0),
        }
    )


def _alarms(record: Record) -> int:
    return sum(check.verdict is False and not check.asked for check in record.pre_checks)
