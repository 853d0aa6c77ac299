"""`remac doctor`: what this machine has, and what each thing is for."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Annotated

import typer
from rich import box
from rich.markup import escape
from rich.table import Table

from remac_bench import flags
from remac_bench.console import FAILED, clean_errors, console

_MARKS = {True: "[green]ok[/green]", False: "[red]problem[/red]", None: "[dim]-[/dim]"}


@clean_errors
def doctor(
    providers: flags.Providers = None,
    as_json: Annotated[bool, typer.Option("--json", help="As JSON.")] = False,
) -> None:
    """Say what this machine has and what for; the exit code is 1 where something needed does not work."""
    from remac_bench.machine import examine
    from remac_bench.routes import examine_models

    findings = [*examine_models(providers), *examine()]
    findings.sort(key=lambda finding: finding.group in ("keys", "models"))
    if as_json:
        typer.echo(json.dumps([asdict(finding) for finding in findings]))
    else:
        table = Table(box=box.SIMPLE_HEAD)
        for name in ("", "What", "Here", "For"):
            table.add_column(name, overflow="fold")
        group = None
        for finding in findings:
            if group not in (None, finding.group):
                table.add_section()
            group = finding.group
            table.add_row(
                _MARKS[finding.ok], escape(finding.name), escape(finding.value), escape(finding.purpose)
            )
        console().print(table)
    if any(finding.ok is False for finding in findings):
        raise typer.Exit(FAILED)
