"""Our shortest makespans beside a temporal planner's: `python benchmarks/makespans.py`.

Each episode is written as PDDL and searched by `remac_env.events.makespan`. Our plan is played, and stated as a plan of
that very problem (`remac_env.pddl.state_plan`), which `--validate` has checked by a validator besides; the planner's
plan is played back by the event clock in the symbolic backend. So where the makespans differ, the table says which of
the two is wrong, or only longer than need be. With two robots the domain cannot say that one may set out for a place at
the very moment at which another leaves it: our plan then is none of the problem's, and the planner's optimum up to a
drive (6 s) longer for each such exchange.
"""

from __future__ import annotations

import shlex
import tempfile
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean
from typing import Any

import typer
from event_turns import Infos, turns
from remac_bench.columns import show
from remac_bench.command import run_script
from remac_bench.flags import takes
from remac_bench.playing.job_lists import parse_names, parse_seeds
from rich.table import Table

import remac_env
from remac_agents.planners.child import CommandError, Printed, run_command
from remac_env.errors import OptionError
from remac_env.events.makespan import Makespan, makespan
from remac_env.pddl import Played, Step, play_plan, printed_plan, read_plan, state_plan, write_domain, write_problem
from remac_env.pddl.plans import NEAR
from remac_env.rules.places import destination

PATIENCE = 120.0
"""s for which a planner or a validator is waited for."""

MOST_BYTES = 10_000_000
"""Of what one prints."""


@dataclass(frozen=True)
class Compared:
    """An episode. `what`: how the two makespans stand to each other; `apart`: by how many seconds.

    `ours`: what our plan is by the domain's own semantics; `checked`: what a validator says of it, "" where none is
    asked.
    """

    what: str
    apart: float | None
    ours: str
    checked: str


@takes(
    *("script.tasks", "script.seeds", "starts", "makespans.robots", "makespans.by"),
    *("makespans.validate", "makespans.layout", "makespans.states"),
)
def main(
    *, tasks: str | None, seeds: str, starts: str, robots: int, by: str, validate: str, layout: str, states: int
) -> None:
    """Print each episode, and a table of how the makespans stand to each other."""
    found: list[Compared] = []
    for task in parse_names(tasks, "tasks") if tasks else remac_env.tasks():
        for seed in parse_seeds(seeds):
            env = remac_env.parallel_env(
                task, robots=robots, backend="symbolic", clock="events", layout=layout, starts=starts
            )
            with tempfile.TemporaryDirectory() as folder:
                found.append(_episode(env, seed, Path(folder), by, validate, states))
    groups: dict[tuple[str, str, str], list[Compared]] = defaultdict(list)
    for each in found:
        groups[each.what, each.ours, each.checked].append(each)
    table = Table("the planner's makespan", "our plan", "by the validator", "n", "s longer, mean")
    for (what, ours, checked), group in sorted(groups.items()):
        apart = [each.apart for each in group if each.apart is not None]
        table.add_row(what, ours, checked, str(len(group)), f"{mean(apart):.1f}" if apart else "")
    table.add_row("all", "", "", str(len(found)), "")
    show(table)


def _episode(env: Any, seed: int, folder: Path, by: str, validate: str, states: int) -> Compared:
    _, infos = env.reset(seed=seed)
    start, goal = env.start, env.goal
    files = {name: folder / f"{name}.pddl" for name in ("domain", "problem", "plan")}
    files["domain"].write_text(write_domain(start.scene, level="durative"), "utf-8")
    files["problem"].write_text(write_problem(start.scene, start.world, goal, level="durative"), "utf-8")
    best = makespan(start, goal, max_states=states)
    stated = state_plan(start.scene, start.world, goal, _played(env, infos, best))
    files["plan"].write_text(stated.text, "utf-8")
    ours = "of the same problem" if not stated.problem else "none of the problem's"
    checked = ""
    if validate:
        checked = "valid" if _run(validate, folder, files).status == 0 else "not valid"
    target = "" if best.seconds is None else f"{best.seconds + NEAR / 2:g}"
    text = printed_plan(_run(by, folder, {**files, "target": target}).text, start.scene)
    played = play_plan(env, read_plan(text, start.scene), seed=seed) if text else None
    what, apart = _compare(best, played)
    told = "no plan" if played is None else f"{played.seconds:g} s"
    lines = [f"ours {best.seconds} s ({best.proof}), the planner's {told}", stated.problem]
    lines += [] if played is None else [f"failed: {each}" for each in played.failed]
    typer.echo(f"{env.worlds.spec.name} seed {seed}: " + "; ".join(filter(None, lines)))
    return Compared(what, apart, ours, checked)


def _compare(best: Makespan, played: Played | None) -> tuple[str, float | None]:
    """How the planner's plan stands to our shortest one, and by how many seconds it is longer."""
    if played is None:
        return "no plan in its time", None
    if not played.success:
        return "its plan does not reach the goal", None
    if best.optimum is None:
        return "ours is not known", None
    apart = played.seconds - best.optimum
    if abs(apart) < NEAR:
        return "the same", None
    return ("longer" if apart > 0 else "shorter"), apart


def _played(env: Any, infos: Mapping[str, Any], best: Makespan) -> list[Step]:
    """Our plan as it goes in the kitchen: drives with the stations to which they lead."""
    left, steps, scene = list(best.plan), list[Step](), env.start.scene

    def choose(ready: Sequence[str], infos: Infos) -> dict[str, int]:
        now, begun = next(iter(infos.values()))["seconds"], dict[str, int]()
        for at, robot, subtask in [each for each in left if each[0] <= now + NEAR]:
            goal = destination(scene, env.world, robot, subtask.target) if subtask.moves and subtask.target else None
            steps.append(Step(at, robot, subtask.skill, goal or subtask.target, subtask.row.seconds))
            begun[robot] = env.vocabulary.encode(subtask.text)
            left.remove((at, robot, subtask))
        return begun

    for _ in turns(env, infos, choose):
        if not left:
            break
    return steps


def _run(command: str, folder: Path, fields: Mapping[str, Any]) -> Printed:
    """What a planner or a validator prints; it is gone afterwards with all that it started."""
    try:
        parts = [part.format(**fields) for part in shlex.split(command)]
        return run_command(parts, folder=folder, seconds=PATIENCE, most_bytes=MOST_BYTES)
    except (CommandError, LookupError, ValueError) as error:
        names = ", ".join(f"{{{name}}}" for name in fields)
        raise OptionError(f"{command!r} does not run: {error}; valid: a command line, with {names}") from error


if __name__ == "__main__":
    run_script(main)
