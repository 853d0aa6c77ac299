"""Quirks for a task: those that make a plan fail that knows of none, and that can be got round."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

import numpy as np

from remac_env.generator.certified import scene_of
from remac_env.oracle import OraclePlan
from remac_env.oracle.commands import relevant_nouns
from remac_env.oracle.witness import witness
from remac_env.rules.facts import Quirk, Rules
from remac_env.rules.quirks import QUIRKS
from remac_env.rules.rounds import transition
from remac_env.state import WorldState, base_place
from remac_env.tasks.goals import Goal
from remac_env.tasks.spec import TaskSpec

TRIES_OF_A_KIND = 3
"""Quirks of one kind that are looked at for a task."""


def with_quirks(
    spec: TaskSpec, plan: OraclePlan, rng: np.random.Generator, *, wanted: int, knowledge: str, robots: int
) -> tuple[TaskSpec, OraclePlan] | None:
    """The task with so many quirks, each of which makes the plan fail that knows of none, and a plan that works."""
    scene, world = scene_of(spec, robots, knowledge)
    full = () if spec.symbolic_only else in_stores(scene, world)
    near = _candidates(scene, world, spec.goal, full, rng)
    mattering = [quirk for quirk in near if _spoils(scene, world, spec.goal, plan, quirk)]
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


def _candidates(
    scene: Rules, world: WorldState, goal: Goal, occupied: Collection[str], rng: np.random.Generator
) -> Iterator[Quirk]:
    """Quirks about what can matter for the goal, in a drawn order; nothing fills what is `occupied`."""
    objects, fixtures = relevant_nouns(scene, world, goal)
    near = {*objects, *fixtures, *(slot for name in fixtures for slot in scene.fixtures[name].slots)}
    found = [
        Quirk(kind.name, about, other)
        for kind in QUIRKS.values()
        if not kind.team
        for about, other in kind.draws(scene)
        if about in near and not (kind.fills and about in occupied)
    ]
    kinds = list(dict.fromkeys(quirk.kind for quirk in found))
    for kind in rng.permutation(kinds) if kinds else ():
        of_kind = [quirk for quirk in found if quirk.kind == kind]
        yield from (of_kind[at] for at in rng.permutation(len(of_kind))[:TRIES_OF_A_KIND])


def in_stores(scene: Rules, world: WorldState) -> frozenset[str]:
    """The fixtures in which an object is at the start; there is no room there for what would fill them."""
    places = (base_place(world, name) for name in world.objects)
    return frozenset(scene.slots[place.where].fixture for place in places if place.relation == "slot")


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
