"""Jobs in threads of this process, for those that wait for language models: they share one cassette and limiters."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Sequence
from queue import Empty, SimpleQueue

from remac_bench.playing.shared import Shared
from remac_bench.playing.watch import LOOKS, Watch
from remac_bench.playing.worker import Work, play_job, timed_out
from remac_bench.records import Record

Ended = tuple[Work, "list[Record] | BaseException | None"]
"""A job with its records, or with an error of the runner's own; None: it has begun."""


def play(works: Sequence[Work], *, count: int, watch: Watch) -> Iterator[tuple[Work, list[Record]]]:
    """Play works with `count` at the same time, and yield each as it ends.

    The threads end with the process: one that waits for an answer does not hold up a runner that is stopped. What it
    was at is played again by the next run. A thread cannot be ended: one whose job's time is up is left to itself, its
    job has failed, and another thread takes its place.
    """
    waiting: SimpleQueue[Work] = SimpleQueue()
    ended: SimpleQueue[Ended] = SimpleQueue()
    for work in works:
        waiting.put(work)
    stopped, shared = threading.Event(), Shared(calls=count)
    left = {work.job.key: work for work in works}

    def hire(number: int) -> None:
        arguments = (waiting, ended, stopped, shared)
        threading.Thread(target=_serve, args=arguments, name=f"remac-worker-{number}", daemon=True).start()

    for number in range(count):
        hire(number)
    try:
        while left:
            for late in [work for work in left.values() if watch.is_over(work)]:
                watch.end(left.pop(late.job.key))
                hire(count := count + 1)
                yield late, [timed_out(late)]
            try:
                work, records = ended.get(timeout=LOOKS)
            except Empty:
                continue
            if isinstance(records, BaseException):
                raise records
            if work.job.key not in left:
                continue  # it came to an end after all, too late
            if records is None:
                watch.begin(work)
                continue
            watch.end(left.pop(work.job.key))
            yield work, records
    finally:
        stopped.set()
        shared.servers.close()


def _serve(waiting: SimpleQueue[Work], ended: SimpleQueue[Ended], stopped: threading.Event, shared: Shared) -> None:
    while not stopped.is_set():
        try:
            work = waiting.get_nowait()
        except Empty:
            return
        ended.put((work, None))
        try:
            ended.put((work, play_job(work, shared)))
        except BaseException as error:  # noqa: BLE001 - a defect of the runner's own; it must not wait for ever
            ended.put((work, error))
            return
