"""Jobs whose worker died: once may be anybody's doing, and twice is the agent's."""

from __future__ import annotations

import signal
from collections import Counter
from typing import Literal

from remac_bench.playing.episodes import BlamedError, Course, make_record
from remac_bench.playing.worker import Work
from remac_bench.records import Record

DEATHS_MAX = 2
"""A job whose worker dies so often in a row ends with an error; before that it is played again."""

FROM_OUTSIDE = (-signal.SIGKILL, -signal.SIGTERM)
"""Exit statuses of workers that someone else ended: a batch system, or the kernel when memory runs out."""


class WorkerDiedError(RuntimeError):
    """A worker process ended in the middle of a job: it left, ran out of memory, or had a fault in native code."""


class Losses:
    """Counts the deaths of workers, job by job."""

    def __init__(self) -> None:
        self._deaths: Counter[str] = Counter()

    def judge(self, work: Work, status: int | None) -> Record | None:
        """What becomes of a job whose worker died: None: play it again; else its record.

        A worker that ends by itself, or by a fault, twice in a row at the same job is a crash of the agent. One that is
        killed from outside, or whose end is not known (None), never is: the job stays unscored.
        """
        self._deaths[work.job.key] += 1
        if self._deaths[work.job.key] < DEATHS_MAX:
            return None
        kind: Literal["agent", "infrastructure"] = "agent"
        told = f"ended with status {status}"
        if status is None or status in FROM_OUTSIDE:
            kind, told = "infrastructure", "was killed from outside" if status else "was lost"
        error = WorkerDiedError(f"the worker process {told}, {DEATHS_MAX} times in a row")
        iteration = work.job.iterations if kind == "agent" else 0
        return make_record(work.job, iteration, course=Course(), report={}, fault=BlamedError(kind, error))
