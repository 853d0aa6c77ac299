"""Runs jobs with a progress bar, and the table at the end: what `bench run` and `demo` share."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import typer
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from remac_bench.console import FAILED, INTERRUPTED, console, plain
from remac_bench.jobs import Job
from remac_bench.records import Record
from remac_bench.report import read_rows, tables
from remac_bench.runner import Listener, Settings, pending, run_jobs
from remac_bench.store import FILE


def run_and_report(jobs: Sequence[Job], folder: str, settings: Settings) -> None:
    """Run jobs, print the table, and say where the records are.

    Raises:
        typer.Exit: 130 after Ctrl-C or SIGTERM; 1 if infrastructure errors left jobs without a score.
    """
    bar = _Bar()
    try:
        with _terminable():
            summary = run_jobs(jobs, folder, settings, listener=bar)
    except KeyboardInterrupt:
        bar.stop()
        left = len(pending(jobs, folder))
        how = "the same command with --resume" if settings.fresh else "the same command"
        typer.echo(f"stopped: {len(jobs) - left} of {len(jobs)} jobs are recorded; {how} goes on", err=True)
        raise typer.Exit(INTERRUPTED) from None
    finally:
        bar.stop()
    screen = console()
    for part in tables(read_rows(folder)):
        screen.print(part, crop=False)
    screen.print(
        f"{summary.played} jobs played, {summary.skipped} found finished. Records: {Path(folder) / FILE}",
        markup=False,
    )
    if summary.infrastructure:
        told = "" if len(summary.infrastructure) == 1 else f", and {len(summary.infrastructure) - 1} more"
        typer.echo(
            f"infrastructure error, not scored: {plain(summary.infrastructure[0])}{told}; see `error` in the "
            "records; the same command runs these jobs again",
            err=True,
        )
        raise typer.Exit(FAILED)


@contextmanager
def _terminable() -> Iterator[None]:
    """Let SIGTERM, which batch systems send, stop a run as cleanly as Ctrl-C does."""
    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread may set handlers
        return
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


class _Bar(Listener):
    """A progress bar, in episodes, from the moment that there is something to do."""

    def __init__(self) -> None:
        counts = (MofNCompleteColumn(), TextColumn("episodes"), TimeElapsedColumn())
        columns = (TextColumn("{task.description}"), BarColumn(), *counts)
        self.progress = Progress(*columns, console=console(stderr=True))
        self._running = False

    def begin(self, jobs: Sequence[Job]) -> None:
        """Show the bar."""
        self._running = True
        self._task = self.progress.add_task("starting", total=sum(job.iterations + 1 for job in jobs))
        self.progress.start()

    def end(self, job: Job, records: Sequence[Record]) -> None:
        """Move it on."""
        told = escape(f"{job.task} {job.label}")
        self.progress.update(self._task, advance=job.iterations + 1, description=told)

    def stop(self) -> None:
        """Let go of the screen, once; a bar that was never shown leaves no trace."""
        if self._running:
            self._running = False
            self.progress.stop()
