"""`remac experiment`: the paper's plan-only experiments with any planners."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from remac_bench.flags import REACH, of, takes


def _names() -> list[str]:
    from remac_bench.experiments.trials import EXPERIMENTS

    return [*EXPERIMENTS, "headroom"]


@takes(*of("experiment"), *REACH, "extensions")
def experiment(
    context: typer.Context,
    name: Annotated[str, typer.Argument(help="reflection, wording, validity or headroom.", autocompletion=_names)],
    **given: Any,
) -> None:
    """Ask planners for plans only, and judge them by the skill table: seconds, no physics."""
    if name == "headroom":
        from remac_bench.commands.headroom import headroom_command

        return headroom_command(given)
    from remac_bench.commands.planning import experiment_command

    return experiment_command(context)
