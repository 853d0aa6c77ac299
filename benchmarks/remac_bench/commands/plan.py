"""`remac plan`: one plan of a planner, and whether it is any good."""

from __future__ import annotations

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
    from remac_bench.commands.planning import plan_command

    plan_command(context)
