"""`remac tasks`: which tasks there are, and new ones."""

from __future__ import annotations

import json
from typing import Any

import typer
from rich import box
from rich.markup import escape
from rich.table import Table

from remac_bench.columns import show
from remac_bench.command import Command, joined
from remac_bench.console import say
from remac_bench.flags import takes
from remac_bench.playing.job_lists import parse_names, parse_seeds

app = typer.Typer(invoke_without_command=True)


@app.callback()
@takes("tasks.as_json", "extensions")
def tasks(context: typer.Context, *, as_json: bool, extensions: list[str] | None) -> None:
    """List the tasks with their styles and layouts; `generate` makes more of them."""
    if context.invoked_subcommand is not None:
        return
    from remac_bench.playing.extensions import load_named

    load_named(extensions)
    entries = list_tasks()
    if as_json:
        typer.echo(json.dumps(entries))
        return
    table = Table(box=box.SIMPLE_HEAD)
    for name in ("Task", "Goal", "Styles", "Layouts", "Paper's table", "Clock"):
        table.add_column(name, no_wrap=name == "Task")
    for entry in entries:
        cells = [entry["name"], entry["goal"], ", ".join(entry["styles"]), ", ".join(entry["layouts"])]
        table.add_row(*(escape(cell) for cell in cells), "yes" if entry["in_table"] else "no", entry["clock"])
    show(table)


@app.command("generate", cls=Command)
@takes(
    "generate.grades", "generate.seeds", "template", "quirks", "knowledge", "episode.robots", "generate.workers",
    "generate.as_json",
)  # fmt: skip
def generate(
    *, grades: list[str] | None, seeds: list[str] | None, workers: int, as_json: bool, **sort: Any
) -> None:
    """Make tasks of these grades and seeds, each with the bounds of its shortest plan, and say how long that took."""
    from remac_bench.generating import make_rows, summary

    wanted = [int(text) for text in parse_names(joined(grades, "grades") or "1", "grades")]
    numbers = parse_seeds(joined(seeds, "seeds") or "0")
    made = make_rows(wanted, numbers, sort, workers=workers)
    for row in made.rows:
        short = f"{row['template']}: {row['goal']} [{row['lower']}..{row['upper']} rounds, {row['proof']}]"
        if as_json:
            typer.echo(json.dumps(row))
        else:
            say(f"grade {row['grade']}, seed {row['seed']}, {short}")
    for line in summary(made):
        say(line, stderr=True)


def list_tasks() -> list[dict[str, Any]]:
    """Name, goal sentence, styles, layouts of each task, whether it is in the paper's table, and the clock it needs:
    one in rounds can be played by either.
    """
    import remac_env
    from remac_env.tasks import get

    return [
        {
            "name": name,
            "goal": spec.sentence(3, {role.name: "/".join(role.nouns) for role in spec.roles}),
            "styles": list(spec.styles),
            "layouts": list(spec.layouts),
            "in_table": spec.in_table,
            "clock": "events" if spec.timed else "rounds",
        }
        for name, spec in ((name, get(name)) for name in remac_env.tasks("events"))
    ]
