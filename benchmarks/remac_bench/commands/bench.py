"""`remac bench run`, `verify`, `replay`, `report`, `blame`, `submit`, `accept` and `board`."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from remac_bench.command import Command
from remac_bench.commands import judge, submitting
from remac_bench.flags import RUN, takes

app = typer.Typer(no_args_is_help=True, help="Run agents in the kitchens and print their table.")


@app.command(cls=Command)
@takes(*RUN)
def run(context: typer.Context, **given: Any) -> None:
    """Play tasks with methods over seeds into OUT/records.jsonl; the same command goes on where it ended."""
    from remac_bench.commands.running import run_command

    run_command(context)


@app.command(cls=Command)
@takes("verify.sample", "verify.seed", "cassette", "providers", "extensions", "records.bodies", "records.suite")
def verify(folder: judge.Folder, **given: Any) -> None:
    """Play recorded jobs again and compare: re-execution is the proof. Exit code 1 where a record is contradicted."""
    from remac_bench.commands.running import verify_command

    verify_command(folder, **given)


@app.command(cls=Command)
@takes("replay.iteration", "replay.video", "extensions", "records.bodies")
def replay(
    folder: judge.Folder, job: Annotated[str, typer.Argument(help="A job's key, as its page and record say it.")],
    **given: Any,
) -> None:  # fmt: skip
    """Play one recorded episode again, subtask by subtask, and film it if asked; exit code 1 where it differs."""
    from remac_bench.commands.running import replay_command

    replay_command(folder, job, **given)


app.command(cls=Command)(judge.report)
app.command(cls=Command)(judge.blame)
app.command(cls=Command)(submitting.submit)
app.command(cls=Command)(submitting.accept)
app.command(cls=Command)(submitting.board)
