"""`remac oracle`: the shortest plan of an episode."""

from __future__ import annotations

import json
from typing import Any

import typer

from remac_bench.flags import takes


@takes("episode.task", "episode.robots", "episode.seed", "starts", "style", "layout", "oracle.max_rounds", "extensions")
def oracle(*, task: str, seed: int, extensions: list[str] | None, max_rounds: int, **kitchen: Any) -> None:
    """Print the shortest plan of an episode as JSON, and how far it is proven.

    proof is search (the plan is the shortest), bounds (the search gave up: the truth lies from lower to the plan's
    rounds), rounds (no plan has so few rounds) or exhausted (there is none at all).
    """
    import remac_env
    from remac_bench.extensions import load_extensions
    from remac_env.oracle import certify

    load_extensions(extensions or ())
    env = remac_env.parallel_env(task, **kitchen, backend="symbolic", max_rounds=max_rounds)
    env.reset(seed=seed)
    found = certify(env.start.scene, env.world, env.goal, max_rounds=max_rounds)
    answer = {
        "rounds": None if found.plan is None else found.plan.length,
        "proof": found.proof,
        "lower": found.lower,
        "plan": None if found.plan is None else found.plan.as_text(),
    }
    typer.echo(json.dumps(answer))
