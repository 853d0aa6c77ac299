"""Who is told of jobs that take long, and when they are over."""

from __future__ import annotations

import time
from collections.abc import Callable

from remac_bench.playing.jobs import Job
from remac_bench.playing.worker import Work

SLOW_SECONDS = 60.0
"""A job that runs for so long is named, and again whenever the time has doubled, s."""

GRACE_SECONDS = 2.0
"""What a worker may take beyond a job's time to end the job by itself before it is ended, s."""

LOOKS = 0.5
"""Between two looks at what is running, s."""


class Watch:
    """Jobs under way in other processes or threads."""

    def __init__(self, tell: Callable[[Job, float], None], clock: Callable[[], float] = time.monotonic) -> None:
        """Args: tell: is called with a job that is slow and the seconds that it has been running."""
        self._tell, self._clock = tell, clock
        self._began: dict[str, float] = {}
        self._told: dict[str, float] = {}

    def begin(self, work: Work) -> None:
        """A job has begun."""
        self._began[work.job.key], self._told[work.job.key] = self._clock(), SLOW_SECONDS

    def end(self, work: Work) -> None:
        """It has ended, however."""
        self._began.pop(work.job.key, None)

    def is_over(self, work: Work) -> bool:
        """Whether a job's time is up, and the grace; tells of one that is slow."""
        key = work.job.key
        if key not in self._began:
            return False
        running = self._clock() - self._began[key]
        if running >= self._told[key]:
            self._told[key] = 2 * running
            self._tell(work.job, running)
        return running >= work.seconds + GRACE_SECONDS
