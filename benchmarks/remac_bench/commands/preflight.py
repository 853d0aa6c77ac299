"""What commands say of the models that they are about to ask, and where they stop."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import typer
from rich import box
from rich.markup import escape
from rich.table import Table

from remac_agents.llm import ChatClient
from remac_bench.columns import show
from remac_bench.console import MARKS, USAGE, plain, say
from remac_bench.playing.agents import Access
from remac_bench.playing.jobs import Job
from remac_bench.preflight.estimates import measured
from remac_bench.preflight.probes import Preflight, ask_all
from remac_bench.preflight.run import bill, by_kind, clients_of, distinct, episodes_told, to_ask
from remac_bench.prices import dollars


def check_jobs_models(jobs: Sequence[Job]) -> None:
    """Ask each model of these jobs one tiny question, say what came of it and what the jobs may cost.

    Raises:
        typer.Exit: 2 where every job of a model would fail.
    """
    kinds = by_kind(jobs)
    if not any(kinds.values()):
        return
    access = jobs[0].access
    clients = to_ask(distinct(kinds.values()), access)
    if not clients:
        return
    found = ask_all(clients)
    _tell(found)
    say(f"preflight: {plain(bill(jobs, kinds, measured()).told)}", stderr=True)
    _stop_where_fatal(found)


def check_models(roles: Mapping[str, object], access: Access | None = None) -> None:
    """The same for roles alone, such as the planners of plan-only experiments.

    Raises:
        typer.Exit: 2 where a model could answer nothing.
    """
    found = ask_all(to_ask(distinct([clients_of(roles)]), access or Access()))
    _tell(found)
    _stop_where_fatal(found)


def ask_and_show(clients: Sequence[ChatClient]) -> list[Preflight]:
    """All findings as a table."""
    found = ask_all(clients)
    table = Table(box=box.SIMPLE_HEAD)
    for name in ("", "Model", "What", "Found"):
        table.add_column(name)
    for client, preflight in zip(clients, found, strict=True):
        for number, probe in enumerate(preflight.probes):
            name = escape(probe.model) if not number else ""
            table.add_row(MARKS[probe.ok], name, probe.check, escape(plain(probe.told)))
        if not preflight.fatal:
            table.add_row(MARKS[None], "", "cost", episodes_told(client.endpoint.model, measured()))
        table.add_row("", "", "asked", _asked(preflight))
        table.add_section()
    show(table)
    return found


def _tell(found: Sequence[Preflight]) -> None:
    for preflight in found:
        works = [f"{p.check} {p.told}" for p in preflight.probes if p.ok is not False and p.check != "address"]
        if works:
            told = f"preflight: {preflight.model}: {'; '.join(works)}; {_asked(preflight)}"
            say(plain(told), stderr=True)
        for probe in preflight.warnings:
            say(plain(f"warning: {probe.model}: {probe.check}: {probe.told}"), stderr=True)


def _stop_where_fatal(found: Sequence[Preflight]) -> None:
    fatal = [probe for preflight in found for probe in preflight.fatal]
    for probe in fatal:
        say(plain(f"error: {probe.model}: {probe.check}: {probe.told}"), stderr=True)
    if fatal:
        raise typer.Exit(USAGE)


def _asked(preflight: Preflight) -> str:
    questions = f"{preflight.questions} question{'s' * (preflight.questions != 1)}"
    return f"{questions} in {preflight.seconds:.1f} s, {dollars(preflight.money)}"
