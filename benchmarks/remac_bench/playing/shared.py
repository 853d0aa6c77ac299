"""A job's agent, and what the agents of one process share: lines to language models and to code from outside."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from contextlib import AbstractContextManager
from typing import Any, Protocol

from remac_bench.playing import agents
from remac_bench.playing.deadline import Deadline
from remac_bench.playing.jobs import Job
from remac_bench.playing.outside import Servers, plugins
from remac_env.thinking import Thought


class Shared:
    """What the jobs of one process share when they ask language models: one cassette, a limiter for each model, and
    what was learnt of how endpoints want to be asked."""

    def __init__(self, *, calls: int = 1) -> None:
        """Args: calls: how many may be under way at the same time, at first and at most."""
        self._calls, self._lock = calls, threading.Lock()
        self._limiters: dict[str, Any] = {}
        self._cassettes: dict[agents.Access, Any] = {}
        self._manners: Any = None
        self.servers = Servers()

    def outside(self, job: Job, deadline: Deadline) -> AbstractContextManager[dict[str, Any]]:
        """The roles of this job that run in a process of their own, which ends with the block; see `Servers.roles`."""
        given = plugins(job.agent, providers=job.access.providers) if job.access.isolated else {}
        return self.servers.roles(given, deadline)

    def keywords(self, job: Job) -> dict[str, Any]:
        """Keywords of `remac_agents.make` for this job; none where no model is asked.

        Raises:
            OptionError: for a cassette that cannot be read, or written.
        """
        models = agents.asked_models(job.agent, providers=job.access.providers)
        if not models:
            return {}
        from remac_agents.llm import Cassette, Limiter, Manners  # only here: no offline job needs the client

        access, told = job.access, ",".join(models)
        with self._lock:
            if told not in self._limiters:
                self._limiters[told] = Limiter(start=self._calls, most=self._calls)
            self._manners = self._manners or Manners()
            if access.cassette is not None and access not in self._cassettes:
                self._cassettes[access] = Cassette(access.cassette, mode="replay" if access.replay else "fill")
            found: dict[str, Any] = {"base_url": access.base_url, "providers": access.providers}
            found |= {"cassette": self._cassettes.get(access), "replay": access.replay}
            return {**found, "limiter": self._limiters[told], "manners": self._manners}


class Agent(Protocol):
    """What the runner asks of an agent."""

    def reset(self, observations: Any, infos: Any) -> None:
        """Begin an episode."""

    def act(self, observations: Any, infos: Any) -> dict[str, int]:
        """A token for every robot."""

    def thoughts(self) -> Mapping[str, Thought]:
        """What went into the last tokens, robot by robot."""

    def close_episode(self, observations: Any, infos: Any) -> None:
        """End an episode; what was learnt goes into the memory."""

    def report(self) -> Any:
        """What the episode leaves behind: remac_agents' EpisodeReport."""


def make(job: Job, models: Mapping[str, Any], outside: Mapping[str, Any] | None = None) -> Agent:
    """The job's agent, with a memory of its own that lives in this process.

    Args:
        models: what it shares with others, from `Shared.keywords`.
        outside: role -> who fills it, for roles that run in processes of their own.

    Raises:
        UnknownNameError, OptionError: for a method, planner, other role or model that does not exist.
    """
    import remac_agents

    roles = {**job.agent, **(outside or {})}
    agent: Agent = remac_agents.make(job.method, **roles, **models, iterations=job.iterations)
    return agent
