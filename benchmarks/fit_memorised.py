"""Chooses the plans that the planner `memorised` knows by heart, and prints them as its data file.

    python benchmarks/fit_memorised.py --seeds 40000:40200 > remac_agents/planners/memorised.toml

For each task, every shortest plan for one robot that any of the seeds' mixed starts has is carried out, open loop, on
all of these starts by the skill table; the one that reaches the goal most often is kept. The seeds are of no suite.
"""

from __future__ import annotations

import json
import sys
from typing import Any

from remac_bench.command import run_script
from remac_bench.flags import takes
from remac_bench.playing.job_lists import parse_seeds

import remac_env
from remac_agents.planners.memorised import pattern, templated
from remac_env.oracle import solve
from remac_env.rules.rounds import transition
from remac_env.tasks import get

Row = tuple[str, ...]


def starts(task: str, seeds: list[int]) -> list[tuple[Any, Any, Any, Any]]:
    """(scene, world, goal, nouns) of each seed's mixed start for one robot."""
    env = remac_env.parallel_env(task, robots=1, backend="symbolic", starts="mixed")
    found = []
    for seed in seeds:
        _, infos = env.reset(seed=seed)
        said = pattern(get(task).wordings[-1]).match(next(iter(infos.values()))["goal"])
        if said is not None:
            found.append((env.start.scene, env.world, env.goal, said.groupdict()))
    return found


def reaches(row: Row, scene: Any, world: Any, goal: Any, nouns: dict[str, str], parse: Any) -> bool:
    """Whether the plan, carried out to its end or to the goal, reaches it."""
    (robot,) = scene.robots
    for text in row:
        step = parse(text.format(**nouns))
        if step.target and step.target not in scene.objects and step.target not in scene.fixtures:
            continue  # the planner leaves out what this kitchen has no command for
        world, _ = transition(scene, world, {robot: step})
        if goal.holds(scene, world):
            return True
    return False


def fit(task: str, seeds: list[int]) -> tuple[Row, int]:
    """The best fixed plan, and on how many of the starts it succeeds."""
    parse = remac_env.parallel_env(task, robots=1, backend="symbolic").vocabulary.parse
    known = starts(task, seeds)
    plans: dict[Row, None] = {}
    for scene, world, goal, nouns in known:
        found = solve(scene, world, goal)
        if found is not None:
            (row,) = found.as_text().values()
            plans[tuple(templated(row, nouns))] = None
    scores = {row: sum(reaches(row, *start, parse) for start in known) for row in plans}
    best = max(scores, key=lambda row: (scores[row], -len(row), row))
    return best, scores[best]


@takes("fit_memorised.seeds")
def main(*, seeds: str) -> None:
    """Print the data file."""
    numbers = parse_seeds(seeds)
    lines = [f"# Printed by: python benchmarks/fit_memorised.py --seeds {seeds}", "version = 1"]
    for task in remac_env.tasks():
        row, won = fit(task, numbers)
        lines += ["", "[[task]]", f"# {task}: {won} of the {len(numbers)} mixed starts it was fitted on"]
        lines += [f"sentences = {json.dumps(list(get(task).wordings))}", f"plan = {json.dumps(list(row))}"]
    sys.stdout.write("\n".join([*lines, ""]))


if __name__ == "__main__":
    run_script(main)
