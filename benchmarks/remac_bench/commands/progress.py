"""Runs jobs with a progress bar, and the table at the end: what `bench run` and `demo` share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import typer
from rich.console import Console
from rich.markup import escape
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    Task,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Column
from rich.text import Text

from remac_bench.columns import across, show
from remac_bench.console import FAILED, INTERRUPTED, broken, console, plain, say
from remac_bench.playing import agents
from remac_bench.playing.deadline import waited_for
from remac_bench.playing.interrupts import SIGNALS, stoppable
from remac_bench.playing.jobs import Job
from remac_bench.playing.runner import Listener, Settings, pending, run_jobs
from remac_bench.playing.solvable import refuse_unsolvable
from remac_bench.prices import dollars
from remac_bench.records import Record
from remac_bench.report import main_table
from remac_bench.store import FILE

_BESIDE = 90
"""Letters of a line that are left to what stands beside the bar; in a terminal that has no more there is none."""


def run_and_report(jobs: Sequence[Job], folder: str, settings: Settings) -> None:
    """Run jobs, print the table, and say where the records are.

    Raises:
        UsageError: if a start has no plan that reaches its goal; nothing is played then.
        typer.Exit: 130 after Ctrl-C or SIGTERM; 1 if infrastructure errors left jobs without a score; 2 if a language
            model could answer no job.
    """
    refuse_unsolvable(jobs if settings.fresh else pending(jobs, folder))
    # A bar that is drawn anew would write over what a person types.
    bar = Bar(shown=not any(agents.asks_person(job.agent) for job in jobs))
    with stoppable(*SIGNALS):
        try:
            if settings.preflight:
                _preflight(jobs, folder)
            summary = run_jobs(jobs, folder, settings, listener=bar)
        except KeyboardInterrupt:
            bar.stop()
            left = len(pending(jobs, folder))
            how = "the same command with --resume" if settings.fresh else "the same command"
            typer.echo(f"stopped: {len(jobs) - left} of {len(jobs)} jobs are recorded; {how} resumes", err=True)
            raise typer.Exit(INTERRUPTED) from None
        finally:
            bar.stop()
    show(*main_table(folder, across=across()))
    say(
        f"{summary.played} {'job' if summary.played == 1 else 'jobs'} played, {summary.skipped} found finished. "
        f"Records: {plain(str(Path(folder) / FILE))}"
    )
    if summary.infrastructure:
        told = "" if len(summary.infrastructure) == 1 else f", and {len(summary.infrastructure) - 1} more"
        typer.echo(
            f"infrastructure error, not scored: {plain(summary.infrastructure[0])}{told}; see `error` in the "
            "records; the same command runs these jobs again",
            err=True,
        )
        raise typer.Exit(FAILED)


def _preflight(jobs: Sequence[Job], folder: str) -> None:
    """Of the models that are still to be asked; nothing is written."""
    left = pending(jobs, folder)
    if left:
        from remac_bench.commands.preflight import check_jobs_models  # only here: offline runs need no client

        check_jobs_models(left)


class _Cut(TextColumn):
    """What gives way where the line is too short; no number does."""

    def render(self, task: Task) -> Text:
        """On one line."""
        text = super().render(task)
        text.no_wrap, text.overflow = True, "ellipsis"
        return text


class Bar(Listener):
    """A progress bar, in episodes, from the moment that there is something to do: done, failed, rate, ETA, money."""

    def __init__(self, *, screen: Console | None = None, shown: bool = True) -> None:
        """Args: screen: where it is drawn; None: stderr; shown: whether it is drawn at all."""
        self._screen = screen or console(stderr=True)
        whole = [Column(no_wrap=True) for _ in range(3)]
        counts = (MofNCompleteColumn(table_column=whole[0]), TextColumn("episodes"), TextColumn("{task.fields[told]}"))
        elapsed, left = TimeElapsedColumn(table_column=whole[1]), TimeRemainingColumn(table_column=whole[2])
        bar = [BarColumn(bar_width=min(40, self._screen.width - _BESIDE))] if self._screen.width > _BESIDE else []
        what = _Cut("{task.description}", table_column=Column())
        columns = (what, *bar, *counts, elapsed, TextColumn("left"), left)
        self.progress = Progress(*columns, console=self._screen, disable=not shown)
        self.tally = Tally()
        self._running = False

    def begin(self, jobs: Sequence[Job]) -> None:
        """Show the bar."""
        self._running = True
        total = sum(job.iterations + 1 for job in jobs)
        self._task = self.progress.add_task("starting", total=total, told="")
        self.progress.start()

    def end(self, job: Job, records: Sequence[Record]) -> None:
        """Move it on."""
        self.tally.add(records)
        told = escape(plain(f"{job.task} {job.label}"))
        elapsed = self.progress.tasks[0].elapsed or 0.0
        counts = self.tally.told(elapsed)
        self.progress.update(self._task, advance=job.iterations + 1, description=told, told=counts)

    def slow(self, job: Job, seconds: float) -> None:
        """Name a job that takes long, above the bar."""
        asked = " and ".join(waited_for(job.agent, providers=job.access.providers))
        waits = f", the waiting for answers of {asked} included" if asked else ""
        told = f"job {job.key}: {job.task} seed {job.seed} ({job.label}) has been running for {seconds:.0f} s{waits}"
        for line in broken(plain(told), self._screen.width):
            self.progress.console.print(line, markup=False, soft_wrap=True)

    def stop(self) -> None:
        """Let go of the screen, once; a bar that was never shown leaves no trace."""
        if self._running:
            self._running = False
            self.progress.stop()


@dataclass
class Tally:
    """What a run has come to so far. `failed`: scored episodes without success; `broken`: jobs without a score."""

    episodes: int = 0
    failed: int = 0
    broken: int = 0
    money: float = 0.0
    unpriced: int = 0

    def add(self, records: Sequence[Record]) -> None:
        """Take in the records of a job."""
        self.episodes += len(records)
        self.failed += sum(record.scored and not record.success for record in records)
        self.broken += any(record.infrastructure_error for record in records)
        self.money += sum(record.usage.money for record in records)
        self.unpriced += sum(record.usage.unpriced for record in records)

    def told(self, seconds: float) -> str:
        """As text: "3 failed, 1 broken, 12.5/s, $0.42"; what is not there is not told."""
        rate = f"{self.episodes / seconds:.1f}/s" if seconds > 0 else ""
        unknown = self.unpriced and not self.money
        money = "cost unknown" if unknown else dollars(self.money, self.unpriced) if self.money else ""
        broken = f"{self.broken} broken" if self.broken else ""
        return ", ".join(part for part in (f"{self.failed} failed", broken, rate, money) if part)
