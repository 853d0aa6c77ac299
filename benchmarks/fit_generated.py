"""Chooses the plans of generated tasks that the planner `memorised` knows by heart, and prints them as its data file.

    python benchmarks/fit_generated.py --seeds 41000:41040 > remac_agents/planners/memorised_generated.toml

For each template that is not held out, and each number of objects that its goal means, the plans of all these seeds'
tasks are carried out, open loop, on all of them by the skill table; the one that reaches the goal most often is kept.
The seeds are of no suite and no table; nothing has quirks.
"""

from __future__ import annotations

import json
import sys
from typing import Any

from remac_bench.command import run_script
from remac_bench.flags import takes
from remac_bench.playing.job_lists import parse_seeds

from remac_agents.planners.memorised import clauses, denoted
from remac_env.generator import GRADES, make, scene_of, templates
from remac_env.rules.rounds import transition
from remac_env.rules.scene import public_scene
from remac_env.rules.subtasks import Subtask

Row = tuple[Subtask, ...]
Start = tuple[Any, Any, Any, tuple[str, ...]]
Known = dict[tuple[str, int], list[tuple[Start, Row]]]


def starts(seeds: list[int]) -> Known:
    """(sentence of the template, number of objects) -> kitchens, each with its own plan, objects by their numbers."""
    found: Known = {}
    for grade in GRADES:
        for seed in seeds:
            task = make(grade=grade, seed=seed)
            scene, world = scene_of(task.spec, 1, "full")
            meant = denoted(task.spec.wordings[2], public_scene(scene))
            row = tuple(numbered(step, meant) for joint in task.plan.rounds for step in joint.values())
            said = sentence(task.spec.generated["template"])
            found.setdefault((said, len(meant)), []).append(((scene, world, task.spec.goal, meant), row))
    return found


def sentence(template: str) -> str:
    """What the goals of a template have in them: its own clauses, without any that a task has besides."""
    row = templates.get(template)
    return clauses(row.goal_of({group.kind: ("one",) for group in row.groups}).told(3))


def numbered(step: Subtask, meant: tuple[str, ...]) -> Subtask:
    """A step with the number of an object in place of its name."""
    return Subtask(step.skill, f"{{{meant.index(step.target)}}}") if step.target in meant else step


def reaches(row: Row, start: Start) -> bool:
    """Whether the plan, carried out to its end or to the goal, reaches it."""
    scene, world, goal, meant = start
    (robot,) = scene.robots
    for step in row:
        target = step.target.format(*meant)
        if target and target not in scene.objects and target not in scene.fixtures:
            continue  # the planner leaves out what this kitchen has no command for
        world, _ = transition(scene, world, {robot: Subtask(step.skill, target)})
        if goal.holds(scene, world):
            return True
    return False


@takes("fit_generated.seeds")
def main(*, seeds: str) -> None:
    """Print the data file."""
    lines = [f"# Printed by: python benchmarks/fit_generated.py --seeds {seeds}", "version = 1"]
    for (said, size), known in sorted(starts(parse_seeds(seeds)).items()):
        scores = {row: sum(reaches(row, start) for start, _ in known) for _, row in known}
        best = max(scores, key=lambda row: (scores[row], -len(row), [step.text for step in row]))
        lines += ["", "[[template]]", f"# {scores[best]} of the {len(known)} kitchens it was fitted on"]
        lines += [f"sentence = {json.dumps(said)}", f"objects = {size}"]
        lines += [f"plan = {json.dumps([step.text for step in best])}"]
    sys.stdout.write("\n".join([*lines, ""]))


if __name__ == "__main__":
    run_script(main)
