"""Jobs in threads of this process, for those that wait for language models: they share one cassette and limiters."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Sequence
from queue import Empty, SimpleQueue

from remac_bench.agents import Lines
from remac_bench.records import Record
from remac_bench.worker import Work, play_job

Ended = tuple[Work, "list[Record] | BaseException"]


def play(works: Sequence[Work], *, count: int) -> Iterator[tuple[Work, list[Record]]]:
    """Play works with `count` at the same time, and yield each as it ends.

    The threads end with the process: one that waits for an answer does not hold up a runner that is stopped. What it
    was at is played again by the next run.
    """
    waiting: SimpleQueue[Work] = SimpleQueue()
    ended: SimpleQueue[Ended] = SimpleQueue()
    for work in works:
        waiting.put(work)
    stopped, lines = threading.Event(), Lines(calls=count)
    for number in range(count):
        arguments = (waiting, ended, stopped, lines)
        threading.Thread(target=_serve, args=arguments, name=f"remac-worker-{number}", daemon=True).start()
    try:
        for _ in works:
            work, records = ended.get()
            if isinstance(records, BaseException):
                raise records
            yield work, records
    finally:
        stopped.set()


def _serve(waiting: SimpleQueue[Work], ended: SimpleQueue[Ended], stopped: threading.Event, lines: Lines) -> None:
    while not stopped.is_set():
        try:
            work = waiting.get_nowait()
        except Empty:
            return
        try:
            ended.put((work, play_job(work, lines)))
        except BaseException as error:  # noqa: BLE001 - a defect of the runner's own; it must not wait for ever
            ended.put((work, error))
            return
