"""One task drawn from a template: its objects, where they are, and the goal; not certified yet."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from remac_env.errors import SamplingError
from remac_env.generator import pools
from remac_env.generator.obstacles import crowd, mixed, put_away, put_back, shut_again
from remac_env.generator.placing import Room, doors_and_switches, place_members, place_others
from remac_env.generator.templates import Group, Template
from remac_env.kitchen import layout as layouts
from remac_env.kitchen import style as styles
from remac_env.kitchen.floor_plan import Layout
from remac_env.kitchen.objects import catalogue
from remac_env.kitchen.scene import build_scene
from remac_env.rules.facts import Rules
from remac_env.tasks.goals import VERBS
from remac_env.tasks.setup import Setup
from remac_env.tasks.spec import Role, TaskSpec

NAME = "Generated"

SPARE = ("bowl", "plate", "pan")
"""Vessels of which a kitchen has two that the task does not need, so that commands do not tell which it needs."""

FURTHER = 0.4
"""How often a task asks for one more object."""

OTHERS = (1, 4)
"""Least and most other objects that stand about, as far as there is room."""


def draw(template: Template, grade: int, rng: np.random.Generator) -> TaskSpec:
    """A task from a template.

    Raises:
        SamplingError: naming what has no room, or that a pool has too few objects.
    """
    families = (template.family,) if template.family else ()
    style, name = str(rng.choice(styles.names())), str(rng.choice(layouts.names(*families)))
    size = int(rng.integers(template.sizes[grade][0], template.sizes[grade][1] + 1))
    members = {group.kind: _members(template, group, size, rng) for group in template.groups}
    objects = {noun: pools.load()[kind][noun] for kind, nouns in members.items() for noun in nouns}
    layout = layouts.load(name, styles.load(style).models)
    bare = build_scene(layout, {}, (), annexes=template.annexes, gives=template.gives)
    room = Room(bare, [slot for n in bare.fixtures if n in layout.fixtures and layout.fixtures[n].worktop
                       for slot in bare.fixtures[n].slots], _too_big(template, layout))  # fmt: skip
    away = put_away(template, members, grade, rng)
    places = place_members(template, members, room, rng, away=away)
    filling = crowd(template, members, grade, room, _pool(template, objects), rng)
    places |= filling
    objects |= {noun: _pool(template, objects)[noun] for noun in filling}
    others = _others(template, objects, room.left, rng)
    places |= place_others(others, room, rng)
    objects |= {noun: category for noun, category in others.items() if noun in places}
    doors, on = doors_and_switches(template, bare, places, rng, away=away)
    further = shut_again(template, bare, doors, [places[noun] for noun in away], grade, rng)
    further = further or _further(template, bare, rng)
    clauses = [*template.goal, *put_back(bare, filling, template, grade, rng), *further]
    goal = template.goal_of(members, clauses)
    order, end = mixed(clauses, grade, rng)
    said = tuple(template.goal_of(members, order).told(wording) + end for wording in (1, 2, 3))
    return TaskSpec(
        name=NAME,
        wordings=(said[0], said[1], said[2]),
        goal=goal,
        roles=tuple(Role(noun.replace(" ", "_"), (noun,)) for noun in objects),
        fixtures=tuple(dict.fromkeys(n for n in goal.names() if n in bare.fixtures)),
        verbs=_verbs(template, bare),
        styles=(style,),
        layouts=(name,),
        nouns=pools.nouns(),
        annexes=template.annexes,
        gives=template.gives,
        orders=template.orders,
        quirks=(template.team,) if template.team else (),
        setup=Setup(objects, places, doors, on),
    )


def _members(template: Template, group: Group, size: int, rng: np.random.Generator) -> tuple[str, ...]:
    """The objects of a group."""
    pool, wanted = list(pools.load()[group.kind]), group.n or size
    if wanted > len(pool):
        raise SamplingError(f"template {template.name!r}: {wanted} of kind {group.kind!r}, and there are {len(pool)}")
    return tuple(pool[at] for at in rng.permutation(len(pool))[:wanted])


def _too_big(template: Template, layout: Layout) -> dict[str, frozenset[str]]:
    """Object -> the kinds of fixtures that it does not go into, of templates that physics can have."""
    if not template.family:
        return {}
    kinds = {noun: catalogue.get(name) for pool in pools.load().values() for noun, name in pool.items()}
    things = build_scene(layout, kinds | {name: catalogue.get(name) for name in SPARE}, ()).objects
    return {noun: facts.too_big_for | facts.too_deep_in for noun, facts in things.items()}


def _further(template: Template, scene: Rules, rng: np.random.Generator) -> list[dict[str, str]]:
    """Perhaps a further clause: a door that is to be shut or open in the end, where nothing else is asked of it."""
    doors = [name for name, facts in scene.fixtures.items() if facts.door and name not in template.named]
    if template.team or not doors or rng.random() > FURTHER:
        return []
    return [{str(rng.choice(("shut", "opened"))): str(rng.choice(doors))}]


def _others(template: Template, objects: Mapping[str, str], room: int, rng: np.random.Generator) -> dict[str, str]:
    """Objects that the task does not need: vessels first, then some of other kinds."""
    kinds = {group.kind for group in template.groups}
    used = set(objects.values())
    spare = [name for name in SPARE if name not in used and name not in kinds]
    pool = list(_pool(template, objects).items())
    count = int(rng.integers(OTHERS[0], OTHERS[1] + 1))
    drawn = [pool[at] for at in rng.permutation(len(pool))[:count]]
    return dict(([(name, name) for name in spare[:2]] + drawn)[: max(0, room)])


def _pool(template: Template, objects: Mapping[str, str]) -> dict[str, str]:
    """Objects that the task does not need, none of a kind or category that it does; no vessels."""
    kinds, used = {group.kind for group in template.groups}, set(objects.values())
    pool = [(noun, c) for kind, nouns in pools.load().items() if kind not in kinds for noun, c in nouns.items()]
    return {noun: c for noun, c in pool if c not in used and not catalogue.load()[c].holds}


def _verbs(template: Template, scene: Rules) -> dict[str, tuple[str, ...]]:
    """The commands that the verbs of its goal imply: a switch that gives water, or one of those that give the mark."""
    found: dict[str, tuple[str, ...]] = {}
    given = {facts.gives: facts for facts in scene.givers if facts.switches}
    for mark in template.gives:
        if mark in given and mark in VERBS:
            found[VERBS[mark]] = (f"turn on {given[mark].name}",)
    taps = [name for name, facts in scene.fixtures.items() if facts.wets]
    if "washed" in template.gives and taps and "wash" not in found:
        found["wash"] = (f"turn on {taps[0]}",)
    return found
