"""The command `remac`."""

from __future__ import annotations

import typer

import remac_env
from remac_bench.command import Command
from remac_bench.commands import bench, demo, doctor, experiment, learn, memory, oracle, pddl, plan, play, tasks, view
from remac_bench.console import check_folder, fill_streams, speak_plainly, tame_columns
from remac_bench.flags import takes

app = typer.Typer(
    no_args_is_help=True,
    invoke_without_command=True,
    pretty_exceptions_show_locals=False,  # locals may hold keys
    help="REMAC Kitchen: robot-kitchen tasks in real physics for planners of all kinds.",
)


@app.callback()
@takes("remac.version")
def remac(*, version: bool) -> None:
    """REMAC Kitchen: robot-kitchen tasks in real physics for planners of all kinds."""
    if version:
        typer.echo(f"remac {remac_env.__version__}")
        raise typer.Exit


app.command(cls=Command)(demo.demo)
app.command(cls=Command)(oracle.oracle)
app.command(cls=Command)(pddl.pddl)
app.command(cls=Command)(plan.plan)
app.command(cls=Command)(experiment.experiment)
app.command(cls=Command)(doctor.doctor)
app.command(cls=Command)(view.view)
app.command(cls=Command)(play.play)
app.add_typer(bench.app, name="bench")
app.add_typer(learn.app, name="learn")
app.add_typer(memory.app, name="memory")
app.add_typer(tasks.app, name="tasks")


def main() -> None:
    """Entry point of the console script."""
    fill_streams()
    check_folder()
    tame_columns()
    speak_plainly()
    app()


if __name__ == "__main__":
    main()
