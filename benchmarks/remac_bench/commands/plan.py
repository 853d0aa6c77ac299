"""`remac plan`: one plan of a planner, and whether it is any good."""

from __future__ import annotations

from typing import Any

import typer

from remac_bench.flags import REACH, takes


@takes(
    *("episode.task", "planner", "episode.robots", "episode.seed", "starts", "wording", "style", "layout", "naming"),
    *("plan.taught", "plan.by", *REACH, "plan.out", "extensions"),
)
def plan(context: typer.Context, **given: Any) -> None:
    """Ask a planner for one plan and print it as JSON: valid, optimal, rounds, optimum and its first error."""
    from remac_bench.commands.planning import plan_command

    plan_command(context)
