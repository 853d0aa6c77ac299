"""Re-execution as the proof of records: jobs are played again, and everything that can be compared is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from remac_bench.errors import JobTimeoutError
from remac_bench.playing.machine import versions
from remac_bench.playing.shared import Shared
from remac_bench.proof.again import asks_only_models, check_job, repeatable, searched_best
from remac_bench.proof.complete import NOT_LISTED, check_once, check_scores, check_suite
from remac_bench.proof.rounds import check_rounds
from remac_bench.proof.told import NO_JOB, check_lines, check_told
from remac_bench.records import Record
from remac_bench.store import Store, latest
from remac_env.seeding import generator

UNTOLD = "unknown"
"""The version of what a record does not name."""


@dataclass(frozen=True)
class Finding:
    """What is wrong with a job ("": with the folder): the field with both values, cut short, or what is missing."""

    job: str
    told: str


@dataclass(frozen=True)
class Verification:
    """What re-execution found.

    Attributes:
        jobs, records: how many were played again. `replayed`: jobs whose subtasks alone were played again, because who
            chose them cannot be asked again.
        findings: contradictions.
        strange: versions other than those here on which records were made; there differences in physics prove nothing.
    """

    jobs: int
    records: int
    replayed: int
    findings: tuple[Finding, ...]
    strange: tuple[str, ...]


def verify(
    folder: str | Path,
    *,
    sample: int | None = None,
    seed: int = 0,
    cassette: str | Path | None = None,
    providers: str | None = None,
) -> Verification:
    """Look at all of a folder's records, play a sample of its finished jobs again, and compare.

    An offline agent is run again from its record's options, and so is one that asks models where their answers lie on
    a cassette: every field that the code decides is then compared. Where neither can be, as with a planner from outside
    that may answer otherwise, the recorded subtasks are played again: digest, worlds, outcomes and success are
    compared, and what is told of who chose them has to add up. No code that a record names is imported or run.

    Args:
        sample: number of jobs; None: all.
        seed: of the sample.
        cassette: of the models' answers; None: the file that the records name, if it lies in the folder.
        providers: file of providers that the run was made with.

    Raises:
        RecordFileError: if the records cannot be read.
    """
    lines = Store(folder).lines()
    records = latest(lines)
    impossible = list(check_told(records))
    listed = list(check_suite(records, providers=providers))
    checks = (check_lines(folder), impossible, check_once(lines), check_scores(records), listed)
    findings = [Finding(*told) for check in checks for told in check]
    # These are contradicted already, and could take as long as whoever wrote them likes.
    none = {job for job, told in (*impossible, *listed) if NO_JOB in told or told.startswith(NOT_LISTED)}
    finished = _sampled([rows for rows in _finished(records) if rows[0].job not in none], sample, seed)
    searched = {clock: any(map(searched_best, rows)) for clock, rows in _by_clock(records).items()}
    shared, replayed = Shared(), 0
    for rows in finished:
        best = searched[rows[0].clock]
        played = _cassette(folder, rows[0], cassette)
        slow = any(row.error is not None and row.error.type == JobTimeoutError.__name__ for row in rows)
        if repeatable(rows[0]) and not slow:
            told = check_job(rows, searched=best)
        elif played is not None and asks_only_models(rows[0], providers=providers) and not slow:
            told = check_job(rows, cassette=str(played), providers=providers, shared=shared, searched=best)
        else:
            replayed += 1
            told = check_rounds(rows, searched=best)
        findings += [Finding(rows[0].job, line) for line in told]
    found = tuple(dict.fromkeys(findings))
    return Verification(len(finished), sum(map(len, finished)), replayed, found, strange_versions(records))


def strange_versions(records: Sequence[Record]) -> tuple[str, ...]:
    """Versions, of packages and of the code that decides results, which are not those here."""
    here = versions()
    told = dict.fromkeys(here, UNTOLD)
    others = {(n, value) for row in records for n, value in {**told, **row.versions}.items() if here.get(n) != value}
    return tuple(sorted(f"{name} {value} (here {here.get(name)})" for name, value in others))


def _by_clock(records: Sequence[Record]) -> dict[str, list[Record]]:
    groups: dict[str, list[Record]] = {}
    for record in records:
        groups.setdefault(record.clock, []).append(record)
    return groups


def _finished(records: Sequence[Record]) -> list[list[Record]]:
    """The records of each job that has reached its last iteration."""
    groups: dict[str, list[Record]] = {}
    for record in records:
        groups.setdefault(record.job, []).append(record)
    return [rows for rows in groups.values() if any(_ends(row) for row in rows)]


def _ends(row: Record) -> bool:
    return not row.infrastructure_error and (row.scored or row.iteration == row.options.get("iterations"))


def _sampled(jobs: list[list[Record]], sample: int | None, seed: int) -> list[list[Record]]:
    if sample is None or sample >= len(jobs):
        return jobs
    picked = generator(seed, "sample of jobs to verify").permutation(len(jobs))[:sample]
    return [jobs[index] for index in sorted(picked)]


def _cassette(folder: str | Path, record: Record, given: str | Path | None) -> Path | None:
    """Where the answers of the record's models lie."""
    if given is not None:
        return Path(given)
    name = record.options.get("access", {}).get("cassette")
    path = Path(folder) / Path(str(name)).name
    return path if name and path.is_file() else None
