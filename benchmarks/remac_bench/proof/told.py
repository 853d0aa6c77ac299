"""What records tell that playing again cannot prove: it has at least to be what a run could have written."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from remac_bench.playing.settings import Settings
from remac_bench.proof.again import compare, read_job
from remac_bench.records import SCHEMA, Record
from remac_bench.store import VIDEO_PATH, Store
from remac_env.errors import RemacError
from remac_env.option_rows import rows

Told = tuple[str, str]
"""A job's key ("": the folder) and what is wrong with it."""

NO_JOB = "its options make no job"
"""Such records cannot be played again."""

LONGEST = 1e9
"""s on the wall: thirty years. No episode took longer."""

CLOCKS_DIFFER = timedelta(days=1)
"""So far may the clocks of two machines lie apart; what begins later has not begun."""

MACHINE_MAX = 200
"""Characters of what a machine is."""


def check_lines(folder: str | Path) -> Iterator[Told]:
    """Lines that two readers could read differently: a key twice, a number that is none, a field of no record."""
    known = {field.alias or name for name, field in Record.model_fields.items()}
    for number, line in enumerate(Store(folder).raw_lines(), start=1):
        try:
            names = json.loads(line, object_pairs_hook=_once, parse_constant=_no_number)
        except (ValueError, RecursionError) as error:
            yield "", f"line {number}: {error}"
            continue
        if unknown := sorted(set(names) - known):
            yield str(names.get("job", "")), f"line {number}: no record has {', '.join(map(repr, unknown))[:200]}"


def check_told(records: Sequence[Record]) -> Iterator[Told]:
    """Records, of unfinished jobs too, that say what no run can: of times, places, machines, and of their own job."""
    for record in records:
        for told in (*_wrong_words(record), *_wrong_job(record)):
            yield record.job, f"iteration {record.iteration}, {told}"


def _once(pairs: Sequence[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        twice = next(name for index, (name, _) in enumerate(pairs) if name in dict(pairs[:index]))
        raise ValueError(f"{twice!r} stands there twice")
    return found


def _no_number(text: str) -> None:
    raise ValueError(f"{text} is no number")


def _wrong_words(record: Record) -> Iterator[str]:
    if not 1 <= record.schema_version <= SCHEMA:
        yield f"schema: {record.schema_version}; valid: 1 to {SCHEMA}"
    times = {"wall_seconds": [record.wall_seconds], "usage.seconds": [record.usage.seconds]}
    times["exchanges.seconds"] = [exchange.seconds for exchange in record.exchanges]
    if record.video is not None:
        times["video.rounds"] = record.video.rounds
        if record.video.path is not None and not VIDEO_PATH.fullmatch(record.video.path):
            yield f"video.path: {record.video.path[:80]!r} is no video of this folder"
        if len(record.video.rounds) > record.rounds + 1:
            yield f"video.rounds: {len(record.video.rounds)} of {record.rounds}"
    for name, values in times.items():
        if wrong := [value for value in values if not (math.isfinite(value) and 0 <= value <= LONGEST)]:
            yield f"{name}: {wrong[0]} s"
    if record.usage.requests < 0:
        yield f"usage.requests: {record.usage.requests}"
    if len(record.exchanges) == record.usage.calls:
        sent = sum(exchange.requests for exchange in record.exchanges)
        if record.usage.requests not in (0, sent):  # older records do not count them
            yield f"usage.requests: recorded {record.usage.requests}, again {sent}"
    if record.started is not None and not _is_time(record.started):
        yield f"started: {record.started[:80]!r} is no time; valid: UTC, ISO 8601 to the second, and over"
    if record.machine is not None and not (record.machine.isprintable() and len(record.machine) <= MACHINE_MAX):
        yield f"machine: {record.machine[:80]!r}"
    try:
        rows(Settings)["job_seconds"].check("job_seconds", record.options.get("job_seconds"))
    except RemacError as error:
        yield f"options: {error}"


def _is_time(text: str) -> bool:
    try:
        told = datetime.fromisoformat(text)
        past = told.tzinfo is not None and told <= datetime.now(UTC) + CLOCKS_DIFFER
        return past and told.isoformat(timespec="seconds") == text and text.endswith("+00:00")
    except ValueError:
        return False


def _wrong_job(record: Record) -> Iterator[str]:
    """A record's name and setting against its own options, whether the job was finished or not."""
    try:
        job = read_job(record)
        expected = {
            "job": job.key,
            "agent": job.label,
            "backend": job.options.backend,
            "starts": job.options.starts,
            "robots": job.options.robots,
            "clock": job.options.clock,
        }
    except (RemacError, TypeError, KeyError, ValueError) as error:
        yield f"{NO_JOB}: {error}"
        return
    if not 0 <= record.iteration <= job.iterations:
        yield f"its job has iterations 0 to {job.iterations}"
    told = compare(record.iteration, record.model_dump(include=set(expected)), expected, list(expected))
    yield from (line.partition(", ")[2] for line in told)
