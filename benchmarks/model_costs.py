"""What methods ask of language models, and what that costs with the paper's models: `python benchmarks/model_costs.py`.

Plays every method on every task with offline roles, beside which the roles that are language models put their real
questions to a meter; nothing is sent. Tokens are estimated from characters, rather too many than too few. `--write`
keeps the table by which `remac bench run` estimates what it may cost.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import typer
from remac_bench.board import Board, Cell, Column, Sheet
from remac_bench.columns import across
from remac_bench.command import run_script
from remac_bench.flags import takes
from remac_bench.playing import agents, suites
from remac_bench.playing.job_lists import parse_names, parse_seeds
from remac_bench.preflight.estimates import FILE, Costs, Need, measured
from remac_bench.preflight.measuring import MODEL, measure
from remac_bench.prices import dollars
from remac_bench.report import board_markdown, board_tables

import remac_env
from remac_agents.llm import Model, load, resolve
from remac_agents.llm.request import CHARACTERS_PER_TOKEN, TOKENS_PER_PICTURE
from remac_env.errors import check_choice

SUITES = ("smoke", "paper")
"""Suites whose price is shown."""

ONE_KEY = "openrouter"
"""The provider that has a route to all of the paper's models."""

MARKS = ("<!-- costs -->", "<!-- end of costs -->")
"""Between these lines of a document stand the tables."""

Needs = Mapping[str, Mapping[str, Mapping[str, Need]]]


@takes(
    *("script.methods", "script.tasks", "model_costs.seeds", "model_costs.write"),
    *("model_costs.show", "records.as_markdown", "model_costs.into"),
)
def main(
    *,
    methods: str | None,
    tasks: str | None,
    seeds: str,
    write: bool,
    show: bool,
    as_markdown: bool,
    into: Path | None,
) -> None:
    """Print calls and tokens an episode by method and task, and US dollars by model and route."""
    chosen = parse_names(methods, "methods") if methods else agents.methods()
    kitchens = parse_names(tasks, "tasks") if tasks else list(remac_env.tasks())
    for method in chosen:
        check_choice("method", method, agents.methods())
    costs = measured() if show else Costs(_measured(chosen, kitchens, parse_seeds(seeds)))
    if show:
        costs = Costs({method: costs.needs[method] for method in chosen if method in costs.needs})
    if write and not show:
        FILE.write_text(as_toml(costs.needs, seeds), "utf-8")
    board = Board(title="", sheets=sheets(costs))
    text = board_markdown(board, everything=True).strip()
    if into is not None:
        before, rest = into.read_text("utf-8").split(MARKS[0])
        into.write_text(f"{before}{MARKS[0]}\n{text}\n\n{MARKS[1]}{rest.split(MARKS[1])[1]}", "utf-8")
        return
    if as_markdown:
        typer.echo(text)
        return
    show(*board_tables(board, everything=True, across=across()))


def sheets(costs: Costs) -> tuple[Sheet, ...]:
    """The tables that are printed."""
    return (
        _tokens(costs, images=True, title="with a model that takes pictures in every role that speaks"),
        _tokens(costs, images=False, title="with one that does not: the checker is then `truth`"),
        _episodes(costs),
        _suites(costs),
    )


def as_toml(needs: Needs, seeds: str) -> str:
    """The table as a file."""
    lines = [
        "# What an episode takes of a language model in each role: calls, tokens of prompts with pictures, tokens of",
        "# answers without thoughts. Means over starts and the iterations of a job; estimated from characters.",
        "version = 1",
        f'command = "python benchmarks/model_costs.py --seeds {seeds} --write"',
        f"characters_per_token = {CHARACTERS_PER_TOKEN}",
        f"tokens_per_picture = {TOKENS_PER_PICTURE}",
    ]
    for method, tasks in needs.items():
        for task, roles in tasks.items():
            lines += ["", f'[needs."{method}".{task}]']
            lines += [f"{role} = [{n.calls:.2f}, {n.prompt:.0f}, {n.completion:.0f}]" for role, n in roles.items()]
    return "\n".join(lines) + "\n"


def _measured(methods: Sequence[str], tasks: Sequence[str], seeds: Sequence[int]) -> Needs:
    return {method: {task: measure(method, task, seeds=seeds) for task in tasks} for method in methods}


def _tokens(costs: Costs, *, images: bool, title: str) -> Sheet:
    tasks = list(next(iter(costs.needs.values()), {}))
    rows = [
        {"method": Cell(text=method), **{task: _cell(costs.whole(method, task, images=images)) for task in tasks}}
        for method in costs.needs
    ]
    columns = [Column(key="method", title="Method", numeric=False), *(Column(key=task, title=task) for task in tasks)]
    return Sheet(
        key=f"tokens-{'seeing' if images else 'blind'}",
        title=f"Calls / tokens of prompts / tokens of answers an episode, {title}",
        columns=tuple(columns),
        rows=tuple(rows),
    )


def _cell(need: Need | None) -> Cell:
    if need is None:
        return Cell(text="-")
    return Cell(text=f"{need.calls:.0f} / {_short(need.prompt)} / {_short(need.completion)}")


def _short(tokens: float) -> str:
    return f"{tokens:.0f}" if tokens < 1000 else f"{tokens / 1000:.1f}k" if tokens < 10_000 else f"{tokens / 1000:.0f}k"


def _episodes(costs: Costs) -> Sheet:
    def money(model: Model, method: str) -> float | None:
        found = [costs.whole(method, task, images=model.images) for task in costs.needs[method]]
        whole = sum((need for need in found if need is not None), Need())
        return whole.times(1 / len(found)).money(model)

    return _by_route(
        "episodes",
        "US dollars an episode, mean over tasks, thoughts included",
        list(costs.needs),
        money,
    )


def _suites(costs: Costs) -> Sheet:
    all_jobs = {name: suites.load(name).jobs([{"model": MODEL}], checked=False) for name in SUITES}
    jobs = {name: [job for job in made if "model" in job.agent] for name, made in all_jobs.items()}

    def money(model: Model, suite: str) -> float | None:
        found = [(job, costs.whole(job.method, job.task, images=model.images)) for job in jobs[suite]]
        if any(need is None for _, need in found):
            return None
        whole = sum((need.times(job.iterations + 1) for job, need in found if need is not None), Need())
        return whole.money(model)

    return _by_route(
        "suites",
        f"US dollars of a suite ({', '.join(f'{name}: {len(jobs[name])} jobs' for name in SUITES)})",
        SUITES,
        money,
        total=True,
    )


def _by_route(
    key: str, title: str, heads: Sequence[str], money: Callable[[Model, str], float | None], *, total: bool = False
) -> Sheet:
    rows = []
    catalogue = load()
    for name, routes in catalogue.paper.items():
        for full in routes:
            provider, _, served = full.partition(":")
            model = catalogue.providers[provider].models[served]
            cells = {head: Cell(text=dollars(money(model, head))) for head in heads}
            rows.append({"model": Cell(text=name), "route": Cell(text=full), **cells})
    if total:
        models = [resolve(name, via=ONE_KEY).model for name in catalogue.paper]
        sums = {head: _sum([money(model, head) for model in models]) for head in heads}
        cells = {head: Cell(text=dollars(amount)) for head, amount in sums.items()}
        rows.append({"model": Cell(text="all six"), "route": Cell(text=ONE_KEY), **cells})
    front = (Column(key="model", title="Model", numeric=False), Column(key="route", title="Route", numeric=False))
    columns = (*front, *(Column(key=head, title=head) for head in heads))
    return Sheet(key=key, title=title, columns=columns, rows=tuple(rows))


def _sum(amounts: Sequence[float | None]) -> float | None:
    return None if None in amounts else sum(amount or 0.0 for amount in amounts)


if __name__ == "__main__":
    run_script(main)
