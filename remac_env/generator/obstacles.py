"""What is in the way of a task from grade 3 on, and no sentence tells: objects put away, and places that are full.

Who reads the goal alone does not know of it, and each kind asks for something else: a door to be opened before an
object can be taken, something to be taken out before another goes in, or another place to be used. In grade 5 what was
in the way has to be back in the end, doors have to be shut, and the sentence says nothing of the order of it all.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from remac_env.generator.placing import Room, stores
from remac_env.generator.templates import Clause, Template
from remac_env.oracle.commands import to_mark
from remac_env.rules.facts import FixtureFacts, Rules
from remac_env.rules.marks import WASHED
from remac_env.state import Door, Place, WorldState, base_place, inside, occupant
from remac_env.tasks.compound import AnyOf
from remac_env.tasks.goals import Goal, Inside

AWAY = {3: 1, 4: 2, 5: 3}
"""Grade -> how many of its objects are put away behind doors, as far as there is room."""

FULL = {3: (0.6,), 4: (0.8, 0.4), 5: (1.0, 1.0)}
"""Grade -> how often a place that it needs is full, and how often another one is too."""

SHUT_AGAIN = {4: (0.5, 1), 5: (1.0, 3)}
"""Grade -> how often doors that are shut at the start are to be shut in the end, and how many at most."""

PUT_BACK = {5: 2}
"""Grade -> how many of the things that fill what gives a mark, and has no door, are to be back in the end, at most."""

MIXED = (5,)
"""Grades whose sentences do not have their clauses in an order in which they can be reached, and say so."""

ANY_ORDER = ", in whatever order that takes"
"""How they say so."""

MOST_FILLING = 8
"""Objects that fill a place at most."""


def obstructed(template: Template, grade: int) -> bool:
    """Whether tasks of this template and grade have something in their way: a team's quirk is enough, and so is what
    physics has."""
    return grade in AWAY and not template.team and not template.family


def put_away(
    template: Template, members: Mapping[str, Sequence[str]], grade: int, rng: np.random.Generator
) -> tuple[str, ...]:
    """The objects that are behind doors wherever the template has them."""
    if not obstructed(template, grade):
        return ()
    nouns = [noun for names in members.values() for noun in names]
    return tuple(nouns[at] for at in rng.permutation(len(nouns))[: AWAY[grade]])


def crowd(
    template: Template,
    members: Mapping[str, Sequence[str]],
    grade: int,
    room: Room,
    pool: Mapping[str, str],
    rng: np.random.Generator,
) -> dict[str, Place]:
    """Objects from a pool, in places that the task needs: so many that those do not take all that is to go in."""
    if not obstructed(template, grade):
        return {}
    needed = list(_needed(template, members, room.scene))
    nouns = [list(pool)[at] for at in rng.permutation(len(pool))][:MOST_FILLING]
    filling: dict[str, Place] = {}
    for often, at in zip(FULL[grade], rng.permutation(len(needed)), strict=False):
        name, wanted = needed[at]
        count = len(room.free([name])) - wanted + 1
        if rng.random() < often and 0 < count <= len(nouns):
            filling |= {nouns.pop(): room.take(room.free([name]), rng) for _ in range(count)}
    return filling


def shut_again(
    template: Template, scene: Rules, doors: Mapping[str, Door], away: Sequence[Place], grade: int,
    rng: np.random.Generator,
) -> list[dict[str, str]]:  # fmt: skip
    """Perhaps clauses, where something is put away: stores that are shut at the start are to be shut in the end,
    whether or not they hide anything: of those that do alone the sentence would tell where to look.

    Args:
        doors: those that are not shut.
        away: where what is put away is.
    """
    often, most = SHUT_AGAIN.get(grade, (0.0, 0))
    hidden = any(scene.fixtures[scene.slots[place.where].fixture].door for place in away)
    if not hidden or rng.random() >= often:
        return []
    shut = [name for name in stores(scene, template) if name not in doors]
    return [{"shut": str(name)} for name in rng.choice(shut, size=min(most, len(shut)), replace=False)]


def put_back(
    scene: Rules, filling: Mapping[str, Place], template: Template, grade: int, rng: np.random.Generator
) -> list[dict[str, str]]:
    """Clauses: what fills an open fixture that gives a mark is to be there in the end, as it is at the start. Of what
    is behind a door the sentence would tell what nobody has seen."""
    if grade not in PUT_BACK:
        return []
    giving = {facts.name for mark in template.gives for facts in _givers(scene, mark) if not facts.door}
    at = {noun: scene.slots[place.where].fixture for noun, place in filling.items()}
    there = [noun for noun in at if at[noun] in giving]
    return [{"keep": there[n], "into": at[there[n]]} for n in rng.permutation(len(there))[: PUT_BACK[grade]]]


def mixed(clauses: Sequence[Clause], grade: int, rng: np.random.Generator) -> tuple[list[Clause], str]:
    """The clauses as the sentence has them, in another order than that in which they can be reached, and its end."""
    if grade not in MIXED or len(clauses) < 2:
        return list(clauses), ""
    order = list(range(len(clauses)))
    while order == sorted(order):
        order = [int(at) for at in rng.permutation(len(clauses))]
    return [clauses[at] for at in order], ANY_ORDER


def _needed(
    template: Template, members: Mapping[str, Sequence[str]], scene: Rules
) -> Iterator[tuple[str, int]]:
    """(fixture, how many objects it has to take): where objects go that have no other place, and what gives marks."""
    for clause in template.goal:
        if "all" not in clause or "into" not in clause:
            continue
        into = clause["into"]
        first = str(into if isinstance(into, str) else into[0])
        if first in scene.fixtures and not scene.fixtures[first].switches:
            yield first, len(members[clause["all"]])
    for mark in template.gives:
        for facts in _givers(scene, mark):
            yield facts.name, 1


def _givers(scene: Rules, mark: str) -> Iterator[FixtureFacts]:
    """The fixtures that leave a mark on what is in them; for water the basins."""
    yield from (facts for facts in scene.givers if facts.gives == mark and facts.slots)
    if mark == WASHED:
        yield from (scene.fixtures[name] for _, under in scene.taps for name in under)


def untold(scene: Rules, world: WorldState, goal: Goal) -> int:
    """How many things are in the way that no sentence tells.

    Each object of the goal behind a door that is not open, each place to which the goal has objects go (of several the
    one that it names first) with less room than they take, and each fixture that gives a wanted mark and is full.
    """
    names = [name for name in goal.names() if name in scene.objects]
    shut = sum(_behind(scene, world, name) for name in names)
    going: dict[str, int] = {}
    for part in _places(goal):
        if part.container in scene.fixtures and not inside(scene, world, part.name, part.container):
            going[part.container] = going.get(part.container, 0) + 1
    full = sum(count > _free(scene, world, name) for name, count in going.items())
    marks = {facts.gives for facts in scene.givers} | {WASHED}
    giving = {facts.name for mark in marks if to_mark(goal, mark) for facts in _givers(scene, mark)}
    return shut + full + sum(_free(scene, world, name) == 0 for name in giving - set(going))


def _behind(scene: Rules, world: WorldState, name: str) -> bool:
    place = base_place(world, name)
    return place.relation == "slot" and world.fixtures[scene.slots[place.where].fixture].door not in (None, "open")


def _free(scene: Rules, world: WorldState, fixture: str) -> int:
    return sum(occupant(world, slot) is None for slot in scene.fixtures[fixture].slots)


def _places(goal: Goal) -> Iterator[Inside]:
    """The places to which the goal has objects go."""
    for atom in goal.atoms():
        if isinstance(atom, AnyOf):
            atom = atom.goals[0]
        if isinstance(atom, Inside):
            yield atom
