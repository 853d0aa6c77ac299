"""Lists of jobs: every combination of tasks, methods and seeds, and what is wrong with any of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from typing import Any

from remac_bench.errors import UsageError
from remac_bench.playing import agents, sight
from remac_bench.playing.agents import Access
from remac_bench.playing.deadline import JOB_SECONDS, Deadline
from remac_bench.playing.jobs import Job
from remac_bench.playing.outside import usable
from remac_bench.playing.shared import Shared, make
from remac_env.options import Options
from remac_env.quoting import quoted
from remac_env.seeding import SEED_MAX
from remac_env.values import python_values

_MOST_SEEDS = 1_000_000
"""Seeds in one range at most: more is a slip of the keyboard."""

_MOST_DIGITS = 18


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
    viewers: Mapping[str, tuple[str, ...]] | None = None,
) -> list[Job]:
    """Every combination of tasks, methods and seeds.

    Args:
        kitchen: keywords of `remac_env.parallel_env` but `robots`. Pictures follow from the roles (sight.kitchen_for).
        agent: keywords of `remac_agents.make`; those that are None count as not given.
        robots: None means the method's own.
        iterations: None means the method's own; methods without a memory play iteration 0 alone.
        access: see Job.
        checked: build one kitchen and one agent of each sort, so that bad names come out now.
        viewers: method -> its roles that must be shown pictures, where that is known and nobody shall be asked.

    Raises:
        UnknownNameError, OptionError: for names and numbers that are not valid, of any of the jobs.
    """
    given = agents.changed_options(python_values(dict(agent)))
    tasks, methods, seeds = python_values([tasks, methods, list(seeds)])
    jobs: dict[str, Job] = {}
    access = access or Access()
    for task in tasks:
        for method in methods:
            named = sight.with_checker(method, agents.with_planner(method, given), access)
            seeing = sight.viewers(method, named, access) if viewers is None else viewers.get(method, ())
            team = agents.default_robots(method) if robots is None else robots
            wanted = sight.pictures_for(seeing, named, access)
            options = Options(**sight.kitchen_for(seeing, kitchen, wanted), robots=team)
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
                    viewers=seeing,
                )
                jobs[job.key] = job
    if checked and viewers is None:
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
        numbers = [first, last] if colon else [first]
        if not all(number.isdecimal() and len(number) <= _MOST_DIGITS for number in numbers):
            raise UsageError(f"seeds {quoted(text)} are not valid; valid: a range 0:10, a number 3 or a list 0,4,7")
        span = range(int(first), int(last)) if colon else range(int(first), int(first) + 1)
        if span and span[-1] > SEED_MAX or span.stop - span.start > _MOST_SEEDS:
            raise UsageError(f"seeds {quoted(text)} are not valid; valid: at most {_MOST_SEEDS} seeds of 0..{SEED_MAX}")
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
    shared = Shared()
    try:
        for job in {(job.method, str(job.agent)): job for job in jobs}.values():
            with usable(), shared.outside(job, Deadline.within(JOB_SECONDS)) as outside:
                make(job, shared.keywords(job), outside)
    finally:
        shared.servers.close()
    if any(job.iterations < 0 for job in jobs):
        raise UsageError("iterations must be 0 or more: the number of the last iteration")
