"""Whether a folder holds what was to be played, all of it and nothing else, each job once."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from remac_bench.errors import UsageError
from remac_bench.playing import agents, sight
from remac_bench.playing.agents import Access
from remac_bench.playing.jobs import Job
from remac_bench.playing.suites import Suite, load, names
from remac_bench.proof.again import outsiders, read_job
from remac_bench.records import Record
from remac_env.errors import RemacError

NOT_LISTED = "not on the list of suite"
"""Such jobs are not played again."""

Told = tuple[str, str]
"""A job's key and what is wrong with it."""


def check_once(lines: Iterable[Record]) -> Iterator[Told]:
    """Jobs that were played again after they had a score. `lines`: every record in the order of writing."""
    scored: set[str] = set()
    told: set[str] = set()
    for record in lines:
        if record.job in scored and record.job not in told:
            told.add(record.job)
            yield record.job, "recorded again after it had a score"
        if record.scored:
            scored.add(record.job)


def check_scores(records: Sequence[Record]) -> Iterator[Told]:
    """Jobs whose last iteration is there and hides its score, or the other way round."""
    for record in records:
        last = record.iteration == record.options.get("iterations")
        counts = last and not record.infrastructure_error
        if record.scored != counts:
            yield record.job, f"iteration {record.iteration}, scored: recorded {record.scored}, again {counts}"


def check_suite(records: Sequence[Record], *, providers: str | None = None) -> Iterator[Told]:
    """Records of a suite against its frozen list: the same suite, no job missing, none that is not on the list.

    Args:
        providers: file of providers that the run was made with.
    """
    marks = {(record.suite, record.suite_version, record.suite_digest) for record in records}
    if marks <= {(None, None, None)}:
        return
    if len(marks) > 1 or None in next(iter(marks)):
        yield "", f"records of different suites: {sorted(map(str, marks))}"
        return
    ((name, version, digest),) = marks
    if name not in names():
        yield "", f"suite {name!r} is not here; valid: {', '.join(names())}, or its file (--suite FILE.toml)"
        return
    suite = load(str(name))
    if (suite.version, suite.digest) != (version, digest):
        yield "", f"suite {name} {version} ({digest}) is not the one here: {suite.version} ({suite.digest})"
        return
    yield from _check_list(suite, records, providers)


def _check_list(suite: Suite, records: Sequence[Record], providers: str | None) -> Iterator[Told]:
    first = {record.job: record for record in records}
    scored = {record.job for record in records if record.scored}
    try:
        jobs = {key: read_job(record) for key, record in first.items()}
        expected = {job.key: job for job in _listed(suite, list(jobs.values()), providers)}
    except (RemacError, UsageError, TypeError, KeyError, ValueError) as error:
        yield "", f"its options make no job of suite {suite.name}: {error}"
        return
    for key in first:
        if key not in expected:
            yield key, f"{NOT_LISTED} {suite.name}"
    for key, job in expected.items():
        if key not in scored:
            yield key, f"no score of {job.label}, {job.task}, seed {job.seed}, which suite {suite.name} plays"


def _listed(suite: Suite, jobs: Sequence[Job], providers: str | None) -> list[Job]:
    """The jobs of the suite for the entries that these records are of."""
    backends = {job.options.backend for job in jobs}
    own = {job.options.backend for job in suite.jobs()}
    backend = next(iter(backends)) if len(backends) == 1 and backends != own else None
    entries: dict[str, tuple[dict[str, Any], Access]] = {}
    viewers: dict[str, dict[str, tuple[str, ...]]] = {}
    for job in jobs:
        given: Mapping[str, Any] = {} if job.suite is None else job.suite.given
        entry = {name: value for name, value in job.agent.items() if given.get(name) != value}
        if not suite.is_floor(entry):
            access = Access(base_url=job.access.base_url, providers=providers)
            entries[_text(entry)] = entry, access
            if outsiders(entry, providers=providers):  # they are not asked what they look at: that would run them
                viewers.setdefault(_text(entry), {})[job.method] = job.viewers
    if not entries:
        return suite.jobs(backend=backend)
    named = [(entry, access) for entry, access in entries.values() if not _follows(entry, access, entries)]
    return [
        job
        for entry, access in named
        for job in suite.jobs([entry], backend=backend, access=access, viewers=viewers.get(_text(entry)))
    ]


def _text(entry: Mapping[str, Any]) -> str:
    return json.dumps(entry, sort_keys=True, default=str)


def _follows(entry: Mapping[str, Any], access: Access, entries: Mapping[str, Any]) -> bool:
    """Whether an entry is another one of these in the methods that check, where who checks follows from the model."""
    base = {name: value for name, value in entry.items() if name != "checker"}
    if len(base) == len(entry) or _text(base) not in entries:
        return False
    checking = next(method for method in agents.methods() if sight.checks(method))
    return sight.with_checker(checking, base, access) == dict(entry)
