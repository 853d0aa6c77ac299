"""Tasks by grade: drawn, given quirks, certified, and drawn again until one fits; never quietly another one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from remac_env.errors import OptionError, SamplingError, check_choice, whole_number
from remac_env.generator import templates
from remac_env.generator.drawing import draw
from remac_env.generator.templates import Template
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.kitchen.stated import stated_scene, stated_world
from remac_env.options import KNOWLEDGE, MAX_ROBOTS
from remac_env.oracle import OraclePlan, certify, problem_id
from remac_env.oracle.bounds import make_bound
from remac_env.oracle.commands import relevant_nouns
from remac_env.oracle.witness import witness
from remac_env.rules.facts import Quirk, Rules
from remac_env.rules.knowledge import in_view
from remac_env.rules.quirks import QUIRKS
from remac_env.rules.rounds import transition
from remac_env.seeding import generator
from remac_env.state import WorldState
from remac_env.tasks.goals import Goal
from remac_env.tasks.spec import TaskSpec

GRADES = {1: 6, 2: 12, 3: 20, 4: 40, 5: 80}
"""Grade -> the most rounds that its shortest known plan has without its quirks; more than those of the grade below."""

MOST_QUIRKS = 3

EXACT_STATES = {1: 1_500, 2: 1_500}
"""States that the search for an optimum looks at, by grade; none for those where it would give up in any case."""

TRIES = 60
"""Draws until a task fits."""

TRIES_OF_A_KIND = 3
"""Quirks of one kind that are looked at for a task."""

LEEWAY = 2.5
"""Rounds after which an episode is truncated, as a multiple of the longest plan of its grade."""


@dataclass(frozen=True, kw_only=True)
class Certified:
    """A task, and what is proven about it.

    Attributes:
        plan: a plan that reaches the goal; a shortest one where `lower` equals `upper`.
        lower, upper: rounds that no plan is shorter than, and that `plan` has.
        proof: "search" - the plan is a shortest one; "witness" - it is one that works.
        hidden: facts that no sentence tells: quirks, and objects of the goal that nobody sees at the start.
        problem: tasks that differ only in looks and names share it.
    """

    spec: TaskSpec
    plan: OraclePlan
    lower: int
    upper: int
    proof: str
    hidden: int
    problem: str


def make(
    *,
    grade: int,
    seed: int,
    template: str | None = None,
    held_out: bool = False,
    quirks: int = 0,
    knowledge: str = "full",
    robots: int = 1,
) -> Certified:
    """The task of these values, with its certificate; the same for the same values, everywhere.

    Raises:
        UnknownNameError, OptionError: for values that are not valid.
        SamplingError: saying of each template why no task of it fits.
    """
    _check(grade, quirks, knowledge, robots)
    options = _templates(grade, template, held_out=held_out, robots=robots)
    rng = generator(seed, "generate", grade, template or held_out, quirks, knowledge, robots)
    why: dict[str, str] = {}
    for _ in range(TRIES):
        row = options[int(rng.integers(len(options)))]
        found = _attempt(row, grade, rng, quirks=quirks, knowledge=knowledge, robots=robots)
        if not isinstance(found, str):
            made = {"grade": grade, "seed": int(seed), "template": row.name, "quirks": quirks, "knowledge": knowledge,
                    "robots": robots}  # fmt: skip
            rounds = round(LEEWAY * GRADES[grade])
            return replace(found, spec=replace(found.spec, generated=made, rounds=rounds))
        why[row.name] = found
    told = "; ".join(f"{name}: {reason}" for name, reason in why.items())
    raise SamplingError(f"no task of grade {grade} (seed {seed}, quirks {quirks}, robots {robots}) was found: {told}")


def _check(grade: int, quirks: int, knowledge: str, robots: int) -> None:
    check_choice("grade", grade, GRADES)
    whole_number("quirks", quirks, 0, MOST_QUIRKS)
    whole_number("robots", robots, 1, MAX_ROBOTS)
    check_choice("knowledge", knowledge, KNOWLEDGE)


@lru_cache(maxsize=64)
def _templates(grade: int, template: str | None, *, held_out: bool, robots: int) -> tuple[Template, ...]:
    """The templates that a task may be drawn from."""
    if template is not None:
        row = templates.get(template)
        check_choice(f"grade of template {template!r}", grade, row.sizes)
        if row.team and robots < 2:
            raise OptionError(f"template {template!r} is a task for two; valid: robots=2 or more")
        return (row,)
    rows = [row for row in templates.load().values() if row.held_out == held_out and grade in row.sizes and not row.team]
    return tuple(rows)


def _attempt(
    row: Template, grade: int, rng: np.random.Generator, *, quirks: int, knowledge: str, robots: int
) -> Certified | str:
    """A task that fits, or why this one does not."""
    try:
        spec = draw(row, grade, rng)
    except SamplingError as error:
        return str(error)
    scene, world = scene_of(spec, robots, knowledge)
    if spec.goal.holds(scene, world):
        return "the goal held at the start"
    plan = witness(scene, world, spec.goal)
    if plan is None:
        return "no plan was found"
    # A grade is that of the kitchen without its quirks, so that the same task can be had with and without them.
    plain = _certified(spec, scene, world, plan, states=EXACT_STATES.get(grade, 0))
    if not GRADES.get(grade - 1, 0) < plain.upper <= GRADES[grade]:
        return f"its plan has {plain.upper} rounds"
    if not quirks:
        return plain
    found = _with_quirks(spec, plain.plan, rng, wanted=quirks, knowledge=knowledge, robots=robots)
    if found is None:
        return f"no {quirks} quirks were found that matter and can be got round"
    spec, plan = found
    return _certified(spec, *scene_of(spec, robots, knowledge), plan, states=EXACT_STATES.get(grade, 0))


def _certified(spec: TaskSpec, scene: Rules, world: WorldState, plan: OraclePlan, *, states: int) -> Certified:
    lower, proof = make_bound(scene, spec.goal)(world), "witness"
    if states:
        proven = certify(scene, world, spec.goal, max_rounds=plan.length, max_states=states)
        if proven.plan is not None and proven.plan.cost == proven.plan.length <= plan.length:
            plan = proven.plan
        lower = max(lower, proven.lower or 0)
        proof = "search" if proven.optimum == plan.length else proof
    objects = [name for name in spec.goal.names() if name in scene.objects]
    unseen = len(set(objects) - in_view(scene, world)) if scene.hides else 0
    return Certified(
        spec=spec, plan=plan, lower=min(lower, plan.length), upper=plan.length, proof=proof,
        hidden=len(spec.quirks) + unseen, problem=problem_id(scene, world, spec.goal),
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


def _with_quirks(
    spec: TaskSpec, plan: OraclePlan, rng: np.random.Generator, *, wanted: int, knowledge: str, robots: int
) -> tuple[TaskSpec, OraclePlan] | None:
    """The task with so many quirks, each of which makes the plan fail that knows of none, and a plan that works."""
    scene, world = scene_of(spec, robots, knowledge)
    mattering = [quirk for quirk in _candidates(scene, world, spec.goal, rng) if _spoils(scene, world, spec.goal, plan, quirk)]
    for first in range(min(len(mattering), 4)):
        chosen = _distinct([*mattering[first:], *mattering[:first]])[:wanted]
        if len(chosen) < wanted:
            return None
        quirky = replace(spec, quirks=(*spec.quirks, *chosen))
        there = replace(scene, quirks=quirky.quirks)
        found = witness(there, world, spec.goal)
        if found is not None:
            return quirky, found
    return None


def _candidates(scene: Rules, world: WorldState, goal: Goal, rng: np.random.Generator) -> Iterator[Quirk]:
    """Quirks about what can matter for the goal, in a drawn order."""
    objects, fixtures = relevant_nouns(scene, world, goal)
    near = {*objects, *fixtures, *(slot for name in fixtures for slot in scene.fixtures[name].slots)}
    found = [
        Quirk(kind.name, about, other)
        for kind in QUIRKS.values()
        if not kind.team
        for about, other in kind.draws(scene)
        if about in near
    ]
    kinds = list(dict.fromkeys(quirk.kind for quirk in found))
    for kind in rng.permutation(kinds) if kinds else ():
        of_kind = [quirk for quirk in found if quirk.kind == kind]
        yield from (of_kind[at] for at in rng.permutation(len(of_kind))[:TRIES_OF_A_KIND])


def _spoils(scene: Rules, world: WorldState, goal: Goal, plan: OraclePlan, quirk: Quirk) -> bool:
    """Whether a plan that would work fails where there is this quirk too."""
    there = replace(scene, quirks=(*scene.quirks, quirk))
    for joint in plan.rounds:
        world, _ = transition(there, world, joint)
    return not goal.holds(there, world)


def _distinct(quirks: Sequence[Quirk]) -> list[Quirk]:
    """One of each kind, and one about each fixture or object."""
    kept: list[Quirk] = []
    for quirk in quirks:
        if not any(quirk.kind == other.kind or quirk.about == other.about for other in kept):
            kept.append(quirk)
    return kept


def row_of(task: Certified) -> dict[str, Any]:
    """What an index says of a task."""
    return {**task.spec.generated, "problem": task.problem, "lower": task.lower, "upper": task.upper,
            "proof": task.proof, "hidden": task.hidden}  # fmt: skip
