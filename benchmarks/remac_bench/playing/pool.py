"""Worker processes that may die: each loses the job it was at, and no other."""

from __future__ import annotations

import multiprocessing
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Any

from remac_bench.playing.losses import Losses
from remac_bench.playing.watch import LOOKS, Watch
from remac_bench.playing.worker import Work, serve, timed_out
from remac_bench.records import Record

STOP_SECONDS = 5.0
"""How long a worker may take to end before it is killed."""


@dataclass(eq=False)
class _Worker:
    process: Any
    connection: Connection
    work: Work | None = None


def play(
    works: Sequence[Work], *, count: int, extensions: Sequence[str], watch: Watch
) -> Iterator[tuple[Work, list[Record]]]:
    """Play works in `count` processes and yield each with its records as it ends, in any order.

    A worker that dies is replaced, and its job played again at once by itself; see `losses`. One whose job's time is up
    is ended and replaced, and its job has failed.
    """
    queue, losses = deque(works), Losses()
    workers: list[_Worker] = []
    try:
        for _ in range(count):
            workers.append(_hire(extensions))
            _assign(workers[-1], queue)
        while busy := [worker for worker in workers if worker.work is not None]:
            for late in [worker for worker in busy if worker.work is not None and watch.is_over(worker.work)]:
                work = _dismiss_late(late, watch)
                workers.remove(late)
                workers += [_hire(extensions)] if queue else []
                _assign_idle(workers, queue)
                yield work, [timed_out(work)]
            ready = wait([worker.connection for worker in workers if worker.work is not None], timeout=LOOKS)
            for worker in [worker for worker in workers if worker.work is not None and worker.connection in ready]:
                ended = _collect(worker, watch)
                if ended is None:
                    continue
                work, records = ended
                if records is None:
                    workers.remove(worker)
                    lost = losses.judge(work, _bury(worker))
                    records = None if lost is None else [lost]
                    if lost is None:
                        queue.appendleft(work)
                    workers += [_hire(extensions)] if queue else []
                _assign_idle(workers, queue)
                if records is not None:
                    yield work, records
    finally:
        _dismiss(workers)


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


def _assign_idle(workers: Sequence[_Worker], queue: deque[Work]) -> None:
    for idle in [worker for worker in workers if worker.work is None][: len(queue)]:
        _assign(idle, queue)


def _collect(worker: _Worker, watch: Watch) -> tuple[Work, list[Record] | None] | None:
    """The worker's job with its records, or with None where it died; None while it has only begun."""
    work = worker.work
    if work is None:
        raise RuntimeError("a worker that was given nothing has sent something")
    try:
        lines = worker.connection.recv()
    except (EOFError, ConnectionResetError):
        lines = ()
    if lines is None:
        watch.begin(work)
        return None
    watch.end(work)
    worker.work = None
    return work, [Record.model_validate_json(line) for line in lines] or None


def _dismiss_late(worker: _Worker, watch: Watch) -> Work:
    """End a worker whose job's time is up; returns the job."""
    work = worker.work
    if work is None:
        raise RuntimeError("a worker that was given nothing is late")
    watch.end(work)
    worker.process.kill()
    worker.process.join()
    worker.connection.close()
    return work


def _bury(worker: _Worker) -> int | None:
    """The exit status of a worker that died; negative: the number of a signal."""
    worker.process.join(STOP_SECONDS)
    worker.connection.close()
    status: int | None = worker.process.exitcode
    return status


def _dismiss(workers: Sequence[_Worker]) -> None:
    """End every worker: the idle end by themselves when nobody listens any more, the busy are made to."""
    for worker in workers:
        worker.connection.close()
        if worker.work is not None:
            worker.process.terminate()
    for worker in workers:
        worker.process.join(STOP_SECONDS)
        if worker.process.is_alive():
            worker.process.kill()
            worker.process.join()
