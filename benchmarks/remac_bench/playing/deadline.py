"""How long jobs may take."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from remac_bench.errors import JobTimeoutError
from remac_bench.playing import agents

JOB_SECONDS = 3_600.0
"""Wall time of a job of offline roles or of code from outside, s. The slowest of the suites takes about a minute."""

ASKING_SECONDS = 86_400.0
"""The same where a language model, an HTTP address or a person is asked, s: what models may take has bounds of its own
(`--max-seconds`), and a person may go to sleep."""


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
