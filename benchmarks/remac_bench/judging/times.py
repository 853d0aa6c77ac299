"""Time under the event clock: makespans, what robots do with it, and what it is beside the same agent in rounds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from remac_bench.board import Column, Sheet
from remac_bench.judging.cells import Cells, count, number, only_known, percent, rate, word
from remac_bench.judging.episodes import by_events, setting, share_of, shared_key
from remac_bench.judging.statistics import mean
from remac_bench.records import Record
from remac_env.tasks import get, timed

COLUMNS: tuple[Column, ...] = (
    Column(key="setting", title="Setting", numeric=False),
    Column(key="task", title="Task", numeric=False),
    Column(key="agent", title="Method", numeric=False, help="method, in brackets where it departs from its defaults"),
    Column(key="asks", title="Asked", numeric=False, help="robot by robot when each is ready, or all in step"),
    Column(key="n", title="n", help="scored episodes"),
    Column(key="tsr", title="TSR", help="task success rate: the goal holds at the end"),
    Column(key="seconds", title="Makespan s", help="simulated seconds until the goal, mean over successes"),
    Column(key="best", title="/best", help="makespan over the shortest one, mean over successes where that is known"),
    Column(key="rounds", title="In rounds s", help="the same agent's successes on the same starts with rounds"),
    Column(key="idle", title="Idle", help="share of the robots' time in which they wait"),
    Column(key="thinking", title="Thinking", help="share of the robots' time in which they think"),
    Column(key="met", title="In time", help="of episodes with a deadline, or things that can be too late: successes"),
)

CAPTION = (
    "Episodes by the event clock. Methods that plan in rounds are asked in step: whoever has ended early waits. "
    "Makespans are comparable within a setting; what thinking costs is part of it."
)


THINKING: tuple[Column, ...] = (
    Column(key="setting", title="Setting", numeric=False),
    Column(key="agent", title="Method", numeric=False, help="method, in brackets where it departs from its defaults"),
    Column(key="think", title="Thinking", numeric=False, help="what a command costs on the kitchen's clock"),
    Column(key="n", title="n", help="scored episodes"),
    Column(key="tsr", title="TSR", help="task success rate: the goal holds at the end"),
    Column(key="seconds", title="Makespan s", help="simulated seconds until the goal, mean over successes"),
    Column(key="saves", title="Saves s", help="by how much sooner the same starts are done than with rounds, mean"),
    Column(key="costs", title="Costs s", help="by how much later the same starts are done than without thinking, mean"),
    Column(key="late", title="Too late", help="of the starts that are done without thinking: those that are not"),
)

_TIME = ("clock", "think", "max_seconds")
"""Options of which time is told."""


def time_sheets(records: Sequence[Record], *, folder: str) -> list[Sheet]:
    """The table, where an episode was played by the event clock."""
    played = [record for record in records if record.scored and record.clock == "events"]
    if not played:
        return []
    rounds = [record for record in records if record.scored and record.clock == "rounds" and record.success]
    groups: dict[tuple[str, str, str], list[Record]] = {}
    for record in played:
        groups.setdefault((setting(record), record.task, record.agent), []).append(record)
    rows = [_row(key, group, rounds) for key, group in sorted(groups.items())]
    return [
        Sheet(
            key="time",
            title="Time",
            caption=CAPTION,
            command=f"remac bench report {folder} --all",
            columns=COLUMNS,
            rows=tuple(rows),
        ),
        Sheet(
            key="thinking",
            title="Asynchrony and thinking",
            caption="All tasks together, start by start. What is compared succeeded both times.",
            command=f"remac bench report {folder} --all",
            columns=THINKING,
            rows=tuple(_thinking(records)),
        ),
    ]


def _thinking(records: Sequence[Record]) -> Iterator[Cells]:
    """A row for each agent and each cost of thinking."""
    groups: dict[tuple[str, str], dict[tuple[str, str], dict[Start, Record]]] = {}
    for record in records:
        if record.scored:
            kitchen = record.options.get("kitchen", {})
            how = (record.clock, str(kitchen.get("think", "off")))
            mine = groups.setdefault((setting(record, but=_TIME), record.agent), {})
            mine.setdefault(how, {})[shared_key(record), record.iteration] = record
    for (where, agent), played in sorted(groups.items()):
        off, rounds = (played.get((clock, "off"), {}) for clock in ("events", "rounds"))
        for (clock, think), group in sorted(played.items(), key=lambda each: _dear(each[0][1])):
            if clock == "events":
                won = {start for start, record in group.items() if record.success}
                done = [start for start, record in off.items() if start in group and record.success]
                yield only_known(
                    {
                        "setting": word(where),
                        "agent": word(agent),
                        "think": word(think),
                        "n": count(len(group)),
                        "tsr": rate(len(won), len(group)),
                        "seconds": number(mean(group[start].sim_seconds for start in won)),
                        "saves": number(_later(rounds, group) if think == "off" else None),
                        "costs": number(_later(group, off) if think != "off" else None),
                        "late": percent(1 - len(won & set(done)) / len(done) if done and think != "off" else None),
                    }
                )


Start = tuple[tuple[object, ...], int]


def _later(first: Mapping[Start, Record], then: Mapping[Start, Record]) -> float | None:
    """By how many seconds the first ones are done later, mean over the starts that both have done."""
    both = [start for start in first if start in then and first[start].success and then[start].success]
    return mean(first[start].sim_seconds - then[start].sim_seconds for start in both)


def _dear(think: str) -> tuple[str, float]:
    """Costs of thinking in the order of tables."""
    kind, _, figure = think.partition(":")
    return ("" if kind == "off" else kind, float(figure or 0.0))


def _row(key: tuple[str, str, str], group: Sequence[Record], rounds: Iterable[Record]) -> Cells:
    where, task, agent = key
    won = [record for record in group if record.success]
    known = [record.sim_seconds / record.optimum_seconds for record in won if record.optimum_seconds]
    starts = {shared_key(record) for record in group}
    same = [each.sim_seconds for each in rounds if each.agent == agent and shared_key(each) in starts]
    late = task in timed() and _can_be_late(task)
    return only_known(
        {
            "setting": word(where),
            "task": word(task),
            "agent": word(agent),
            "asks": word("when ready" if by_events(group[-1].method) else "in step"),
            "n": count(len(group)),
            "tsr": rate(len(won), len(group)),
            "seconds": number(mean(record.sim_seconds for record in won)),
            "best": number(mean(known), 2),
            "rounds": number(mean(same)),
            "idle": percent(mean(share_of(record, "wait") for record in group)),
            "thinking": percent(mean(share_of(record, "thought") for record in group)),
            "met": percent(len(won) / len(group) if late else None),
        }
    )


def _can_be_late(task: str) -> bool:
    from remac_env.rules.processes import known

    spec = get(task)
    return spec.deadline is not None or any(known()[name].does != "off" for name, _ in spec.processes)
