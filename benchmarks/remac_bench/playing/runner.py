"""Runs jobs and records them: resumable after any kind of end, one runner a folder."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from remac_bench.playing.deadline import job_seconds
from remac_bench.playing.engines import Engine, play_all
from remac_bench.playing.extensions import load_extensions
from remac_bench.playing.jobs import Job
from remac_bench.playing.lock import locked
from remac_bench.playing.recording import VideoMode
from remac_bench.playing.settings import Settings
from remac_bench.playing.watch import Watch
from remac_bench.playing.worker import Work
from remac_bench.records import Record
from remac_bench.store import Store, finished_jobs
from remac_env.files import prepare_file, prepare_folder


class Listener:
    """Is told, in the runner's process, how a run goes; this one takes no notice."""

    def begin(self, jobs: Sequence[Job]) -> None:
        """The folder is ours, and these jobs are to be played."""

    def end(self, job: Job, records: Sequence[Record]) -> None:
        """A job has ended, and its records are on the disk."""

    def slow(self, job: Job, seconds: float) -> None:
        """A job has been running for so long, and still does."""


@dataclass(frozen=True)
class RunSummary:
    """What a call of `run_jobs` did: numbers of jobs, and what the infrastructure errors were."""

    skipped: int
    played: int
    infrastructure: tuple[str, ...]


def run_jobs(
    jobs: Sequence[Job],
    folder: str | Path,
    settings: Settings,
    *,
    listener: Listener | None = None,
) -> RunSummary:
    """Run the jobs that the folder has no finished records of.

    Each job's records are written together at its end, so a job that was broken off is simply run again.

    Args:
        listener: is told how it goes.

    Raises:
        LockedError: if another runner is at work in the folder.
        RecordFileError: if its records cannot be read.
        StorageError: if they cannot be written.
        UsageError: if the folder holds the records of another suite.
        OptionError: if nothing can be written into the folder.
    """
    listener = listener or Listener()
    load_extensions(settings.extensions)
    store = Store(folder)
    prepare_folder(store.folder, "--out")
    prepare_file(store.path, "--out")
    with locked(store.folder):
        if settings.fresh:
            store.clear()
        store.claim(_suite(jobs))
        store.repair()
        done = finished_jobs(store.read())
        works = [work for work in _works(jobs, store.folder, settings) if work.job.key not in done]
        works.sort(key=_effort, reverse=True)
        broken: list[str] = []
        watch = Watch(listener.slow)
        listener.begin([work.job for work in works])
        engine = Engine(name=settings.engine, workers=settings.workers, address=settings.address)
        for work, records in play_all(works, engine=engine, extensions=settings.extensions, watch=watch):
            store.append(records)
            broken += [_problem(record) for record in records if record.infrastructure_error]
            listener.end(work.job, records)
    return RunSummary(len(jobs) - len(works), len(works), tuple(broken))


def pending(jobs: Sequence[Job], folder: str | Path) -> list[Job]:
    """The jobs that `run_jobs` would play."""
    done = finished_jobs(Store(folder).read())
    return [job for job in jobs if job.key not in done]


def _suite(jobs: Sequence[Job]) -> dict[str, object] | None:
    """The suite of these jobs, which all have the same."""
    mark = next((job.suite for job in jobs), None)
    return None if mark is None else mark.fields


def _problem(record: Record) -> str:
    told = "" if record.error is None else f"{record.error.type}: {record.error.message}"
    return f"{record.task}, {record.agent}, seed {record.seed}: {told}"


def _works(jobs: Sequence[Job], folder: Path, settings: Settings) -> list[Work]:
    filmed: set[tuple[str, str]] = set()
    works = []
    for job in jobs:
        first = (job.task, job.label) not in filmed
        filmed.add((job.task, job.label))
        mode = _video_mode(job, settings, first=first)
        seconds = job_seconds(settings.job_seconds, job.agent, providers=job.access.providers)
        bounded = replace(job, seconds=seconds)
        works.append(Work(job=bounded, folder=str(folder), video=mode, optimum=settings.optimum))
    return works


def _video_mode(job: Job, settings: Settings, *, first: bool) -> VideoMode:
    if settings.video_methods is not None and job.method not in settings.video_methods:
        return "none"
    if settings.video == "first":
        return "last" if first else "none"
    modes: dict[str, VideoMode] = {"none": "none", "failed": "failed", "all": "all"}
    return modes[settings.video]


def _effort(work: Work) -> int:
    """Longest first, so that no long job is left for the end: episodes by robots, and a video on top."""
    return (work.job.iterations + 1) * (1 + work.job.options.robots) + 6 * (work.video != "none")
