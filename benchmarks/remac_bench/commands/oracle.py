"""`remac oracle`: the shortest plan of an episode."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from remac_bench.command import whole
from remac_bench.console import clean_errors
from remac_bench.flags import Crew, Extensions, Layout, Seed, Starts, Style


@clean_errors
def oracle(
    task: Annotated[str, typer.Option(help="Name of a task.")],
    robots: Crew = 1,
    seed: Seed = 0,
    starts: Starts = "paper",
    style: Style = None,
    layout: Layout = None,
    max_rounds: Annotated[int, typer.Option(help="Where the search gives up.", **whole(1, 100_000))] = 30,
    extensions: Extensions = None,
) -> None:
    """Print the shortest plan of an episode as JSON, and how far it is proven.

    proof is search (the plan is the shortest), bounds (the search gave up: the truth lies from lower to the plan's
    rounds), rounds (no plan has so few rounds) or exhausted (there is none at all).
    """
    import remac_env
    from remac_bench.extensions import load_extensions
    from remac_env.oracle import certify

    load_extensions(extensions or ())
    kitchen = remac_env.parallel_env(
        task,
        robots=robots,
        backend="symbolic",
        starts=starts,
        style=style,
        layout=layout,
        max_rounds=max_rounds,
    )
    kitchen.reset(seed=seed)
    found = certify(kitchen.start.scene, kitchen.world, kitchen.goal, max_rounds=max_rounds)
    answer = {
        "rounds": None if found.plan is None else found.plan.length,
        "proof": found.proof,
        "lower": found.lower,
        "plan": None if found.plan is None else found.plan.as_text(),
    }
    typer.echo(json.dumps(answer))
