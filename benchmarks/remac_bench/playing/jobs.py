"""Jobs: one cell and seed for one agent, with its iterations 0..k in order and a memory of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from functools import cached_property
from typing import Any

from remac_bench.playing import agents
from remac_bench.playing.agents import Access
from remac_bench.playing.outside import plugins
from remac_env.options import Options
from remac_env.seeding import digest

MOST_ITERATIONS = 1000
"""More is a slip of the keyboard."""

NOT_IN_KEY = ("render_mode",)
"""Options of the kitchen that cannot change what happens in it."""

@dataclass(frozen=True, kw_only=True)
class SuiteMark:
    """The frozen list that a job belongs to. `given`: keywords of `remac_agents.make` that it gives to every agent."""

    name: str
    version: int
    digest: str
    given: Mapping[str, Any] = field(default_factory=dict)

    @property
    def fields(self) -> dict[str, Any]:
        """The fields of a record that name it."""
        return {"suite": self.name, "suite_version": self.version, "suite_digest": self.digest}


@dataclass(frozen=True, kw_only=True)
class Job:
    """One cell and seed for one agent.

    Attributes:
        method: name of a method of remac_agents.
        task: name of a task.
        seed: the episode's seed; every iteration plays the same episode.
        options: the kitchen's; `robots` among them.
        agent: keywords of `remac_agents.make` that are not at their defaults; roles as text (agents.role).
        iterations: the number of the last iteration, which is the scored one.
        access: how language models are reached. Not part of the key: it changes who is asked, not what.
        suite: where the job comes from. Not part of the key either: equal jobs are equal.
        seconds: its wall time at most; None: not bounded yet (`deadline.job_seconds`). Not part of the key either.
        viewers: the roles for which the kitchen has pictures.
    """

    method: str
    task: str
    seed: int
    options: Options
    agent: Mapping[str, Any] = field(default_factory=dict)
    iterations: int = 0
    access: Access = field(default_factory=Access)
    suite: SuiteMark | None = None
    seconds: float | None = None
    viewers: tuple[str, ...] = ()

    @cached_property
    def key(self) -> str:
        """Twelve hexadecimal digits that name this job, the same in every process.

        Options at their defaults are left out, so that an option added later does not rename old jobs.
        """
        return digest(
            {
                "method": self.method,
                "task": self.task,
                "seed": self.seed,
                "agent": dict(self.agent),
                "iterations": self.iterations,
                "robots": self.options.robots,
                "kitchen": changed_options(self.options),
            }
        )

    @property
    def label(self) -> str:
        """The agent's name in tables: the method, in brackets where it departs from the method's defaults."""
        given = {} if self.suite is None else dict(self.suite.given)
        given |= agents.with_planner(self.method, {})
        facts: dict[str, object] = {n: v for n, v in self.agent.items() if n not in given or given[n] != v}
        if self.options.robots != agents.default_robots(self.method):
            facts["robots"] = self.options.robots
        if not self.access.isolated and plugins(self.agent, providers=self.access.providers):
            facts["isolated"] = "false"
        if self.iterations != agents.default_iterations(self.method):
            facts["iterations"] = self.iterations
        named = ", ".join(f"{name}={value}" for name, value in sorted(facts.items()))
        return f"{self.method} ({named})" if named else self.method

    @property
    def facts(self) -> dict[str, Any]:
        """Everything that the job was made with, for the record."""
        made = {"kitchen": asdict(self.options), "agent": dict(self.agent), "iterations": self.iterations}
        if self.seconds is not None:
            made["job_seconds"] = self.seconds
        made |= {"viewers": list(self.viewers)} if self.viewers else {}
        return made if self.access == Access() else {**made, "access": self.access.told}


def changed_options(options: Options) -> dict[str, Any]:
    """The kitchen's options that are not at their defaults, without the number of robots."""
    skipped = (*NOT_IN_KEY, "robots")
    values = {f.name: (getattr(options, f.name), f.default) for f in fields(options) if f.name not in skipped}
    return {name: value for name, (value, default) in values.items() if value != default}
