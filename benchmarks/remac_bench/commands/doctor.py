"""`remac doctor`: what this machine has, and what each thing is for."""

from __future__ import annotations

import json
from dataclasses import asdict
from itertools import groupby

import typer
from rich import box
from rich.markup import escape
from rich.table import Table

from remac_bench.columns import show
from remac_bench.console import FAILED, MARKS
from remac_bench.errors import UsageError
from remac_bench.flags import takes

LAST = ("", "keys", "models")
"""What is shown last, by groups of findings."""


@takes("doctor.models", "base_url", "providers", "via", "doctor.as_json")
def doctor(
    *, models: list[str] | None, base_url: str | None, providers: str | None, via: str | None, as_json: bool
) -> None:
    """Say what this machine has and what for, or ask models one tiny question each.

    The exit code is 1 where something needed does not work.
    """
    if models:
        _ask_models(models, base_url=base_url, providers=providers, via=via, as_json=as_json)
        return
    if base_url is not None or via is not None:
        raise UsageError("--base-url and --via go with --model NAME")
    from remac_bench.playing.machine import examine
    from remac_bench.playing.routes import examine_models

    findings = [*examine_models(providers), *examine()]
    findings.sort(key=lambda finding: LAST.index(finding.group if finding.group in LAST else ""))
    if as_json:
        typer.echo(json.dumps([asdict(finding) for finding in findings]))
    else:
        # Models apart: their long names would make one table of all too wide for a terminal.
        for _, part in groupby(findings, key=lambda finding: finding.group == "models"):
            table = Table(box=box.SIMPLE_HEAD)
            for name in ("", "What", "Here"):
                table.add_column(name)
            table.add_column("For", min_width=28)
            for _, group in groupby(part, key=lambda finding: finding.group):
                for finding in group:
                    table.add_row(
                        MARKS[finding.ok], escape(finding.name), escape(finding.value), escape(finding.purpose)
                    )
                table.add_section()
            show(table)
    if any(finding.ok is False for finding in findings):
        raise typer.Exit(FAILED)


def _ask_models(
    names: list[str], *, base_url: str | None, providers: str | None, via: str | None, as_json: bool
) -> None:
    from remac_agents.llm import read_model_name
    from remac_agents.prompting.models import Models
    from remac_bench.commands.preflight import ask_and_show
    from remac_bench.playing.agents import by_route
    from remac_bench.preflight.probes import ask_all

    shared = Models(base_url=base_url, providers=providers)
    routed = [by_route(name, via=via, providers=providers) for name in dict.fromkeys(names)]
    clients = [shared.client(*read_model_name(name)) for name in routed]
    if as_json:
        found = ask_all(clients)
        typer.echo(json.dumps([asdict(probe) for preflight in found for probe in preflight.probes]))
    else:
        found = ask_and_show(clients)
    if any(preflight.fatal for preflight in found):
        raise typer.Exit(FAILED)
