"""One job played again: every field of its records that the code decides is compared."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

from remac_bench.playing import agents, sight
from remac_bench.playing.agents import Access
from remac_bench.playing.code import code_digest
from remac_bench.playing.extensions import check_body
from remac_bench.playing.jobs import MOST_ITERATIONS, Job, SuiteMark
from remac_bench.playing.shared import Shared
from remac_bench.playing.worker import Work, play_job
from remac_bench.records import Record
from remac_env.errors import RemacError, whole_number
from remac_env.options import Options

NOT_PROVEN = ("wall_seconds", "started", "machine", "video", "versions", "schema_version")
"""Fields of a record that another run of the same job need not repeat; `versions` are compared by themselves.

Every other field is forged in turn by a test, and has to be found.
"""

NOT_PROVEN_INSIDE: Mapping[str, tuple[str, ...]] = {
    "usage": ("seconds", "requests"),
    "exchanges": ("seconds",),
    "error": ("where",),
    "options": ("access",),
}
"""The same for parts of fields: times on the wall, lines of code in an error, and where a cassette lay."""

TIMES = ("began", "ended")
"""Fields of outcomes that records from before 2026-11-30 lack."""


def read_job(record: Record) -> Job:
    """The job that a record belongs to, by the options that the record holds.

    Raises:
        RemacError, TypeError, KeyError: for options that no version knows, and a body that is not known here.
    """
    known = {f.name for f in fields(Options)}
    kitchen = {name: value for name, value in record.options["kitchen"].items() if name in known}
    check_body(kitchen)
    told = record.options.get("access", {})
    job = Job(
        method=record.method,
        task=record.task,
        seed=record.seed,
        options=Options(**kitchen),
        agent=dict(record.options["agent"]),
        iterations=whole_number("iterations", record.options["iterations"], 0, MOST_ITERATIONS),
        access=Access.recorded(told),
        seconds=record.options.get("job_seconds"),
        viewers=tuple(record.options.get("viewers", ())),
    )
    return job if record.suite is None else replace(job, suite=_mark(record, job))


def _mark(record: Record, job: Job) -> SuiteMark:
    """The suite as the record names it; what it gives comes from the suite itself, where it is there."""
    from remac_bench.playing.suites import load, names

    given: Mapping[str, Any] = {}
    if record.suite in names():
        suite = load(str(record.suite))
        given = {} if suite.is_floor(job.agent) else suite.given(job.agent)
    return SuiteMark(
        name=str(record.suite),
        version=record.suite_version or 0,
        digest=record.suite_digest or "",
        given=given,
    )


def repeatable(record: Record) -> bool:
    """Whether the agent answers the same when it is asked again: all of its roles are our own offline ones."""
    agent: Mapping[str, Any] = record.options.get("agent", {})
    return not outsiders(agent) and not agents.asked_models(agent)


def asks_only_models(record: Record, *, providers: str | None = None) -> bool:
    """Whether everyone whom the agent asks is our own or a language model, so that a cassette can play it again.

    Args:
        providers: file of providers that the run was made with.
    """
    return not outsiders(record.options.get("agent", {}), providers=providers)


def outsiders(agent: Mapping[str, Any], *, providers: str | None = None) -> list[str]:
    """The roles of an agent, `role=who`, that neither our own offline ones fill nor language models: code from outside,
    programs, files, addresses and people. Who reads a record asks none of them: it may be a stranger's."""
    from remac_agents.wiring.catalogue import ROLES

    names = [(role, str(agent[role]).partition(",")[0].strip()) for role in agents.ROLES if role in agent]
    return [
        f"{role}={agent[role]}"
        for role, name in names
        if (name not in ROLES[role] or name == agents.PERSON) and not agents.is_model(name, providers)
    ]


def check_job(
    rows: Sequence[Record],
    *,
    cassette: str | None = None,
    providers: str | None = None,
    shared: Shared | None = None,
    searched: bool = False,
) -> Iterator[str]:
    """Play the whole job again, models from the cassette, and compare every field that the code decides.

    Args:
        searched: other records of the folder tell what is shortest, so that these have to.
    """
    try:
        job = read_job(rows[0])
        _ = job.label, job.key  # the method may be none, and a bound no number
    except (RemacError, TypeError, KeyError, ValueError) as error:
        yield f"its options make no job: {error}"
        return
    yield from check_key(rows[0], job)
    if cassette is not None:
        job = replace(job, access=replace(job.access, cassette=cassette, providers=providers, replay=True))
    yield from _check_viewers(job, providers)
    work = Work(job=job, folder="", video="none", optimum=searched or any(map(searched_best, rows)))
    again = {record.iteration: record for record in play_job(work, shared)}
    if set(again) != {row.iteration for row in rows}:
        yield f"iterations: recorded {sorted(row.iteration for row in rows)}, played again {sorted(again)}"
    for row in rows:
        if row.iteration in again:
            yield from differences(row, again[row.iteration])


def _check_viewers(job: Job, providers: str | None) -> Iterator[str]:
    """Whether the roles for which the kitchen had pictures look at any: pictures for nobody are another setting."""
    if not job.viewers:
        return
    looking = sight.viewers(job.method, job.agent, replace(job.access, providers=providers))
    if not set(job.viewers) <= set(looking):
        yield f"viewers: recorded {list(job.viewers)}, again {list(looking)}"


def searched_best(row: Record) -> bool:
    """Whether it was asked what is shortest."""
    return row.optimum_proof is not None or row.optimum_seconds_lower is not None


def of_this_code(record: Record) -> bool:
    """Whether a record says that the code of today made it: then it says all that this code says."""
    return record.versions.get("code") == code_digest()


def differences(row: Record, again: Record) -> Iterator[str]:
    """Every field in which a record differs from the same episode played again."""
    recorded, played = _provable(row), as_told(row, _provable(again))
    yield from compare(row.iteration, recorded, played, [name for name in recorded if name in played])


def _provable(record: Record) -> dict[str, Any]:
    values = record.model_dump(exclude=set(NOT_PROVEN))
    for name, parts in NOT_PROVEN_INSIDE.items():
        for part in values[name] if isinstance(values[name], list) else [values[name]]:
            for key in parts if part else ():
                part.pop(key, None)
    return values


def check_key(row: Record, job: Job) -> Iterator[str]:
    """Whether a record bears the name of the job that its options make."""
    if job.key != row.job:
        yield f"job: its options make job {job.key}, it says {row.job}"


def compare(
    iteration: int, recorded: Mapping[str, Any], again: Mapping[str, Any], names: Sequence[str]
) -> Iterator[str]:
    """The named fields in which what was played again differs from what was recorded."""
    for name in names:
        if recorded[name] != again[name]:
            yield f"iteration {iteration}, {name}: recorded {_short(recorded[name])}, again {_short(again[name])}"


def as_told(row: Record, again: Mapping[str, Any]) -> dict[str, Any]:
    """What was played again, without the times of outcomes that an older record does not tell."""
    if of_this_code(row):
        return dict(again)
    told = list(again["outcomes"])
    for number, (old, new) in enumerate(zip(row.outcomes, again["outcomes"], strict=False)):
        both = old.keys() & new.keys()
        silent = {robot: [key for key in TIMES if getattr(old[robot], key) is None] for robot in both}
        told[number] = {robot: {**entry, **dict.fromkeys(silent.get(robot, ()))} for robot, entry in new.items()}
    return {**again, "outcomes": told}


def _short(value: object) -> str:
    text = str(value)
    return text if len(text) <= 120 else f"{text[:117]}..."
