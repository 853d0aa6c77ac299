"""How long jobs may take, and who is told of those that take long."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from remac_bench import agents
from remac_bench.errors import JobTimeoutError

if TYPE_CHECKING:
    from remac_bench.jobs import Job
    from remac_bench.worker import Work

JOB_SECONDS = 3_600.0
"""Wall time of a job of offline roles or of code from outside, s. The slowest of the suites takes about a minute."""

ASKING_SECONDS = 86_400.0
"""The same where a language model, an HTTP address or a person is asked, s: what models may take has bounds of its own
(`--max-seconds`), and a person may go to sleep."""

SLOW_SECONDS = 60.0
"""A job that runs for so long is named, and again whenever the time has doubled, s."""

GRACE_SECONDS = 2.0
"""What a worker may take beyond a job's time to end the job by itself before it is ended, s."""

LOOKS = 0.5
"""Between two looks at what is running, s."""


def asks_around(agent: Mapping[str, Any], *, providers: str | None = None) -> bool:
    """Whether an agent with these options waits for others: a language model, an HTTP address, a person."""
    return bool(waited_for(agent, providers=providers))


def waited_for(agent: Mapping[str, Any], *, providers: str | None = None) -> list[str]:
    """The language models, the HTTP address and the person whose answers an agent with these options waits for."""
    planner = str(agent.get("planner", ""))
    asked = agents.asked_models(agent, providers=providers)
    return [*asked, planner] if planner.startswith(("http://", "https://", "human")) else asked


def job_seconds(given: float | None, agent: Mapping[str, Any], *, providers: str | None = None) -> float:
    """The bound on a job's wall time: what is given, else by who is asked; `providers` as in `agents.Access`."""
    if given is not None:
        return given
    return ASKING_SECONDS if asks_around(agent, providers=providers) else JOB_SECONDS


@dataclass(frozen=True)
class Deadline:
    """When a job's time is up."""

    seconds: float
    end: float
    clock: Callable[[], float] = time.monotonic

    @classmethod
    def within(cls, seconds: float, clock: Callable[[], float] = time.monotonic) -> Deadline:
        """From now on."""
        return cls(seconds, clock() + seconds, clock)

    @property
    def left(self) -> float:
        """Seconds; negative when the time is up."""
        return self.end - self.clock()

    def check(self) -> None:
        """Raise JobTimeoutError when the time is up."""
        if self.left <= 0:
            raise JobTimeoutError(self.seconds)


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
