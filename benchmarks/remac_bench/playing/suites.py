"""Suites: frozen lists of jobs and agents, as TOML files. docs/running.md says what stands in them."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from remac_agents.options import AgentOptions
from remac_bench.errors import UsageError
from remac_bench.playing import agents
from remac_bench.playing.agents import Access
from remac_bench.playing.job_lists import check_jobs, make_jobs, parse_seeds
from remac_bench.playing.jobs import MOST_ITERATIONS, Job, SuiteMark
from remac_bench.playing.suite_values import (
    check_finite,
    check_keys,
    check_names,
    number,
    option_value,
    table,
    value_of,
)
from remac_env.errors import RemacError
from remac_env.files import read_text
from remac_env.generator.making import for_team
from remac_env.option_rows import rows
from remac_env.options import MAX_ROBOTS, Options
from remac_env.robots import bodies
from remac_env.seeding import KEPT_SEEDS, digest
from remac_env.tasks.generated import SPEC as GENERATED

CELLS = ("seed", "all", "held out")
"""Cells of a block: the one that each seed picks, or every style and layout of the task's rows of the style table."""

TABLE = "table"
"""In place of a list of tasks: those of the style table."""

TOP = ("name", "version", "about", "methods", "floors", "roles", "budget", "jobs")
BLOCK = ("tasks", "seeds", "cells", "methods", "robots", "iterations", "kitchen")
_NOT_A_SUITES = ("robots", "style", "layout", "render_mode")
KITCHEN = tuple(name for name, row in rows(Options).items() if row.spoken and name not in _NOT_A_SUITES)
_ADDED: dict[str, Path] = {}
FLOOR_METHOD = "BASE"
"""Floors plan once and look at nothing."""

BUDGET = (*agents.BUDGET, *agents.BOUNDS)
"""The keys of a suite, of one of its blocks of jobs, and of their tables."""


@dataclass(frozen=True, kw_only=True)
class Block:
    """Jobs that have everything in common but task, method, seed and cell."""

    tasks: tuple[str, ...]
    seeds: tuple[int, ...]
    methods: tuple[str, ...]
    kitchen: Mapping[str, Any]
    cells: str = "seed"
    robots: int | None = None
    iterations: int | None = None


@dataclass(frozen=True, kw_only=True)
class Suite:
    """A frozen list of jobs and agents.

    Attributes:
        name, version, about: what it is; the version is raised whenever its content changes.
        digest: of the content but `about`.
        floors: planners that are played on the same starts beside every entry, open loop: what an entry has to beat.
        roles, budget: keywords of `remac_agents.make`; a language model takes the roles over.
        blocks: its jobs.
    """

    name: str
    version: int
    about: str
    digest: str
    roles: Mapping[str, Any]
    budget: Mapping[str, Any]
    blocks: tuple[Block, ...]
    floors: tuple[str, ...] = ()

    def is_floor(self, agent: Mapping[str, Any]) -> bool:
        """Whether keywords of `remac_agents.make` are those of one of the suite's floors."""
        return set(agent) == {"planner"} and agent["planner"] in self.floors

    def given(self, entry: Mapping[str, Any], *, providers: str | None = None) -> dict[str, Any]:
        """What the suite gives to an entry: roles that no model takes over, and what the entry may spend."""
        speaks = bool(agents.asked_models(entry, providers=providers))
        roles = {} if "model" in entry else dict(self.roles)
        budget = {name: bound for name, bound in self.budget.items() if speaks or name not in agents.BUDGET}
        return {**roles, **budget}

    def jobs(
        self,
        entries: Sequence[Mapping[str, Any]] = ({},),
        *,
        backend: str | None = None,
        access: Access | None = None,
        checked: bool = True,
        viewers: Mapping[str, tuple[str, ...]] | None = None,
    ) -> list[Job]:
        """The jobs of every entry.

        Args:
            entries: keywords of `remac_agents.make` that make an entry what it is; {} is the suite's own agent.
            backend: in place of the suite's.
            access: how models are reached.
            checked: see `make_jobs`.
            viewers: see `make_jobs`.

        Raises:
            UnknownNameError, OptionError, UsageError: for an entry that is not valid.
        """
        jobs: dict[str, Job] = {}
        for entry in entries:
            given = self.given(entry, providers=None if access is None else access.providers)
            agent = {**given, **{name: value for name, value in entry.items() if value is not None}}
            mark = SuiteMark(name=self.name, version=self.version, digest=self.digest, given=given)
            for block in self.blocks:
                for job in _block_jobs(block, agent, backend, access, viewers):
                    jobs[job.key] = replace(job, suite=mark)
        jobs |= {job.key: job for job in self._floor_jobs(backend) if job.key not in jobs}
        if checked and viewers is None:
            check_jobs(list(jobs.values()))
        return list(jobs.values())

    def _floor_jobs(self, backend: str | None) -> list[Job]:
        mark = SuiteMark(name=self.name, version=self.version, digest=self.digest, given={})
        sorts = [(block, for_team(block.kitchen.get("grade"), block.kitchen.get("template"))) for block in self.blocks]
        blocks = [replace(b, methods=(FLOOR_METHOD,), robots=b.robots if team else None) for b, team in sorts]
        made = [_block_jobs(block, {"planner": who}, backend, None) for who in self.floors for block in blocks]
        return [replace(job, suite=mark) for jobs in made for job in jobs]


def names() -> list[str]:
    """The names of the suites that come with the benchmark, and of those added."""
    return sorted({path.stem for path in _folder().glob("*.toml")} | _ADDED.keys())


def add(file: str) -> None:
    """Make a suite of one's own known by its name in this process, to whoever reads records of it, and so its bodies.

    Raises:
        UsageError: as `load`, or where the name is one of those that come with the benchmark.
        UnknownNameError, OptionError: for a body in it that cannot be imported, or is none.
    """
    suite = load(file)
    for block in suite.blocks:
        bodies.get(block.kitchen.get("body", bodies.STANDARD))
    name = suite.name
    if (_folder() / f"{name}.toml").is_file():
        raise UsageError(f"suite {file!r} has the name {name!r}, which is taken; valid: another one")
    _ADDED[name] = Path(file)


def load(given: str) -> Suite:
    """A suite by its name, or from a file that ends in .toml.

    Raises:
        UsageError: naming file, key and valid values of what is wrong.
    """
    path = Path(given) if given.endswith(".toml") else _ADDED.get(given, _folder() / f"{given}.toml")
    if not given.endswith(".toml") and given not in names():
        raise UsageError(
            f"unknown suite {given!r}; valid: {', '.join(names())}, or a FILE.toml; tables that need plans alone "
            "(reflection, wording) are made by `remac experiment`"
        )
    try:
        return _read(path.name, tomllib.loads(read_text(path)))
    except (OSError, tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UsageError(f"suite {given!r} cannot be read: {error}") from error


def _folder() -> Path:
    """Inside an installed package; beside it in a checkout."""
    inside = Path(__file__).parents[1] / "suite_files"
    return inside if inside.is_dir() else Path(__file__).parents[2] / "suites"


def _block_jobs(
    block: Block, agent: Mapping[str, Any], backend: str | None, access: Access | None,
    viewers: Mapping[str, tuple[str, ...]] | None = None,
) -> list[Job]:
    jobs = []
    for task in block.tasks:
        for cell in _cells(task, block.cells):
            kitchen = {**block.kitchen, **cell, **({} if backend is None else {"backend": backend})}
            jobs += make_jobs(
                tasks=[task],
                methods=block.methods,
                seeds=block.seeds,
                kitchen=kitchen,
                agent=agent,
                robots=block.robots,
                iterations=block.iterations,
                access=access,
                checked=False,
                viewers=viewers,
            )
    return jobs


def _cells(task: str, which: str) -> list[dict[str, str]]:
    """The cells of a task that `which`, one of CELLS, means; an empty one where the seed picks.

    Held out: the layouts that the task's row of the table leaves out, in the styles that it leaves out, if it does.
    """
    from remac_env.kitchen import layout as layouts
    from remac_env.kitchen import style as styles
    from remac_env.tasks import get

    if which == "seed":
        return [{}]
    spec = get(task)
    looks, plans = spec.styles, spec.layouts
    if which == "held out":
        plans = tuple(name for name in layouts.names() if name not in spec.layouts)
        looks = tuple(name for name in styles.names() if name not in spec.styles) or spec.styles
    return [{"style": style, "layout": layout} for style in looks for layout in plans]


def _read(file: str, data: Mapping[str, Any]) -> Suite:
    check_keys(file, "", data, TOP)
    check_finite(file, "", data)
    for key in ("name", "version", "methods", "jobs"):
        if key not in data:
            raise UsageError(f"{file}: {key} is missing; valid: {', '.join(TOP)}")
    name, version = value_of(file, "name", data["name"], str), value_of(file, "version", data["version"], int)
    roles = table(file, "roles", data.get("roles", {}), agents.ROLES)
    budget = table(file, "budget", data.get("budget", {}), BUDGET)
    for key, bound in budget.items():
        option_value(file, f"budget.{key}", rows(AgentOptions)[key], bound)
    blocks = value_of(file, "jobs", data["jobs"], list)
    content = {key: value for key, value in data.items() if key != "about"}
    return Suite(
        name=name,
        version=version,
        about=value_of(file, "about", data.get("about", ""), str),
        digest=digest(content),
        roles=roles,
        budget=budget,
        floors=check_names(file, "floors", data["floors"], agents.planners()) if "floors" in data else (),
        blocks=tuple(_block(file, f"jobs[{i}]", each, data["methods"]) for i, each in enumerate(blocks)),
    )


def _block(file: str, where: str, data: Any, methods: Any) -> Block:
    import remac_env

    check_keys(file, f"{where}.", value_of(file, where, data, dict), BLOCK)
    for key in ("tasks", "seeds"):
        if key not in data:
            raise UsageError(f"{file}: {where}.{key} is missing; valid: {', '.join(BLOCK)}")
    tasks = _table_tasks() if data["tasks"] == TABLE else data["tasks"]
    cells = data.get("cells", "seed")
    check_names(file, f"{where}.cells", [cells], CELLS)
    kitchen = table(file, f"{where}.kitchen", data.get("kitchen", {}), KITCHEN)
    try:
        Options(**kitchen)
    except RemacError as error:
        raise UsageError(f"{file}: {where}.kitchen: {error}") from error
    known = [*remac_env.tasks(kitchen.get("clock", "rounds")), GENERATED.name]
    return Block(
        tasks=check_names(file, f"{where}.tasks", tasks, known),
        seeds=_seeds(file, f"{where}.seeds", data["seeds"]),
        methods=check_names(file, f"{where}.methods", data.get("methods", methods), agents.methods()),
        kitchen=kitchen,
        cells=cells,
        robots=number(file, f"{where}.robots", data.get("robots"), MAX_ROBOTS, least=1),
        iterations=number(file, f"{where}.iterations", data.get("iterations"), MOST_ITERATIONS),
    )


def _table_tasks() -> list[str]:
    import remac_env
    from remac_env.tasks import get

    return [name for name in remac_env.tasks() if get(name).in_table]


def _seeds(file: str, where: str, text: Any) -> tuple[int, ...]:
    try:
        seeds = parse_seeds(value_of(file, where, text, str))
    except UsageError as error:
        raise UsageError(f"{file}: {where}: {error}") from error
    if max(seeds) >= KEPT_SEEDS:
        kept = f"seeds from {KEPT_SEEDS} on are kept for judging"
        raise UsageError(f"{file}: {where}: {kept}; valid: 0..{KEPT_SEEDS - 1}")
    return tuple(seeds)
