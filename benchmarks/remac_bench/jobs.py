"""Jobs: one cell and seed for one agent, with its iterations 0..k in order and a memory of its own."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from functools import cached_property
from typing import Any

from remac_bench import agents, sight
from remac_bench.agents import Access
from remac_bench.errors import UsageError
from remac_bench.outside import plugins, usable
from remac_bench.watch import JOB_SECONDS, Deadline
from remac_env.options import Options
from remac_env.seeding import SEED_MAX, digest
from remac_env.values import python_values

NOT_IN_KEY = ("render_mode",)
"""Options of the kitchen that cannot change what happens in it."""

_MOST_SEEDS = 1_000_000
"""Seeds in one range at most: more is a slip of the keyboard."""


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
        seconds: its wall time at most; None: not bounded yet (`watch.job_seconds`). Not part of the key either.
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
        given = {} if self.suite is None else self.suite.given
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


def make_jobs(
    *,
    tasks: Sequence[str],
    methods: Sequence[str],
    seeds: Iterable[int],
    kitchen: Mapping[str, Any],
    agent: Mapping[str, Any],
    robots: int | None = None,
    iterations: int | None = None,
    access: Access | None = None,
    checked: bool = True,
) -> list[Job]:
    """Every combination of tasks, methods and seeds.

    Args:
        kitchen: keywords of `remac_env.parallel_env` but `robots`. Pictures follow from the roles (sight.kitchen_for).
        agent: keywords of `remac_agents.make`; those that are None count as not given.
        robots, iterations: None means the method's own; methods without a memory play iteration 0 alone.
        access: see Job.
        checked: build one kitchen and one agent of each sort, so that bad names come out now.

    Raises:
        UnknownNameError, OptionError: for names and numbers that are not valid, of any of the jobs.
    """
    given = agents.changed_options(python_values(dict(agent)))
    tasks, methods, seeds = python_values([tasks, methods, list(seeds)])
    jobs: dict[str, Job] = {}
    access = access or Access()
    for task in tasks:
        for method in methods:
            named = sight.with_checker(method, given, access)
            viewers = sight.viewers(method, named, access)
            crew = agents.default_robots(method) if robots is None else robots
            options = Options(**sight.kitchen_for(viewers, kitchen), robots=crew)
            last = agents.default_iterations(method)
            last = iterations if last and iterations is not None else last
            for seed in seeds:
                job = Job(
                    method=method,
                    task=task,
                    seed=seed,
                    options=options,
                    agent=named,
                    iterations=last,
                    access=access,
                    viewers=viewers,
                )
                jobs[job.key] = job
    if checked:
        check_jobs(list(jobs.values()))
    return list(jobs.values())


def parse_seeds(text: str) -> list[int]:
    """Seeds from "0:10" (0 to 9), "3" or "0,4,7".

    Raises:
        UsageError: for anything else, and for an empty range.
    """
    seeds: list[int] = []
    for part in text.split(","):
        first, colon, last = part.strip().partition(":")
        if not first.isdecimal() or (colon and not last.isdecimal()):
            raise UsageError(f"seeds {text!r} are not valid; valid: a range 0:10, a number 3 or a list 0,4,7")
        span = range(int(first), int(last)) if colon else range(int(first), int(first) + 1)
        if span and span[-1] > SEED_MAX or span.stop - span.start > _MOST_SEEDS:
            raise UsageError(f"seeds {text!r} are not valid; valid: at most {_MOST_SEEDS} seeds of 0..{SEED_MAX}")
        seeds += span
    if not seeds:
        raise UsageError(f"seeds {text!r} name no seed; valid: a range 0:10, a number 3 or a list 0,4,7")
    return list(dict.fromkeys(seeds))


def parse_names(text: str, kind: str) -> list[str]:
    """Names from a list with commas; UsageError where there is none."""
    names = [part.strip() for part in text.split(",") if part.strip()]
    if not names:
        raise UsageError(f"{kind} {text!r} name nothing; give one or more, with commas between them")
    return list(dict.fromkeys(names))


def check_jobs(jobs: Sequence[Job]) -> None:
    """Build one kitchen and one agent of each sort, so that bad names come out before any work is done.

    Raises:
        UnknownNameError, OptionError, UsageError: for what is not valid.
    """
    import remac_env

    kitchens = {(job.task, job.options) for job in jobs}
    for task, options in sorted(kitchens, key=str):
        remac_env.parallel_env(task, **asdict(options)).close()
    lines = agents.Lines()
    try:
        for job in {(job.method, str(job.agent)): job for job in jobs}.values():
            with usable(), lines.outside(job, Deadline.within(JOB_SECONDS)) as outside:
                agents.make(job, lines.keywords(job), outside)
    finally:
        lines.servers.close()
    if any(job.iterations < 0 for job in jobs):
        raise UsageError("iterations must be 0 or more: the number of the last iteration")
