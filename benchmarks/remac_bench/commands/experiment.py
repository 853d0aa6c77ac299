"""`remac experiment`: the paper's plan-only experiments with any planners."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from remac_bench.command import whole
from remac_bench.console import clean_errors
from remac_bench.flags import (
    BaseUrl,
    Cassette,
    Extensions,
    MaxCalls,
    MaxMoney,
    MaxSeconds,
    MaxTokens,
    Preflight,
    Providers,
    Replay,
    Via,
)

Names = Annotated[str, typer.Argument(help="reflection, wording or validity.")]
Planners = Annotated[
    list[str] | None, typer.Option("--planner", help="As for `remac plan`; may be repeated. By default all offline.")
]
MOST = 10_000
"""Starts a task at most: more is a slip of the keyboard."""


@clean_errors
def experiment(
    context: typer.Context,
    name: Names,
    planner: Planners = None,
    tasks: Annotated[
        list[str] | None, typer.Option(help="Names with commas between them; may be repeated. By default the table's.")
    ] = None,
    count: Annotated[int, typer.Option("--n", help="Starts a task: seeds 0, 1, ...", **whole(1, MOST))] = 20,
    robots: Annotated[list[str] | None, typer.Option(help="1, 2 or 1,2; by default 1.")] = None,
    starts: Annotated[list[str] | None, typer.Option(help="paper, mixed or paper,mixed; by default paper.")] = None,
    reflections: Annotated[
        str, typer.Option(help="own: what each planner itself learns in a first iteration; rule: what the rules learn.")
    ] = "rule",
    file: Annotated[
        Path | None, typer.Option("--json", help="Also write every trial and the cells; plans are kept in FILE.jsonl.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="File of JSON lines for plans as they come; what it holds is not asked again.")
    ] = None,
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
    extensions: Extensions = None,
) -> None:
    """Ask planners for plans only, and judge them by the skill table: seconds, no physics."""
    from remac_bench.commands.planning import experiment_command

    experiment_command(context)
