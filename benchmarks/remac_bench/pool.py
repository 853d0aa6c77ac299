"""Worker processes that may die: each loses the job it was at, and no other."""

from __future__ import annotations

import multiprocessing
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any

from remac_bench.episode import Course, Fault, make_record
from remac_bench.records import Record
from remac_bench.worker import Work, play_job, serve

STOP_SECONDS = 5.0
"""How long a worker may take to end before it is killed."""


class WorkerDiedError(RuntimeError):
    """A worker process ended in the middle of a job: killed, out of memory, or a fault in native code."""


@dataclass(eq=False)
class _Worker:
    process: Any
    connection: Connection
    work: Work | None = None


def play_all(
    works: Sequence[Work], *, workers: int, extensions: Sequence[str]
) -> Iterator[tuple[Work, list[Record]]]:
    """Play works and yield each with its records as it ends, in any order.

    Args:
        workers: number of processes; 0 plays in this one, for debuggers.
    """
    if workers == 0:
        for work in works:
            yield work, play_job(work)
        return
    yield from _play_in_processes(works, min(workers, len(works)), extensions)


def _play_in_processes(
    works: Sequence[Work], count: int, extensions: Sequence[str]
) -> Iterator[tuple[Work, list[Record]]]:
    queue = deque(works)
    crew: list[_Worker] = []
    try:
        for _ in range(count):
            crew.append(_hire(extensions))
            _assign(crew[-1], queue)
        while busy := [worker for worker in crew if worker.work is not None]:
            ready = wait([worker.connection for worker in busy])
            for worker in [worker for worker in busy if worker.connection in ready]:
                work, records = _collect(worker)
                if records is None:
                    records = [_lost(work, worker)]
                    crew.remove(worker)
                    crew += [_hire(extensions)] if queue else []
                for idle in [worker for worker in crew if worker.work is None and queue]:
                    _assign(idle, queue)
                yield work, records
    finally:
        _dismiss(crew)


def _hire(extensions: Sequence[str]) -> _Worker:
    # spawn: a forked copy of a process that has drawn or stepped anything is not safe to use.
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=serve, args=(theirs, tuple(extensions)), name="remac-worker")
    process.start()
    theirs.close()  # so that the worker's death closes the last copy of its end
    return _Worker(process, ours)


def _assign(worker: _Worker, queue: deque[Work]) -> None:
    worker.work = queue.popleft()
    try:
        worker.connection.send(worker.work)
    except (BrokenPipeError, ConnectionResetError):
        return  # it died before it was given anything; reading from it will tell


def _collect(worker: _Worker) -> tuple[Work, list[Record] | None]:
    """The records of the worker's job, or None where it died."""
    work, worker.work = worker.work, None
    if work is None:
        raise RuntimeError("a worker that was given nothing has sent something")
    try:
        lines = worker.connection.recv()
    except (EOFError, ConnectionResetError):
        return work, None
    return work, [Record.model_validate_json(line) for line in lines]


def _lost(work: Work, worker: _Worker) -> Record:
    worker.process.join(STOP_SECONDS)
    worker.connection.close()
    error = WorkerDiedError(f"the worker process ended with status {worker.process.exitcode}")
    return make_record(work.job, 0, course=Course(), report={}, fault=Fault("infrastructure", error))


def _dismiss(crew: Sequence[_Worker]) -> None:
    """End every worker: the idle end by themselves when nobody listens any more, the busy are made to."""
    for worker in crew:
        worker.connection.close()
        if worker.work is not None:
            worker.process.terminate()
    for worker in crew:
        worker.process.join(STOP_SECONDS)
        if worker.process.is_alive():
            worker.process.kill()
            worker.process.join()
