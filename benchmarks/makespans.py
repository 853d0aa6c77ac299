"""Our shortest makespans beside a temporal planner's: `python benchmarks/makespans.py`.

Each episode is written as PDDL, planned by the planner, played back by the event clock in the symbolic backend, and
searched by `remac_env.events.makespan`. With two robots the domain cannot say that one may set out for a place at the
very moment at which another leaves it, so that the planner's optimum may be up to a drive (6 s) longer for each such
exchange.
"""

from __future__ import annotations

import shlex
import subprocess
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

import typer
from remac_bench.command import run_script
from remac_bench.flags import takes
from remac_bench.job_lists import parse_names, parse_seeds

import remac_env
from remac_env.errors import OptionError
from remac_env.events.makespan import makespan
from remac_env.pddl import play_plan, printed_plan, read_plan, write_domain, write_problem
from remac_env.pddl.playing import NEAR

PATIENCE = 120.0
"""s for which a planner is waited for."""


@takes(
    *("script.tasks", "script.seeds", "starts"),
    *("makespans.robots", "makespans.by", "makespans.layout", "makespans.states"),
)
def main(*, tasks: str | None, seeds: str, starts: str, robots: int, by: str, layout: str, states: int) -> None:
    """Print each episode, and how many agree."""
    counts: Counter[str] = Counter()
    for task in parse_names(tasks, "tasks") if tasks else remac_env.tasks():
        for seed in parse_seeds(seeds):
            env = remac_env.parallel_env(
                task, robots=robots, backend="symbolic", clock="events", layout=layout, starts=starts
            )
            counts[_episode(env, task, seed, by, states)] += 1
    typer.echo(f"{sum(counts.values())} episodes: " + ", ".join(f"{n} {what}" for what, n in sorted(counts.items())))


def _episode(env: Any, task: str, seed: int, by: str, states: int) -> str:
    env.reset(seed=seed)
    ours = makespan(env.start, env.goal, max_states=states)
    text = _planned(env, by)
    if text is None:
        typer.echo(f"{task} seed {seed}: ours {ours.seconds} s ({ours.proof}), no plan of the planner's")
        return "without a plan of the planner's"
    steps = read_plan(text, env.start.scene)
    told = max(step.at + step.seconds for step in steps)
    played = play_plan(env, steps, seed=seed)
    both = f"ours {ours.seconds} s ({ours.proof}), the planner's {told:g} s, played {played.seconds:g} s"
    typer.echo(f"{task} seed {seed}: {both}" + "".join(f"; failed: {each}" for each in played.failed))
    if not played.success:
        return "whose plan does not reach the goal"
    if ours.optimum is None:
        return "whose optimum is not known"
    apart = played.seconds - ours.optimum
    return "agree" if abs(apart) < NEAR else f"in which the planner's is {apart:g} s longer"


def _planned(env: Any, by: str) -> str | None:
    """The last plan that the planner prints; None where it prints none."""
    with tempfile.TemporaryDirectory() as folder:
        files = {name: Path(folder) / f"{name}.pddl" for name in ("domain", "problem")}
        files["domain"].write_text(write_domain(env.start.scene, level="durative"), "utf-8")
        text = write_problem(env.start.scene, env.world, env.goal, level="durative")
        files["problem"].write_text(text, "utf-8")
        command = [part.format(**files) for part in shlex.split(by)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise OptionError(f"by {by!r} does not run: {error}; valid: a planner's command line") from error
    return printed_plan(done.stdout, env.start.scene) or None


if __name__ == "__main__":
    run_script(main)
