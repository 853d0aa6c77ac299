"""Every field of a record, forged in turn: `verify` finds it, or a list says that it cannot be proven."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import pytest
from remac_bench.playing.jobs import Job
from remac_bench.playing.worker import Work, play_job
from remac_bench.proof import again, rounds
from remac_bench.proof.complete import check_scores, check_suite
from remac_bench.proof.rounds import AS_TOLD, check_rounds
from remac_bench.records import CheckEntry, ErrorEntry, ExchangeEntry, OrderEntry, Record, SpanEntry

from remac_env.options import Options

EMPTY = {
    "reflections": "be careful",
    "truth_readers": "checker",
    "rule_readers": "planner",
    "planner_errors": "none of mine",
    "adaptations": "max_tokens -> none",
    "orders": {"robot_0": OrderEntry(command="wait")},
    "timeline": SpanEntry(who="robot_0", kind="wait", what="wait", began=0.0, ended=1.0),
    "exchanges": ExchangeEntry(round=0, role="planner", tokens=7),
    "pre_checks": CheckEntry(round=0, robot="robot_0", subtask="wait", condition="x", verdict=True),
    "post_checks": CheckEntry(round=0, robot="robot_0", subtask="wait", condition="x", verdict=True),
}
"""What is forged into a list that is empty."""


def otherwise(record: Record, name: str) -> Any:
    """Another value for a field, of the same type where that can be."""
    value = getattr(record, name)
    if name == "usage":
        return value.model_copy(update={"prompt_tokens": value.prompt_tokens + 1})
    if name == "error":
        return ErrorEntry(kind="agent", type="ValueError", message="mine")
    if name in ("pre_checks", "post_checks") and value:
        return [value[0].model_copy(update={"truth": not value[0].truth}), *value[1:]]
    if isinstance(value, bool):
        return not value
    if isinstance(value, int | float):
        return value + 1
    if isinstance(value, list):
        return value[:-1] if value else [EMPTY[name]]
    if isinstance(value, dict):
        new: dict[str, Any] = {
            "phases": {"washed": True}, "skills": {"pick up": "0" * 64}, "weights": {"checker": "0" * 64},
            "skill_cases": {"pick up": ["food on surface"]},
        }  # fmt: skip
        return dict(list(value.items())[:-1]) if value else new[name]
    if value is None and name not in ("suite", "suite_digest", "optimum_proof", "body", "body_digest"):
        return True if name == "isolated" else 1
    return "other"


def forged(record: Record, name: str) -> Record:
    """The record with one field set otherwise."""
    value = otherwise(record, name)
    if isinstance(value, list):  # as a file would give it
        value = [entry.model_dump() if hasattr(entry, "model_dump") else entry for entry in value]
        value = type(record).model_validate({**record.model_dump(), name: value}).__getattribute__(name)
    return record.model_copy(update={name: value})


def play(job: Job) -> list[Record]:
    return play_job(Work(job=job, folder="", video="none", optimum=True))


def once(call: Callable[..., Any], *, by_job: bool) -> Callable[..., Any]:
    """The same, computed once: for each job, or for the one start that is looked at."""
    found: dict[str, Any] = {}

    def cached(*args: Any) -> Any:
        key = repr(args[0]) if by_job else ""
        if key not in found:
            found[key] = call(*args)
        return found[key]

    return cached


@pytest.fixture(scope="module", params=["rounds", pytest.param("events", marks=pytest.mark.long)])
def honest(request: pytest.FixtureRequest) -> Iterator[list[Record]]:
    """The records of one job by each clock. What is played again for one forgery serves for the others."""
    timed = {"clock": "events", "think": "fixed:2"} if request.param == "events" else {}
    method = "BASE" if timed else "RE"
    options = Options(backend="symbolic", robots=2 if timed else 1, starts="mixed", **timed)  # type: ignore[arg-type]
    records = play(Job(method=method, task="OpenCabinetPnP", seed=3, options=options, iterations=0 if timed else 1))
    patch = pytest.MonkeyPatch()
    for module, name in ((again, "play_job"), (rounds, "certify"), (rounds, "shortest")):
        patch.setattr(module, name, once(getattr(module, name), by_job=name == "play_job"))
    yield records
    patch.undo()


FIELDS = [name for name in Record.model_fields if name not in again.NOT_PROVEN]


def findings(records: list[Record], *, chosen: bool) -> list[Any]:
    """What is found by playing the job again, or, where who chose the subtasks is unknown, by playing these again."""
    told: list[Any] = [*check_scores(records), *check_suite(records)]
    return [*told, *(again.check_job(records) if chosen else check_rounds(records))]


def test_honest_records_are_as_told(honest: list[Record]) -> None:
    assert findings(honest, chosen=True) == [] and findings(honest, chosen=False) == []


@pytest.mark.parametrize("name", FIELDS)
def test_a_forged_field_is_found_by_playing_the_job_again(honest: list[Record], name: str) -> None:
    changed = forged(honest[-1], name)
    assert changed != honest[-1], "this forgery changes nothing"
    assert findings([*honest[:-1], changed], chosen=True), name


@pytest.mark.parametrize("name", [name for name in FIELDS if name not in AS_TOLD])
def test_a_forged_field_is_found_by_playing_the_subtasks_again(honest: list[Record], name: str) -> None:
    changed = forged(honest[-1], name)
    assert findings([*honest[:-1], changed], chosen=False), name


@pytest.mark.parametrize(
    "changes",
    [
        {"initial_plan_length": 1},
        {"final_plan_length": 99},
        {"subtasks_done": 99},
        {"retries": 99},
        {"usage": {"money": 0.1}},
        {"usage": {"calls": 3}},
        {"exchanges": [{"round": 0, "role": "planner", "tokens": 7}]},
    ],
    ids=str,
)
def test_what_is_taken_as_told_has_to_add_up(honest: list[Record], changes: dict[str, Any]) -> None:
    changed = Record.model_validate({**honest[-1].model_dump(), **changes})
    assert findings([*honest[:-1], changed], chosen=False)


@pytest.mark.parametrize("change", [{"verdict": None}, {"robot": "robot_7"}])
def test_checks_of_a_checker_that_knows_are_the_truth_about_robots_that_are_there(
    honest: list[Record], change: dict[str, Any]
) -> None:
    record = next(record for record in honest if record.pre_checks)
    checks = [record.pre_checks[0].model_copy(update=change), *record.pre_checks[1:]]
    changed = [one.model_copy(update={"pre_checks": checks}) if one is record else one for one in honest]
    assert findings(changed, chosen=False)


def test_a_model_that_planned_was_asked() -> None:
    """Else anybody's subtasks could go by the name of a model."""
    job = Job(method="BASE", task="OpenCabinetPnP", seed=3, options=Options(backend="symbolic"))
    named = replace(job, agent={"planner": "custom:m"})
    options = {**named.facts}
    records = [one.model_copy(update={"options": options, "job": named.key, "agent": named.label}) for one in play(job)]
    assert any("was asked nothing" in told for told in check_rounds(records))


def test_a_check_stands_at_the_decision_point_at_which_it_was_made() -> None:
    """By the event clock robots think and work in steps in which nobody decides: these count too."""
    timed = Options(backend="symbolic", robots=2, clock="events", think="fixed:2")
    records = play(Job(method="REMAC", task="OpenCabinetPnP", seed=3, options=timed))
    silent = [number for number, orders in enumerate(records[0].orders) if not orders]
    assert silent and any(check.round > silent[0] for check in records[0].pre_checks)
    assert list(check_rounds(records)) == []


def test_a_crash_that_is_hushed_up_is_found() -> None:
    crash = {"planner": "bench_planners:Crashes"}
    records = play(Job(method="BASE", task="OpenCabinetPnP", seed=3, options=Options(backend="symbolic"), agent=crash))
    assert records[-1].error is not None
    changed = records[-1].model_copy(update={"error": None, "digest": records[-1].digest or "0"})
    assert findings([changed], chosen=False)
