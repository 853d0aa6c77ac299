"""`remac pddl`: an episode as PDDL, for classical and temporal planners."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import typer

from remac_bench.errors import UsageError
from remac_bench.flags import takes
from remac_env.files import prepare_folder, read_text
from remac_env.quoting import PATH, quoted, words


@takes(
    *("episode.task", "episode.robots", "episode.seed", "starts", "style", "layout"),
    *("pddl.level", "pddl.out", "pddl.plan", "extensions"),
)
def pddl(
    *, task: str, seed: int, level: str, out: Path, plan: Path | None, extensions: list[str] | None, **kitchen: Any
) -> None:
    """Write an episode as OUT/domain.pddl and OUT/problem.pddl, and play a planner's plan of it back.

    The plan is played by the event clock in the symbolic backend; what is printed is whether it reaches the goal, and
    in how many seconds. What actions cannot say, such as food that burns, is left out of the domain and named.
    """
    import remac_env
    from remac_bench.playing.extensions import load_named
    from remac_env.pddl import play_plan, read_plan, unsaid, write_domain, write_problem

    load_named(extensions)
    env = remac_env.parallel_env(task, **kitchen, backend="symbolic", clock="events")
    env.reset(seed=seed)
    scene, world, goal = env.start.scene, env.world, env.goal
    steps = None if plan is None else read_plan(_text(plan), scene)
    problem = write_problem(scene, world, goal, level=level)
    texts = {"domain": write_domain(scene, level=level, relaxed=True), "problem": problem}
    folder = prepare_folder(out, "out")
    for name, text in texts.items():
        (folder / f"{name}.pddl").write_text(text, "utf-8")
        typer.echo(str(folder / f"{name}.pddl"))
    if left_out := unsaid(scene):
        typer.echo(f"not said by the domain, so that a plan may let it happen: {', '.join(left_out)}")
    if steps is not None:
        played = play_plan(env, steps, seed=seed)
        ended = "reaches the goal" if played.success else "does not reach the goal"
        typer.echo(f"the plan {ended}, after {played.seconds:g} s")
        for told in played.failed:
            typer.echo(f"failed: {told}")


def _text(plan: Path) -> str:
    try:
        return read_text(plan)
    except (OSError, ValueError) as error:
        told = f"plan {quoted(str(plan), PATH)} cannot be read: {words(error)}"
        raise UsageError(f"{told}; valid: a planner's plan") from error
