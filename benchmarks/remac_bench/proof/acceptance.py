"""Acceptance: a submission is played again as a whole, and either gets its rows or the reasons why not."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from remac_bench.errors import UsageError
from remac_bench.metrics import Row, overall, summarise
from remac_bench.playing.agents import Access, asked_models
from remac_bench.playing.code import code_digest
from remac_bench.playing.job_lists import check_jobs
from remac_bench.playing.worker import Work, play_job
from remac_bench.proof.again import read_job
from remac_bench.proof.seal import is_sealed, seal
from remac_bench.proof.submission import (
    CASSETTE,
    PROVIDERS,
    Entry,
    agents_of,
    changed_files,
    read_entry,
    refused,
    submission_digest,
)
from remac_bench.proof.verify import verify
from remac_bench.records import Record
from remac_bench.store import Store
from remac_env.files import prepare_file, read_text
from remac_env.seeding import generator

ACCEPTED = "accepted.toml"
"""Written by who accepts, into the submission's folder; one that came along is thrown away first."""


@dataclass(frozen=True)
class Reasked:
    """Jobs that were asked anew, without the cassette: how many, and successes then and now."""

    jobs: int
    before: int
    now: int


@dataclass(frozen=True)
class Acceptance:
    """What became of a submission.

    Attributes:
        entry: what it says of itself.
        reasons: why it is not accepted; none where it is.
        rows: its rows, as tables have them.
        tier: "re-asked" where the models were asked again, else "replayed": the score follows from cassette and code,
            and who wrote the cassette is not proven.
        reasked: of the jobs that were asked again.
    """

    entry: Entry
    reasons: tuple[str, ...]
    rows: tuple[Row, ...] = ()
    tier: str = "replayed"
    reasked: Reasked | None = None


def accept(folder: str | Path, *, reask: int = 0, seed: int = 0, access: Access | None = None) -> Acceptance:
    """Look at a submission's files, play every job again, and note the acceptance beside them.

    Args:
        reask: jobs whose models are asked again.
        seed: of the sample that is asked again.
        access: where: by the addresses and providers that are set here. What a submission says of them would send the
            keys of this machine wherever the entrant likes.

    Raises:
        UsageError: for a folder that is not a submission.
        UnknownNameError, OptionError: where models are to be asked again, and are not known here, or no address is.
        RecordFileError: if its records cannot be read.
    """
    path = Path(folder)
    try:
        (path / ACCEPTED).unlink(missing_ok=True)
    except OSError as error:
        raise UsageError(f"{path / ACCEPTED} cannot be taken away: {error.strerror or error}") from error
    entry = read_entry(path)
    prepare_file(path / ACCEPTED, "the submission")
    reasons = [f"{file}: not as entry.toml lists it" for file in changed_files(path, entry)]
    if reasons:
        return Acceptance(entry, tuple(reasons))
    records = Store(path).read()
    reasons = [*refused(agents_of(records), _providers(path))]
    if reasons:  # nothing that a stranger's records name is run, and nothing else can prove them
        return Acceptance(entry, tuple(reasons))
    reasons += _of_the_whole(entry, records, _providers(path))
    cassette = path / CASSETTE
    verdict = verify(path, cassette=cassette if cassette.is_file() else None, providers=_providers(path))
    reasons += [f"made with {told}" for told in verdict.strange]
    reasons += [f"job {finding.job or '-'}: {finding.told}" for finding in verdict.findings]
    if verdict.replayed:
        reasons.append(
            f"{verdict.replayed} jobs can be played by their subtasks alone: who chose them cannot be asked again"
        )
    if reasons:
        return Acceptance(entry, tuple(dict.fromkeys(reasons)))
    rows = (*summarise(records), *overall(records))
    reasked = _reask(records, reask, seed, access or Access()) if reask else None
    accepted = Acceptance(entry, (), rows, "re-asked" if reasked and reasked.jobs else "replayed", reasked)
    _note(path, accepted)
    return accepted


def accepted_records(folder: str | Path) -> tuple[Entry, str, list[Record]]:
    """An accepted submission: its entry, its tier and its records.

    Raises:
        UsageError: where it was not accepted here and by this code, or was changed since.
    """
    path = Path(folder)
    entry = read_entry(path)
    try:
        noted = tomllib.loads(read_text(path / ACCEPTED))
    except (OSError, tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UsageError(f"{folder} is not accepted: run `remac bench accept {folder}` first") from error
    facts = {name: noted.get(name) for name in ("submission", "tier", "code")}
    if not is_sealed(_text(facts), noted.get("seal")):
        raise UsageError(f"{folder} was not accepted here: run `remac bench accept {folder}` first")
    if facts["submission"] != submission_digest(entry) or changed_files(path, entry):
        raise UsageError(f"{folder} was changed after it was accepted: run `remac bench accept {folder}` again")
    if facts["code"] != code_digest():
        raise UsageError(f"{folder} was accepted by other code: run `remac bench accept {folder}` again")
    return entry, str(facts["tier"]), Store(path).read()


def _text(facts: Mapping[str, object]) -> str:
    return json.dumps(facts, sort_keys=True, default=str)


def _of_the_whole(entry: Entry, records: Sequence[Record], providers: str | None) -> list[str]:
    """What entry.toml and the records must agree on."""
    reasons = []
    if not any(record.scored for record in records):
        reasons.append("no job has a score")
    if not entry.suite:
        reasons.append("its records are of no suite: which jobs are missing cannot be told")
    if entry.code != code_digest():
        reasons.append(f"it was played by code {entry.code or '(unknown)'}, and this is {code_digest()}")
    if entry.kind == "standard" and providers is not None:
        reasons.append("kind: standard, and providers are of the entrant's own making; valid: custom")
    told = {f"{record.suite} {record.suite_version} {record.suite_digest}" for record in records}
    if entry.suite and told != {entry.suite}:
        reasons.append(f"suite: entry.toml says {entry.suite}, the records {', '.join(sorted(told))}")
    asked = {model for agent in agents_of(records) for model in asked_models(agent, providers=providers)}
    if asked != set(entry.models):
        reasons.append(f"models: entry.toml says {sorted(entry.models)}, the records {sorted(asked)}")
    return reasons


def _providers(path: Path) -> str | None:
    return str(path / PROVIDERS) if (path / PROVIDERS).is_file() else None


def _reask(records: Sequence[Record], jobs: int, seed: int, access: Access) -> Reasked:
    """Play a sample of the jobs that ask models anew, with no cassette."""
    scored = [record for record in records if record.scored and asked_models(record.options.get("agent", {}))]
    order = generator(seed, "sample of jobs to ask again").permutation(len(scored))[:jobs]
    chosen = [scored[index] for index in sorted(order)]
    jobs_now = [replace(read_job(record), access=access) for record in chosen]
    check_jobs(jobs_now)  # what is not set here, such as an address, is nobody's failure
    now = 0
    for job in jobs_now:
        again = play_job(Work(job=job, folder="", video="none"))
        if again[-1].infrastructure_error:
            told = "" if again[-1].error is None else again[-1].error.message
            raise UsageError(f"asking again failed, nothing is accepted: {told}")
        now += again[-1].success
    return Reasked(len(chosen), sum(record.success for record in chosen), now)


def _note(path: Path, accepted: Acceptance) -> None:
    facts = {"submission": submission_digest(accepted.entry), "tier": accepted.tier, "code": code_digest()}
    lines = [f"{name} = {json.dumps(value)}" for name, value in {**facts, "seal": seal(_text(facts))}.items()]
    if accepted.reasked is not None:
        told = accepted.reasked
        lines += ["[reasked]", f"jobs = {told.jobs}", f"before = {told.before}", f"now = {told.now}"]
    (path / ACCEPTED).write_text("\n".join([*lines, ""]), "utf-8")
