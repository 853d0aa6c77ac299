"""What records tell that playing again cannot prove: it has at least to be what a run could have written."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from remac_bench.playing.settings import Settings
from remac_bench.proof.again import compare, of_this_code, read_job
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

ROUNDED = 1e-3
"""s by which a time in a record may differ from what it was."""

MACHINE_MAX = 200
"""Characters of what a machine is."""


def check_lines(folder: str | Path) -> Iterator[Told]:
    """Lines that two readers could read differently: a key twice, a number that is none, a field of no record, a text
    that stands for a number. A line of this code has all the fields that this code writes."""
    for number, line in enumerate(Store(folder).raw_lines(), start=1):
        try:
            stands = json.loads(line, object_pairs_hook=_once, parse_constant=_no_number)
            record = Record.model_validate_json(line)
            told = _unlike(stands, json.loads(record.line()), whole=of_this_code(record))
        except (ValueError, RecursionError) as error:
            yield "", f"line {number}: {str(error)[:200]}"
            continue
        yield from ((record.job, f"line {number}: {each}") for each in told)


def check_told(records: Sequence[Record]) -> Iterator[Told]:
    """Records, of unfinished jobs too, that say what no run can: of times, places, machines, and of their own job."""
    for record in records:
        for told in (*_wrong_words(record), *_wrong_job(record)):
            yield record.job, f"iteration {record.iteration}, {told}"


def _unlike(stands: Any, written: Any, *, whole: bool, where: str = "") -> Iterator[str]:
    """In what a line differs from what its record is written as; `whole`: nothing may be left out."""
    if isinstance(stands, dict) and isinstance(written, dict):
        if unknown := sorted(set(stands) - set(written)):
            yield f"no record has {', '.join(repr(f'{where}{name}') for name in unknown)[:200]}"
        if whole and (missing := sorted(set(written) - set(stands))):
            yield f"{', '.join(f'{where}{name}' for name in missing)[:200]} left out"
        for name in stands.keys() & written.keys():
            yield from _unlike(stands[name], written[name], whole=whole, where=f"{where}{name}.")
    elif isinstance(stands, list) and isinstance(written, list) and len(stands) == len(written):
        for number, (one, other) in enumerate(zip(stands, written, strict=True)):
            yield from _unlike(one, other, whole=whole, where=f"{where}{number}.")
    elif type(stands) is not type(written) or stands != written:
        yield f"{where.rstrip('.')}: {json.dumps(stands)[:80]} stands for {json.dumps(written)[:80]}"


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
        if len(record.video.rounds) > record.rounds + 1 or record.video.rounds != sorted(record.video.rounds):
            yield f"video.rounds: {len(record.video.rounds)} of {record.rounds}, or not one after the other"
    for name, values in times.items():
        if wrong := [value for value in values if not (math.isfinite(value) and 0 <= value <= LONGEST)]:
            yield f"{name}: {wrong[0]} s"
    yield from _wrong_sums(record)
    older = not of_this_code(record)
    if not (older and record.started is None) and not _is_time(record.started or "", record.wall_seconds):
        yield f"started: {(record.started or '')[:80]!r} is no time; valid: UTC, ISO 8601 to the second, and over"
    named = record.machine or ""
    if not (older and record.machine is None) and not (named.isprintable() and 0 < len(named) <= MACHINE_MAX):
        yield f"machine: {named[:80]!r}"
    try:
        rows(Settings)["job_seconds"].check("job_seconds", record.options.get("job_seconds"))
    except RemacError as error:
        yield f"options: {error}"


def _wrong_sums(record: Record) -> Iterator[str]:
    """What was sent, and how long it took, against the exchanges it is of, where all of these are there."""
    if record.usage.requests < 0:
        yield f"usage.requests: {record.usage.requests}"
    if len(record.exchanges) != record.usage.calls:
        return
    sent = sum(exchange.requests for exchange in record.exchanges)
    if record.usage.requests != sent and (record.usage.requests or of_this_code(record)):  # older ones do not count
        yield f"usage.requests: recorded {record.usage.requests}, again {sent}"
    took = sum(exchange.seconds for exchange in record.exchanges)
    if abs(record.usage.seconds - took) > ROUNDED * (1 + len(record.exchanges)):
        yield f"usage.seconds: recorded {record.usage.seconds}, {took} in its exchanges"


def _is_time(text: str, wall: float) -> bool:
    """Whether it is a time at which something could begin that has taken so long, s."""
    try:
        told = datetime.fromisoformat(text)
        past = told.tzinfo is not None and told + timedelta(seconds=wall) <= datetime.now(UTC) + CLOCKS_DIFFER
        return past and told.isoformat(timespec="seconds") == text and text.endswith("+00:00")
    except (ValueError, OverflowError):
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
