"""The command `remac`."""

from __future__ import annotations

import typer

from remac_bench.commands import bench, demo, doctor, experiment, memory, oracle, plan, tasks

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_show_locals=False,  # locals may hold keys
    help="REMAC Kitchen: robot-kitchen tasks in real physics for planners of all kinds.",
)
app.command()(demo.demo)
app.command()(oracle.oracle)
app.command()(plan.plan)
app.command()(experiment.experiment)
app.command()(tasks.tasks)
app.command()(doctor.doctor)
app.add_typer(bench.app, name="bench")
app.add_typer(memory.app, name="memory")


def main() -> None:
    """Entry point of the console script."""
    app()


if __name__ == "__main__":
    main()
