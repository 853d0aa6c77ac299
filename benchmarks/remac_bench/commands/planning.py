"""What `remac plan` and `remac experiment` do with their flags."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import Any

import typer

import remac_env
from remac_bench.columns import show
from remac_bench.command import joined
from remac_bench.commands.reaching import Reach, tell_unscored
from remac_bench.console import INTERRUPTED, plain
from remac_bench.errors import UsageError
from remac_bench.experiments.book import Book
from remac_bench.experiments.desk import Desk, Result, Trial, Unscored
from remac_bench.experiments.tables import as_json, tables
from remac_bench.experiments.teaching import lesson, teachers
from remac_bench.experiments.trials import EXPERIMENTS
from remac_bench.plans.ask import Cell, Taught
from remac_bench.playing import agents
from remac_bench.playing.extensions import load_named
from remac_bench.playing.job_lists import parse_names
from remac_env.errors import check_choice
from remac_env.files import prepare_file
from remac_env.options import STARTS
from remac_env.tasks import get

OFFLINE = ("literal", "oracle", "random", "noop")


def plan_command(context: typer.Context) -> None:
    """Print the judgement of one plan.

    Raises:
        UsageError, UnknownNameError, OptionError: for flags that are not valid.
        typer.Exit: 1 where the planner could not be asked.
    """
    given = context.params
    load_named(given["extensions"])
    cell = Cell(**{field.name: given[field.name] for field in fields(Cell) if field.name in given})
    taught, by = given["taught"], given["by"]
    own = taught and by == "own"
    reach = Reach.of(context)
    named = reach.routed(given["planner"] or "literal")
    planners = {named: reach.fill("planner", named)}
    reflectors = _reflectors(reach, planners) if own else None
    book = Book(given["out"], {"command": "plan", "planner": named, "reflections": by if taught else None})
    desk = Desk(planners, book)
    if not desk.knows(named, cell, told=taught, own=own):
        reach.check(planners)
    lessons = lesson(teachers(planners, reflectors, book)[named], cell) if taught else None
    found = desk.trial(named, cell, lessons, own=own)
    if isinstance(found, Unscored):
        tell_unscored([found.why])
    else:
        told = found.judgement.as_json()
        if isinstance(lessons, Taught) and lessons.usage is not None:
            told["first_iteration_usage"] = lessons.usage.as_json()
        typer.echo(json.dumps(told))
        _tell_usage(book)


def experiment_command(context: typer.Context) -> None:
    """Print the tables of an experiment, and write what it was asked to write.

    Raises:
        UsageError, UnknownNameError, OptionError: for flags that are not valid.
        typer.Exit: 1 where a planner could not be asked; 130 after Ctrl-C.
    """
    given = context.params
    name, file = given["name"], given["file"]
    load_named(given["extensions"])
    check_choice("experiment", name, EXPERIMENTS)
    chosen, where = _tasks(given), _where(given)
    reach = Reach.of(context)
    planners = {text: reach.fill("planner", text) for text in map(reach.routed, given["planner"] or OFFLINE)}
    reflectors = _reflectors(reach, planners) if given["reflections"] == "own" else None
    if file is not None:
        prepare_file(file, "--json")
    lines = file.with_suffix(".jsonl") if given["out"] is None and file is not None else given["out"]
    settings = {"command": f"experiment {name}", "planners": list(planners), "tasks": chosen, "n": given["count"],
                "robots": where["robots"], "starts": where["starts"], "reflections": given["reflections"]}  # fmt: skip
    book = Book(lines, settings)
    reach.check(planners)
    results = _collected(EXPERIMENTS[name](planners, chosen, **where, reflectors=reflectors, book=book), book)
    trials = [result for result in results if isinstance(result, Trial)]
    show(*tables(name, trials))
    _tell_usage(book)
    if file is not None and file != lines:
        file.write_text(json.dumps(as_json(name, trials, book.usage()), indent=1) + "\n", "utf-8")
    tell_unscored([f"{each.planner}: {each.why}" for each in results if isinstance(each, Unscored)])


def _tell_usage(book: Book) -> None:
    """Say what each planner took of language models, its first iterations and what was found before included."""
    for planner, asked in book.usage().items():
        typer.echo(plain(f"usage: {planner}: {asked.told}"), err=True)


def _reflectors(reach: Reach, planners: Mapping[str, object]) -> dict[str, object]:
    """Who learns from each planner's own first iteration."""
    return {text: reach.fill("reflector", agents.reflector_of(text, providers=reach.providers)) for text in planners}


def _tasks(given: Mapping[str, Any]) -> list[str]:
    known, named = remac_env.tasks(), joined(given["tasks"], "tasks")
    chosen = parse_names(named, "tasks") if named else [task for task in known if get(task).in_table]
    for task in chosen:
        check_choice("task", task, known)
    return chosen


def _where(given: Mapping[str, Any]) -> dict[str, Any]:
    """How many starts of which kinds, and for how many robots."""
    kinds = parse_names(joined(given["starts"], "starts") or "paper", "starts")
    for kind in kinds:
        check_choice("starts", kind, STARTS)
    teams = parse_names(joined(given["robots"], "robots") or "1", "robots")
    if not set(teams) <= {"1", "2"}:
        raise UsageError(f"robots {','.join(teams)!r} is not valid; valid: 1, 2, or 1,2")
    return {"count": given["count"], "robots": [int(team) for team in teams], "starts": kinds}


def _collected(made: Iterator[Result], book: Book) -> list[Result]:
    """All results; after Ctrl-C it is said what is kept.

    Raises:
        typer.Exit: 130 after Ctrl-C.
    """
    try:
        return list(made)
    except KeyboardInterrupt:
        kept = f"{book.path} holds {len(book)} findings; the same command resumes" if book.path else "nothing is kept"
        typer.echo(f"stopped: {kept}", err=True)
        raise typer.Exit(INTERRUPTED) from None
