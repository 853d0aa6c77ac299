"""`remac plan`: one plan of a planner, and whether it is any good."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from remac_bench.console import clean_errors
from remac_bench.flags import (
    BaseUrl,
    Crew,
    Extensions,
    Layout,
    Naming,
    Planner,
    Preflight,
    Providers,
    Seed,
    Starts,
    Style,
    Via,
    Wording,
)


@clean_errors
def plan(
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
    preflight: Preflight = True,
    extensions: Extensions = None,
) -> None:
    """Ask a planner for one plan and print it as JSON: valid, optimal, rounds, optimum and its first error."""
    from remac_bench import agents
    from remac_bench.commands.reaching import Reach
    from remac_bench.extensions import find_local_modules, load_extensions
    from remac_bench.plans.ask import Cell, Taught, judged, teach, teach_by
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
    reach = Reach(base_url=base_url, providers=providers, via=via, preflight=preflight)
    named = reach.routed(planner or "literal")
    filled = reach.fill("planner", named)
    reach.check({"planner": filled})
    lessons: Taught | None = None
    if taught and by == "own":
        reflector = reach.fill("reflector", agents.reflector_of(named, providers=providers))
        lessons = teach_by(cell, planner=filled, reflector=reflector)
    elif taught:
        lessons = teach(cell)
    found = judged(cell, filled, lessons)
    typer.echo(json.dumps(found.as_json()))
