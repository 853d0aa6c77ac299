"""The board of accepted submissions: their records together, each row under its submission's name."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from remac_bench.errors import UsageError
from remac_bench.playing.suites import load
from remac_bench.proof.acceptance import accepted_records
from remac_bench.proof.again import read_job
from remac_bench.proof.submission import looks
from remac_bench.records import Record
from remac_bench.store import Store
from remac_env.files import prepare_folder


def gather(folders: Sequence[str | Path], out: str | Path) -> Path:
    """Write the records of accepted submissions into a new folder, of which tables and pages are made; returns it.

    A suite's floors are the same in every submission and stand there once, under their own names.

    Raises:
        UsageError: where a submission is not accepted, was changed since, plays another suite than the first, or
            looks like another by its name.
    """
    target = Path(out)
    if target.is_dir() and any(target.iterdir()):
        raise UsageError(f"{str(target)!r} is not empty; give a new folder")
    gathered: dict[tuple[str, int], Record] = {}
    suites: set[str] = set()
    names: dict[str, str] = {}
    for folder in folders:
        entry, tier, records = accepted_records(folder)
        suites.add(entry.suite)
        if len(suites) > 1:
            raise UsageError(f"{folder} plays suite {entry.suite}; a board is of one suite: {sorted(suites)}")
        if (like := looks(entry.name)) in names:
            raise UsageError(f"{folder}: a name like {entry.name!r} stands there already, of {names[like]}")
        names[like] = str(folder)
        for record in records:
            floor = _is_floor(record)
            key = record.job if floor else f"{record.job}:{entry.name}"
            label = record.agent if floor else f"{entry.name}: {record.agent} ({tier}, {entry.kind})"
            gathered[key, record.iteration] = record.model_copy(update={"job": key, "agent": label})
    prepare_folder(target, "--out")
    Store(target).append(list(gathered.values()))
    return target


def _is_floor(record: Record) -> bool:
    return load(str(record.suite)).is_floor(read_job(record).agent)
