"""What a worker process does: jobs, one after the other, each in a kitchen and with an agent of its own."""

from __future__ import annotations

import signal
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from multiprocessing.connection import Connection
from typing import Any

from remac_bench import agents
from remac_bench.agents import Lines
from remac_bench.episode import Course, Fault, blaming, make_record, play_episode
from remac_bench.extensions import load_extensions
from remac_bench.jobs import Job
from remac_bench.recording import Recorder, VideoMode
from remac_bench.records import Record


@dataclass(frozen=True, kw_only=True)
class Work:
    """A job with what does not change its result: videos wanted and where, whether to find the optimum."""

    job: Job
    folder: str
    video: VideoMode = "none"
    optimum: bool = False


def serve(connection: Connection, extensions: Sequence[str]) -> None:
    """Receive works and send back their records as lines of JSON, until the other side is gone."""
    # Ctrl-C goes to all processes of a terminal; it is the parent that decides when to stop.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    load_extensions(extensions)
    lines = Lines()
    try:
        while True:
            connection.send([record.line() for record in play_job(connection.recv(), lines)])
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return


def play_job(work: Work, lines: Lines | None = None) -> list[Record]:
    """All iterations. An infrastructure error ends the job, a crash of the agent only its iteration.

    Args:
        lines: what its language models share with other jobs of this process.
    """
    job = work.job
    try:
        with blaming("infrastructure"):
            env = _make_env(job)
    except Fault as fault:
        return [make_record(job, 0, course=Course(), report={}, fault=fault)]
    try:
        return _play_iterations(work, env, lines)
    finally:
        env.close()


def _play_iterations(work: Work, env: Any, lines: Lines | None) -> list[Record]:
    job = work.job
    try:
        with blaming("infrastructure"):
            shared = (lines or Lines()).keywords(job)
    except Fault as fault:
        return [make_record(job, 0, course=Course(), report={}, fault=fault)]
    try:
        with blaming("agent"):
            agent = agents.make(job, shared)
    except Fault as fault:
        return [make_record(job, job.iterations, course=Course(), report={}, fault=fault)]
    records: list[Record] = []
    for iteration in range(job.iterations + 1):
        name = f"{job.task}-{job.label}-seed{job.seed}-iteration{iteration}-{job.key}"
        recorder = Recorder(env, work.folder, name, work.video, last=iteration == job.iterations)
        record = play_episode(env, agent, job, iteration, recorder, optimum=work.optimum)
        records.append(record)
        if record.infrastructure_error:
            break
    return records


def _make_env(job: Job) -> Any:
    import remac_env

    return remac_env.parallel_env(job.task, **asdict(job.options))
