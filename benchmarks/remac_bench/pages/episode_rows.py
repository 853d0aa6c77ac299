"""The leaderboard's list of episodes: what each row shows, and the facts from which the page counts again."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from remac_bench.blame.labels import Blame
from remac_bench.judging.endings import ending
from remac_bench.judging.episodes import cap_seconds, distinct, problem, setting, shared_key
from remac_bench.judging.grades import grade_of
from remac_bench.pages.episode_page import page_name
from remac_bench.records import Record

FILTERS = ("task", "grade", "template", "method", "robots", "starts", "style", "layout", "result", "blame", "setting")
"""Facts of rows that the page can be filtered by."""


@dataclass(frozen=True, kw_only=True)
class EpisodeRow:
    """An episode in the list.

    Attributes:
        page: the file name of its page.
        facts: what it is filtered by, and its agent.
        numbers: name -> number, for the script; what is not known is left out. `episode` and `problem` number what
            entries have in common when they play the same, and `start` the exact start; `done` of `length` rounds.
        counts: whether it is the one record of its job and iteration that tables are made of.
    """

    record: Record
    page: str
    result: str
    blame: str
    facts: Mapping[str, str]
    numbers: Mapping[str, float]
    counts: bool


def episode_rows(records: Sequence[Record], blames: Iterable[Blame] = ()) -> list[EpisodeRow]:
    """The rows of these records, in the order of tasks, agents and seeds."""
    labels = {(blame.job, blame.iteration): blame.label for blame in blames}
    number = _Numbers()
    counted = {id(record) for record in distinct(records)}
    return [
        EpisodeRow(
            record=record,
            page=page_name(record),
            result=ending(record),
            blame=labels.get((record.job, record.iteration), ""),
            facts=_facts(record, labels.get((record.job, record.iteration), "")),
            numbers=_numbers(record, number),
            counts=id(record) in counted,
        )
        for record in sorted(records, key=order)
    ]


class _Numbers:
    """Numbers in place of long texts: the same for the same."""

    def __init__(self) -> None:
        self._known: dict[object, int] = {}

    def of(self, key: object) -> int:
        return self._known.setdefault(key, len(self._known))


def _facts(record: Record, blame: str) -> dict[str, str]:
    facts = {
        "task": record.task,
        "grade": grade_of(record),
        "template": record.template or "",
        "agent": record.agent,
        "method": record.method,
        "robots": str(record.robots),
        "starts": record.starts,
        "style": record.style or "",
        "layout": record.layout or "",
        "result": ending(record),
        "blame": blame,
        "setting": setting(record),
    }
    return {name: fact for name, fact in facts.items() if fact}


def _numbers(record: Record, number: _Numbers) -> dict[str, float]:
    told: dict[str, float | None] = {
        "job": number.of(("job", record.job)),
        "won": int(record.success),
        "scored": int(record.scored),
        "crash": int(record.error is not None),
        "episode": number.of(("episode", setting(record), *shared_key(record))),
        "problem": number.of(("problem", problem(record))),
        "start": None if record.digest is None else number.of(("start", record.digest)),
        "seconds": record.sim_seconds,
        "cap": cap_seconds(record),
        "money": None if record.usage.unpriced and not record.usage.money else record.usage.money,
        "ipl": record.initial_plan_length,
        "fpl": record.final_plan_length,
        "done": record.subtasks_done,
    }
    return {name: value for name, value in told.items() if value is not None}


def order(record: Record) -> tuple[object, ...]:
    """By task, agent and seed."""
    return (record.task, record.agent, record.seed, record.style or "", record.job, record.iteration)
