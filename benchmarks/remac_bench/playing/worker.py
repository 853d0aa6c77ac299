"""What a worker process does: jobs, one after the other, each in a kitchen and with an agent of its own."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass
from multiprocessing.connection import Connection, wait
from typing import Any

from remac_bench.errors import JobTimeoutError
from remac_bench.playing.deadline import Deadline, job_seconds
from remac_bench.playing.episodes import BlamedError, Course, blaming, make_record, play_episode
from remac_bench.playing.extensions import load_extensions
from remac_bench.playing.jobs import Job
from remac_bench.playing.recording import Recorder, VideoMode
from remac_bench.playing.shared import Agent, Shared, make
from remac_bench.records import Record


@dataclass(frozen=True, kw_only=True)
class Work:
    """A job with what does not change its result: videos wanted and where, whether to find the optimum."""

    job: Job
    folder: str
    video: VideoMode = "none"
    optimum: bool = False

    @property
    def seconds(self) -> float:
        """The job's wall time at most; one that takes longer has failed."""
        return job_seconds(self.job.seconds, self.job.agent, providers=self.job.access.providers)


def serve(connection: Connection, extensions: Sequence[str]) -> None:
    """Receive works, say of each that it has begun (None), and send back its records as lines of JSON.

    Until the other side is gone.
    """
    # Ctrl-C goes to all processes of a terminal; it is the parent that decides when to stop.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    import remac_agents  # noqa: F401 - so that no job's time goes by with it
    import remac_env  # noqa: F401

    load_extensions(extensions)
    threading.Thread(target=_end_with_parent, name="remac-watch", daemon=True).start()
    shared = Shared()
    try:
        while True:
            work = connection.recv()
            connection.send(None)
            connection.send([record.line() for record in play_job(work, shared)])
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return
    finally:
        shared.servers.close()


def _end_with_parent() -> None:
    """End this process when the runner is gone, whatever it is at: nobody would take its records."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)


def play_job(work: Work, shared: Shared | None = None) -> list[Record]:
    """All iterations. An infrastructure error ends the job, a crash of the agent only its iteration.

    Args:
        shared: what its language models share with other jobs of this process.
    """
    job, deadline = work.job, Deadline.within(work.seconds)
    try:
        with blaming("infrastructure"):
            env = _make_env(job)
    except BlamedError as fault:
        return [make_record(job, 0, course=Course(), report={}, fault=fault)]
    own = Shared() if shared is None else None
    try:
        return _play_iterations(work, env, shared or own or Shared(), deadline)
    finally:
        env.close()
        if own is not None:
            own.servers.close()


def timed_out(work: Work) -> Record:
    """The record of a job whose time is up: a failure of the agent, in the iteration that counts."""
    fault = BlamedError("agent", JobTimeoutError(work.seconds))
    return make_record(work.job, work.job.iterations, course=Course(), report={}, fault=fault)


def _play_iterations(work: Work, env: Any, shared: Shared, deadline: Deadline) -> list[Record]:
    job = work.job
    try:
        with blaming("infrastructure"):
            models = shared.keywords(job)
    except BlamedError as fault:
        return [make_record(job, 0, course=Course(), report={}, fault=fault)]
    with ExitStack() as stack:
        try:
            with blaming("agent"):
                agent = make(job, models, stack.enter_context(shared.outside(job, deadline)))
        except BlamedError as fault:
            return [make_record(job, job.iterations, course=Course(), report={}, fault=fault)]
        return _iterations(work, env, agent, deadline)


def _iterations(work: Work, env: Any, agent: Agent, deadline: Deadline) -> list[Record]:
    job = work.job
    records: list[Record] = []
    for iteration in range(job.iterations + 1):
        name = f"{job.task}-{job.label}-seed{job.seed}-iteration{iteration}-{job.key}"
        recorder = Recorder(env, work.folder, name, work.video, last=iteration == job.iterations)
        record = play_episode(env, agent, job, iteration, recorder, deadline, optimum=work.optimum)
        records.append(record)
        if record.infrastructure_error or record.scored:
            break
        if deadline.left <= 0:
            records.append(timed_out(work))
            break
    return records


def _make_env(job: Job) -> Any:
    import remac_env

    return remac_env.parallel_env(job.task, **asdict(job.options))
