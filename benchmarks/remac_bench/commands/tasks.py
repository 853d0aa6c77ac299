"""`remac tasks`: which tasks there are."""

from __future__ import annotations

import json
from typing import Any

import typer
from rich import box
from rich.markup import escape
from rich.table import Table

from remac_bench.console import console
from remac_bench.flags import takes


@takes("tasks.as_json", "extensions")
def tasks(*, as_json: bool, extensions: list[str] | None) -> None:
    """List the tasks with their styles and layouts."""
    from remac_bench.extensions import load_extensions

    load_extensions(extensions or ())
    entries = list_tasks()
    if as_json:
        typer.echo(json.dumps(entries))
        return
    table = Table(box=box.SIMPLE_HEAD)
    for name in ("Task", "Goal", "Styles", "Layouts", "Paper's table", "Clock"):
        table.add_column(name, no_wrap=name == "Task", overflow="fold")
    for entry in entries:
        cells = [entry["name"], entry["goal"], ", ".join(entry["styles"]), ", ".join(entry["layouts"])]
        table.add_row(*(escape(cell) for cell in cells), "yes" if entry["in_table"] else "no", entry["clock"])
    console().print(table)


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
