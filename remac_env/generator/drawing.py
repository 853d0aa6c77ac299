"""One task drawn from a template: its objects, where they are, and the goal; not certified yet."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from remac_env.errors import SamplingError
from remac_env.generator import pools
from remac_env.generator.templates import HIDDEN, Group, Template
from remac_env.kitchen import layout as layouts
from remac_env.kitchen import style as styles
from remac_env.kitchen.objects import catalogue
from remac_env.kitchen.scene import build_scene
from remac_env.rules.facts import Rules
from remac_env.state import Place
from remac_env.tasks.goals import VERBS
from remac_env.tasks.setup import Setup
from remac_env.tasks.spec import Role, TaskSpec

NAME = "Generated"

FREE = 2
"""Slots in the open that stay free, so that whatever is in the way can be put down."""

SPARE = ("bowl", "plate", "pan")
"""Vessels of which a kitchen has two that the task does not need, so that commands do not tell which it needs."""

OTHERS = (1, 3)
"""Least and most other objects that stand about, as far as there is room."""


def draw(template: Template, grade: int, rng: np.random.Generator) -> TaskSpec:
    """A task from a template.

    Raises:
        SamplingError: naming what has no room, or that a pool has too few objects.
    """
    style, name = str(rng.choice(styles.names())), str(rng.choice(layouts.names()))
    size = int(rng.integers(template.sizes[grade][0], template.sizes[grade][1] + 1))
    members = {group.kind: _members(template, group, size, rng) for group in template.groups}
    objects = {noun: pools.load()[kind][noun] for kind, nouns in members.items() for noun in nouns}
    layout = layouts.load(name, styles.load(style).models)
    bare = build_scene(layout, {}, (), annexes=template.annexes)
    open_slots = [slot for n in bare.fixtures if n in layout.fixtures and layout.fixtures[n].worktop
                  for slot in bare.fixtures[n].slots]  # fmt: skip
    places = dict(_placed(template, members, bare, open_slots, rng))
    used = {place.where for place in places.values()}
    objects |= _others(template, objects, len([slot for slot in open_slots if slot not in used]) - FREE, rng)
    left = [slot for slot in open_slots if slot not in used]
    rest = [noun for noun in objects if noun not in places]
    places |= {noun: Place("slot", left[at]) for noun, at in zip(rest, rng.permutation(len(left)), strict=False)}
    goal = template.goal_of(members)
    said = tuple(goal.told(wording) for wording in (1, 2, 3))
    on = {n: (bare.fixtures[n].switches[0],) for n in template.on}
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
        setup=Setup(objects, places, dict(template.doors), on),  # type: ignore[arg-type]
    )


def _members(template: Template, group: Group, size: int, rng: np.random.Generator) -> tuple[str, ...]:
    """The objects of a group."""
    pool, wanted = list(pools.load()[group.kind]), group.n or size
    if wanted > len(pool):
        raise SamplingError(f"template {template.name!r}: {wanted} of kind {group.kind!r}, and there are {len(pool)}")
    return tuple(pool[at] for at in rng.permutation(len(pool))[:wanted])


def _placed(
    template: Template, members: Mapping[str, tuple[str, ...]], scene: Rules, open_slots: list[str], rng: np.random.Generator
) -> Iterator[tuple[str, Place]]:
    """A place of its own for each object that the task needs."""
    stores = [n for n, f in scene.fixtures.items() if f.door and f.slots and n not in template.named and not f.switches]
    taken: set[str] = set()
    for group in template.groups:
        for noun in members[group.kind]:
            at = str(rng.choice(list(group.at)))
            names = stores if at == HIDDEN else [at]
            slots = [slot for n in names for slot in scene.fixtures[n].slots if slot not in taken]
            if at == "counter":
                slots = [slot for slot in open_slots if slot not in taken]
            if len(slots) <= (FREE if slots and slots[0] in open_slots else 0):
                where = "behind a shut door" if at == HIDDEN else f"at the {at}"
                raise SamplingError(f"template {template.name!r}: no room {where} for the {noun} ({len(taken)} are placed)")
            slot = slots[int(rng.integers(len(slots)))]
            taken.add(slot)
            yield noun, Place("slot", slot)


def _others(template: Template, objects: Mapping[str, str], room: int, rng: np.random.Generator) -> dict[str, str]:
    """Objects that the task does not need: vessels first, then some of other kinds."""
    kinds = {group.kind for group in template.groups}
    used = set(objects.values())
    spare = [name for name in SPARE if name not in used and name not in kinds]
    pool = [(noun, c) for kind, nouns in pools.load().items() if kind not in kinds for noun, c in nouns.items()]
    pool = [(noun, c) for noun, c in pool if c not in used and not catalogue.load()[c].holds]
    count = int(rng.integers(OTHERS[0], OTHERS[1] + 1))
    drawn = [pool[at] for at in rng.permutation(len(pool))[:count]]
    chosen = [(name, name) for name in spare[:2]] + drawn
    return dict(chosen[: max(0, room)])


def _verbs(template: Template, scene: Rules) -> dict[str, tuple[str, ...]]:
    """The commands that the verbs of its goal imply: a switch that gives water, or one of those that give the mark."""
    found: dict[str, tuple[str, ...]] = {}
    given: dict[str, Any] = {facts.gives: facts for facts in _givers(scene) if facts.switches}
    for mark in template.gives:
        if mark in given and mark in VERBS:
            found[VERBS[mark]] = (f"turn on {given[mark].name}",)
    taps = [name for name, facts in scene.fixtures.items() if facts.wets]
    if "washed" in template.gives and taps and "wash" not in found:
        found["wash"] = (f"turn on {taps[0]}",)
    return found


def _givers(scene: Rules) -> Iterator[Any]:
    yield from scene.givers
