"""`remac experiment`: the paper's plan-only experiments with any planners."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from remac_bench.command import joined, whole
from remac_bench.console import INTERRUPTED, clean_errors, console
from remac_bench.errors import UsageError
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

if TYPE_CHECKING:
    from remac_bench.experiments.book import Book
    from remac_bench.experiments.desk import Result

Names = Annotated[str, typer.Argument(help="reflection, wording or validity.")]
Planners = Annotated[
    list[str] | None, typer.Option("--planner", help="As for `remac plan`; may be repeated. By default all offline.")
]
MOST = 10_000
"""Starts a task at most: more is a slip of the keyboard."""

OFFLINE = ("literal", "oracle", "random", "noop")


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
    import remac_env
    from remac_bench import agents
    from remac_bench.commands.reaching import Reach, tell_unscored
    from remac_bench.experiments.book import Book
    from remac_bench.experiments.desk import Trial, Unscored
    from remac_bench.experiments.tables import as_json, tables
    from remac_bench.experiments.trials import EXPERIMENTS
    from remac_bench.extensions import find_local_modules, load_extensions
    from remac_bench.jobs import parse_names
    from remac_env.errors import check_choice
    from remac_env.files import prepare_file
    from remac_env.kitchen.starts import STARTS
    from remac_env.tasks import get

    if file is not None:
        prepare_file(file, "--json")
    find_local_modules()
    load_extensions(extensions or ())
    check_choice("experiment", name, EXPERIMENTS)
    check_choice("reflections", reflections, ("own", "rule"))
    kinds = parse_names(joined(starts, "starts") or "paper", "starts")
    for kind in kinds:
        check_choice("starts", kind, STARTS)
    crews = parse_names(joined(robots, "robots") or "1", "robots")
    if not set(crews) <= {"1", "2"}:
        raise UsageError(f"robots {','.join(crews)!r} is not valid; valid: 1, 2, or 1,2")
    known = remac_env.tasks()
    named = joined(tasks, "tasks")
    chosen = parse_names(named, "tasks") if named else [task for task in known if get(task).in_table]
    for task in chosen:
        check_choice("task", task, known)
    reach = Reach.of(context)
    planners = {text: reach.fill("planner", text) for text in map(reach.routed, planner or OFFLINE)}
    sizes = [int(crew) for crew in crews]
    settings = {"command": f"experiment {name}", "planners": list(planners), "tasks": chosen, "n": count,
                "robots": sizes, "starts": kinds, "reflections": reflections}  # fmt: skip
    lines = file.with_suffix(".jsonl") if out is None and file is not None else out
    book = Book(lines, settings)
    reach.check(planners)
    own = {text: reach.fill("reflector", agents.reflector_of(text, providers=providers)) for text in planners}
    reflectors = own if reflections == "own" else None
    where: dict[str, Any] = {"count": count, "robots": sizes, "starts": kinds}
    results = _collected(EXPERIMENTS[name](planners, chosen, **where, reflectors=reflectors, book=book), book)
    trials = [result for result in results if isinstance(result, Trial)]
    for part in tables(name, trials):
        console().print(part, crop=False)
    if file is not None and file != lines:
        file.write_text(json.dumps(as_json(name, trials), indent=1) + "\n", "utf-8")
    tell_unscored([f"{each.planner}: {each.why}" for each in results if isinstance(each, Unscored)])


def _collected(made: Iterator[Result], book: Book) -> list[Result]:
    """All results; after Ctrl-C it is said what is kept.

    Raises:
        typer.Exit: 130 after Ctrl-C.
    """
    try:
        return list(made)
    except KeyboardInterrupt:
        kept = f"{book.path} holds {len(book)} findings; the same command goes on" if book.path else "nothing is kept"
        typer.echo(f"stopped: {kept}", err=True)
        raise typer.Exit(INTERRUPTED) from None
