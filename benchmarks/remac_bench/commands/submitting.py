"""`remac bench submit`, `accept` and `board`: from a run to a place on a board that nobody has to take on trust."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from remac_bench.columns import across, show
from remac_bench.console import FAILED, plain, say
from remac_bench.flags import takes

SHOWN = 20
"""Reasons that are printed; all are counted."""


@takes("submit.out", "submit.name", "submit.contact", "submit.kind", "cassette", "providers")
def submit(
    folder: Annotated[str, typer.Argument(help="The --out of a run of a suite.")], *, out: str, **entry: Any
) -> None:
    """Pack records, the cassette that plays them again, and entry.toml into a folder that others can accept."""
    from remac_bench.proof.submission import pack

    pack(folder, out, **entry)
    typer.echo(f"packed: {plain(out)}; try it yourself: remac bench accept {plain(out)}")


@takes("accept.reask", "accept.seed", "base_url", "providers", "records.suite")
def accept(
    folder: Annotated[str, typer.Argument(help="A submission.")],
    *, reask: int, seed: int, base_url: str | None, providers: str | None, suite: str | None,
) -> None:
    """Play a whole submission again; print its rows, or the reasons why it is not accepted (exit code 1)."""
    from remac_bench.playing import suites
    from remac_bench.playing.agents import Access
    from remac_bench.proof.acceptance import accept as judge
    from remac_bench.report import tables

    if suite is not None:
        suites.add(suite)
    found = judge(folder, reask=reask, seed=seed, access=Access(base_url=base_url, providers=providers))
    if found.reasons:
        for reason in found.reasons[:SHOWN]:
            say(plain(reason))
        say(f"not accepted: {len(found.reasons)} reasons")
        raise typer.Exit(FAILED)
    show(*tables(found.rows, across=across()))
    again = "" if found.reasked is None else (
        f"; {found.reasked.jobs} jobs asked again: {found.reasked.before} successes then, {found.reasked.now} now"
    )
    say(f"accepted: {plain(found.entry.name)}, {found.tier}{again}")


@takes("board.out", "records.suite")
def board(
    folders: Annotated[list[str], typer.Argument(help="Accepted submissions of one suite.")],
    *, out: str, suite: str | None,
) -> None:
    """Make the tables and pages of accepted submissions: OUT/leaderboard.html."""
    from remac_bench.pages import write_pages
    from remac_bench.playing import suites
    from remac_bench.proof.standings import gather
    from remac_bench.report import board_tables, read_board

    if suite is not None:
        suites.add(suite)
    gather(folders, out)
    whole = read_board(out)
    show(*board_tables(whole, across=across()))
    typer.echo(f"pages: {write_pages(out, whole)}", err=True)
