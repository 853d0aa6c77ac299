"""`remac demo`, which `make demo` runs: four tasks, four methods, in physics, with the table and videos."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from remac_bench.command import joined
from remac_bench.console import say
from remac_bench.flags import takes

if TYPE_CHECKING:
    from remac_bench.playing.jobs import Job

METHODS = ("BASE", "CC", "RE", "REMAC")


@takes("demo.out", "demo.seeds", "backend", "body", "workers", "demo.video", "demo.resume")
def demo(
    *, out: str, seeds: list[str], backend: str, body: str, workers: int | None, video: bool, resume: bool
) -> None:
    """Play four tasks with BASE, CC, RE and REMAC, one kitchen a task: the table, records, videos and pages."""
    from remac_bench.commands.progress import run_and_report
    from remac_bench.playing.job_lists import parse_seeds
    from remac_bench.playing.settings import Settings
    from remac_env.files import prepare_folder

    prepare_folder(out, "--out")
    settings = Settings(
        workers=workers,
        video="first" if video else "none",
        video_methods=("REMAC",),
        fresh=not resume,
    )
    run_and_report(demo_jobs(parse_seeds(joined(seeds, "seeds") or "0:3"), backend, body), out, settings)
    _name_videos(out)
    show_pages(out)


def demo_jobs(seeds: list[int], backend: str, body: str) -> list[Job]:
    """The demo's jobs: every task of the table in one kitchen, the first style and layout of its own."""
    import remac_env
    from remac_bench.playing.job_lists import make_jobs
    from remac_env.tasks import get

    jobs = []
    for task in (name for name in remac_env.tasks() if get(name).in_table):
        cell = {"style": get(task).styles[0], "layout": get(task).layouts[0]}
        kitchen = {**cell, "backend": backend, "body": body}
        jobs += make_jobs(tasks=[task], methods=METHODS, seeds=seeds, kitchen=kitchen, agent={})
    return jobs


def _name_videos(out: str) -> None:
    """Say which videos there are, and why one is missing."""
    from remac_bench.store import Store

    for record in Store(out).read():
        if record.video is not None:
            told = Path(out, record.video.path) if record.video.path else f"none ({record.video.error})"
            say(f"{record.task}, {record.agent}, seed {record.seed}: {told}")


def show_pages(out: str) -> None:
    """Write the pages of a run, and say where they are and how they are looked at on a machine without a screen."""
    from remac_bench.pages import write_pages

    page = write_pages(out)
    typer.echo(f"Pages: {page.resolve().as_uri()}")
    typer.echo(f"or over the network's loopback: remac view {shlex.quote(out)}")
