"""`remac experiment`: the paper's plan-only experiments with any planners."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from remac_bench.command import joined, whole
from remac_bench.console import clean_errors, console
from remac_bench.errors import UsageError
from remac_bench.flags import BaseUrl, Extensions, Preflight, Providers, Via

Names = Annotated[str, typer.Argument(help="reflection, wording or validity.")]
Planners = Annotated[
    list[str] | None, typer.Option("--planner", help="As for `remac plan`; may be repeated. By default all offline.")
]
MOST = 10_000
"""Starts a task at most: more is a slip of the keyboard."""

OFFLINE = ("literal", "oracle", "random", "noop")


@clean_errors
def experiment(
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
    file: Annotated[Path | None, typer.Option("--json", help="Also write every trial and the cells.")] = None,
    base_url: BaseUrl = None,
    providers: Providers = None,
    via: Via = None,
    preflight: Preflight = True,
    extensions: Extensions = None,
) -> None:
    """Ask planners for plans only, and judge them by the skill table: seconds, no physics."""
    import remac_env
    from remac_bench import agents
    from remac_bench.commands.reaching import Reach
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
    reach = Reach(base_url=base_url, providers=providers, via=via, preflight=preflight)
    planners = {text: reach.fill("planner", text) for text in map(reach.routed, planner or OFFLINE)}
    reach.check(planners)
    own = {text: reach.fill("reflector", agents.reflector_of(text, providers=providers)) for text in planners}
    reflectors = own if reflections == "own" else None
    sizes = [int(crew) for crew in crews]
    made = EXPERIMENTS[name](planners, chosen, count=count, robots=sizes, starts=kinds, reflectors=reflectors)
    trials = list(made)
    for part in tables(name, trials):
        console().print(part, crop=False)
    if file is not None:
        file.write_text(json.dumps(as_json(name, trials), indent=1) + "\n", "utf-8")
