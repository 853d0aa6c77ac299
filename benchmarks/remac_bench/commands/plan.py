"""`remac plan`: one plan of a planner, and whether it is any good."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from remac_bench.console import clean_errors
from remac_bench.flags import (
    BaseUrl,
    Cassette,
    Crew,
    Extensions,
    Layout,
    MaxCalls,
    MaxMoney,
    MaxSeconds,
    MaxTokens,
    Naming,
    Planner,
    Preflight,
    Providers,
    Replay,
    Seed,
    Starts,
    Style,
    Via,
    Wording,
)


@clean_errors
def plan(
    context: typer.Context,
    task: Annotated[str, typer.Option(help="Name of a task.")],
    planner: Planner = None,
    robots: Crew = 1,
    seed: Seed = 0,
    starts: Starts = "paper",
    wording: Wording = 3,
    style: Style = None,
    layout: Layout = None,
    naming: Naming = "role",
    taught: Annotated[
        bool, typer.Option("--reflections", help="Tell it a first iteration's plan and reflections.")
    ] = False,
    by: Annotated[
        str, typer.Option("--reflections-by", help="own: the planner's own first iteration; rule: the rules'.")
    ] = "rule",
    base_url: BaseUrl = None,
    providers: Providers = None,
    via: Via = None,
    cassette: Cassette = None,
    replay: Replay = False,
    preflight: Preflight = True,
    max_calls: MaxCalls = None,
    max_tokens: MaxTokens = None,
    max_money: MaxMoney = None,
    max_seconds: MaxSeconds = None,
    out: Annotated[
        Path | None,
        typer.Option(help="File of JSON lines to keep the answer in; what it holds is not asked again."),
    ] = None,
    extensions: Extensions = None,
) -> None:
    """Ask a planner for one plan and print it as JSON: valid, optimal, rounds, optimum and its first error."""
    from remac_bench import agents
    from remac_bench.commands.reaching import Reach, tell_unscored
    from remac_bench.experiments.book import Book
    from remac_bench.experiments.desk import Desk, Unscored
    from remac_bench.experiments.teaching import lesson, teachers
    from remac_bench.extensions import find_local_modules, load_extensions
    from remac_bench.plans.ask import Cell
    from remac_env.errors import check_choice

    find_local_modules()
    load_extensions(extensions or ())
    cell = Cell(
        task=task,
        robots=robots,
        seed=seed,
        starts=starts,
        wording=wording,
        style=style,
        layout=layout,
        naming=naming,
    )
    check_choice("reflections-by", by, ("own", "rule"))
    reach = Reach.of(context)
    named = reach.routed(planner or "literal")
    filled = reach.fill("planner", named)
    book = Book(out, {"command": "plan", "planner": named, "reflections": by if taught else None})
    desk = Desk({named: filled}, book)
    if not desk.knows(named, cell, told=taught, own=by == "own"):
        reach.check({"planner": filled})
    lessons = None
    if taught:
        own = by == "own"
        reflector = reach.fill("reflector", agents.reflector_of(named, providers=providers)) if own else None
        (teacher,) = teachers({named: filled}, {named: reflector} if own else None, book).values()
        lessons = lesson(teacher, cell)
    found = desk.trial(named, cell, lessons, own=by == "own")
    if isinstance(found, Unscored):
        tell_unscored([found.why])
    else:
        typer.echo(json.dumps(found.judgement.as_json()))
