"""Where jobs are played: in this process, in processes, in threads, or on a Ray cluster."""

from __future__ import annotations

import signal
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from remac_bench.errors import JobTimeoutError
from remac_bench.playing import agents, pool, ray_pool, threads
from remac_bench.playing.interrupts import alarm, stoppable
from remac_bench.playing.jobs import Job
from remac_bench.playing.machine import cores
from remac_bench.playing.shared import Shared
from remac_bench.playing.watch import GRACE_SECONDS, Watch
from remac_bench.playing.worker import Work, play_job, timed_out
from remac_bench.records import Record

THREADS = 16
"""Jobs at the same time by default where language models are asked: they wait for most of their time."""


@dataclass(frozen=True, kw_only=True)
class Engine:
    """How jobs are spread.

    Attributes:
        name: one of `settings.ENGINES`; auto: threads of this process where language models are asked, so that all
            jobs share one limiter and one cassette, else processes.
        workers: how many jobs at the same time; None: one a core, THREADS in threads; 0: in this process, one by one.
        address: of a Ray cluster; None: one on this machine that ends with the run.
    """

    name: str = "auto"
    workers: int | None = None
    address: str | None = None

    def picked(self, jobs: Sequence[Job]) -> str:
        """The engine that plays these jobs: one of `settings.ENGINES` but auto, or "here"."""
        if self.workers == 0:
            return "here"
        if self.name != "auto":
            return self.name
        waits = any(agents.asked_models(job.agent, providers=job.access.providers) for job in jobs)
        return "threads" if waits else "processes"


def play_all(
    works: Sequence[Work], *, engine: Engine, extensions: Sequence[str], watch: Watch
) -> Iterator[tuple[Work, list[Record]]]:
    """Play works and yield each with its records as it ends, in any order.

    Args:
        watch: learns which jobs are under way, and says whose time is up.

    Raises:
        UsageError: if Ray is asked for and not installed.
    """
    picked = engine.picked([work.job for work in works])
    if not works:
        return
    if picked == "here":
        shared = Shared()
        try:
            for work in works:
                yield work, _play_here(work, shared)
        finally:
            shared.servers.close()
    elif picked == "threads":
        yield from threads.play(works, count=min(engine.workers or THREADS, len(works)), watch=watch)
    elif picked == "ray":
        address = engine.address
        yield from ray_pool.play(works, workers=engine.workers, address=address, extensions=extensions, watch=watch)
    else:
        count = min(engine.workers or cores(), len(works))
        yield from pool.play(works, count=count, extensions=extensions, watch=watch)


def _play_here(work: Work, shared: Shared) -> list[Record]:
    """In this process and thread: what hangs is interrupted, as far as Python can be."""
    try:
        with stoppable(signal.SIGINT), alarm(work.seconds + GRACE_SECONDS):
            return play_job(work, shared)
    except JobTimeoutError:
        return [timed_out(work)]
