"""One recorded episode shown again: its subtasks are played as they were recorded, whoever chose them."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path

from remac_bench.errors import UsageError
from remac_bench.proof.again import as_told, compare, read_job
from remac_bench.proof.rounds import PLAYED, play_rounds
from remac_bench.records import Record
from remac_bench.store import Store


@dataclass(frozen=True, kw_only=True)
class Replayed:
    """What came of it: a line for each subtask of each round, and in what it differs from the record."""

    lines: tuple[str, ...]
    differences: tuple[str, ...]


def find(folder: str | Path, job: str, iteration: int | None) -> Record:
    """The record of a job's iteration, by default its last.

    Raises:
        UsageError: where there is none; it names those that there are.
        RecordFileError: if the records cannot be read.
    """
    records = Store(folder).read()
    of_job = {record.iteration: record for record in records if record.job == job}
    if not of_job:
        jobs = list(dict.fromkeys(record.job for record in records))
        told = ", ".join(jobs[:10]) or "none: there are no records"
        raise UsageError(f"job {job!r} is not in {str(folder)!r}; valid: {told}{', ...' * (len(jobs) > 10)}")
    wanted = max(of_job) if iteration is None else iteration
    if wanted not in of_job:
        raise UsageError(f"job {job!r} has no iteration {wanted}; valid: {', '.join(map(str, sorted(of_job)))}")
    return of_job[wanted]


def replay(record: Record, *, video: str | Path | None = None) -> Replayed:
    """Play the recorded subtasks, and film them if a file is given.

    Raises:
        UsageError: for an episode that never began.
        RemacError: for options, or subtasks, that no version knows, and a video that cannot be written.
    """
    import remac_env

    if record.digest is None or not record.outcomes:
        raise UsageError(f"job {record.job!r} has no round in iteration {record.iteration}: nothing can be shown")
    env = remac_env.parallel_env(record.task, **asdict(read_job(record).options))
    try:
        if video is not None:
            env.start_recording()
        again = play_rounds(env, record)
        if video is not None:
            env.save_recording(video)
    finally:
        env.close()
    lines = [
        f"{number}. {robot}: {told['subtask']}: {told['reason'] or told['status']}, {told['seconds']:.1f} s"
        for number, outcomes in enumerate(again["outcomes"], start=1)
        for robot, told in outcomes.items()
    ]
    found = compare(record.iteration, record.model_dump(), as_told(record, again), PLAYED)
    return Replayed(lines=tuple(lines), differences=tuple(found))
