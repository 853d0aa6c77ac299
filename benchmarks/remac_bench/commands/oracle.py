"""`remac oracle`: the shortest plan of an episode."""

from __future__ import annotations

import json
from typing import Any

import typer

from remac_bench.flags import takes


@takes(
    *("episode.task", "episode.robots", "episode.seed", "starts", "style", "layout"),
    *("clock", "oracle.max_rounds", "extensions"),
)
def oracle(*, task: str, seed: int, extensions: list[str] | None, max_rounds: int, **kitchen: Any) -> None:
    """Print the shortest plan of an episode as JSON, and how far it is proven.

    With --clock events: the shortest makespan in seconds, by the seconds of the skill table.

    proof is search (the plan is the shortest), bounds (the search gave up: the truth lies from lower to the plan's
    rounds), rounds (no plan has so few rounds) or exhausted (there is none at all).
    """
    import remac_env
    from remac_bench.playing.extensions import load_named
    from remac_env.oracle import certify

    load_named(extensions)
    env = remac_env.parallel_env(task, **kitchen, backend="symbolic", max_rounds=max_rounds)
    env.reset(seed=seed)
    if env.options.clock == "events":
        typer.echo(json.dumps(_in_seconds(env)))
        return
    found = certify(env.start.scene, env.world, env.goal, max_rounds=max_rounds)
    answer = {
        "rounds": None if found.plan is None else found.plan.length,
        "proof": found.proof,
        "lower": found.lower,
        "plan": None if found.plan is None else found.plan.as_text(),
    }
    typer.echo(json.dumps(answer))


def _in_seconds(env: Any) -> dict[str, Any]:
    from remac_env.events.makespan import makespan

    found = makespan(env.start, env.goal, deadline=env.max_seconds)
    plan = [{"at": at, "robot": robot, "command": subtask.text} for at, robot, subtask in found.plan]
    return {"seconds": found.seconds, "proof": found.proof, "lower": found.lower, "plan": plan or None}
