"""A generated task, and what is proven about it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from remac_env.errors import OptionError
from remac_env.generator.obstacles import untold
from remac_env.kitchen.stated import stated_scene, stated_world
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.oracle import OraclePlan, problem_id, shortest, solvable
from remac_env.oracle.bounds import make_bound
from remac_env.rules.facts import Rules
from remac_env.rules.knowledge import in_view
from remac_env.rules.subtasks import WAIT
from remac_env.state import WorldState
from remac_env.tasks.spec import TaskSpec

ALONE_STATES = 20_000
"""States that the search looks at which proves that one robot cannot reach a part of a goal."""


@dataclass(frozen=True, kw_only=True)
class Certified:
    """A task, and what is proven about it.

    Attributes:
        plan: a plan that reaches the goal; a shortest one where `lower` equals `upper`.
        lower, upper: rounds that no plan is shorter than, and that `plan` has.
        proof: "search" - the plan is a shortest one; "witness" - it is one that works.
        hidden: facts that no sentence tells: quirks, and objects of the goal that nobody sees at the start.
        untold: things in the way that no sentence tells, for those who know everything too (`obstacles.untold`).
        problem: tasks that differ only in looks and names share it.
    """

    spec: TaskSpec
    plan: OraclePlan
    lower: int
    upper: int
    proof: str
    hidden: int
    untold: int
    problem: str

    @property
    def told(self) -> dict[str, Any]:
        """What is proven, as values of JSON."""
        names = ("lower", "upper", "proof", "hidden", "untold", "problem")
        return {name: getattr(self, name) for name in names}


def certified(spec: TaskSpec, scene: Rules, world: WorldState, plan: OraclePlan, *, states: int) -> Certified:
    """The task with a plan that works, and with a shortest one and bounds as far as a search of so many states goes."""
    lower, proof = make_bound(scene, spec.goal)(world), "witness"
    if states:
        found = shortest(scene, world, spec.goal, max_rounds=plan.length, max_states=states)
        lower = max(lower, found.lower)
        if found.plan is not None and not found.gave_up and found.plan.cost == found.plan.length:
            plan, proof = found.plan, "search"
    objects = [name for name in spec.goal.names() if name in scene.objects]
    unseen = len(set(objects) - in_view(scene, world)) if scene.hides else 0
    return Certified(
        spec=spec, plan=plan, lower=lower, upper=plan.length, proof=proof,
        hidden=len(spec.quirks) + unseen, untold=untold(scene, world, spec.goal),
        problem=problem_id(scene, world, spec.goal),
    )  # fmt: skip


def scene_of(spec: TaskSpec, robots: int, knowledge: str) -> tuple[Rules, WorldState]:
    """The kitchen of a task with a stated start, and its world."""
    if spec.setup is None:
        raise OptionError(f"task {spec.name} has no setup; valid: one that `generate` made")
    names = tuple(f"robot_{index}" for index in range(robots))
    worlds = TaskWorlds(spec)
    layout = worlds.layout(spec.layouts[0], spec.styles[0])
    scene = stated_scene(spec, layout, worlds.categories, names, knowledge=knowledge)
    return scene, stated_world(scene, spec.setup)


def beyond_one(spec: TaskSpec) -> bool:
    """Whether it is proven that one robot cannot do it: some part of the goal is out of its reach, however long it
    tries. What cannot be followed to its end is not proven."""
    scene, world = scene_of(spec, 1, "full")
    return any(solvable(scene, world, part, max_states=ALONE_STATES) is False for part in spec.goal.atoms())


def with_others(task: Certified, robots: int, knowledge: str) -> Certified:
    """The task for so many robots, of which one does what the plan for one says; what is proven is proven anew."""
    scene, world = scene_of(task.spec, robots, knowledge)
    worker = min(scene.robots)
    waits = {name: WAIT for name in scene.robots if name != worker}
    rounds = tuple({worker: next(iter(joint.values())), **waits} for joint in task.plan.rounds)
    lower = make_bound(scene, task.spec.goal)(world)
    proof = "search" if lower == task.upper else "witness"
    return replace(task, plan=replace(task.plan, rounds=rounds), lower=lower, proof=proof)
