"""Starts of one skill: the kitchen of a task in which the skill can begin, and what brings the robot there.

Doors and switches stand as the skill needs them from the beginning; the robot itself drives to its station, and takes
into its hand what it is to hold, by the scripted skills. Where something is to be put into a vessel that stands neither
on a worktop nor in a plain start, the robot has put that there too, as it has in tasks: never quite in the middle.
Some of what is handled it has had in its hand before and laid down again, so that it lies as a hand has left it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.backends.physics.controllers.learned.cases import EMPTY_HANDED, IN_VESSEL, case_of
from remac_env.errors import SamplingError, UnknownNameError, check_choice
from remac_env.kitchen.fixtures.door import OPEN_TO
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.lowlevel.options import targets
from remac_env.oracle import search_plan
from remac_env.robots.bodies import STANDARD
from remac_env.rules.claims import first_false
from remac_env.rules.facts import Rules
from remac_env.rules.places import kind_around, landing
from remac_env.rules.scene import public_scene
from remac_env.rules.skill_row import Skill
from remac_env.rules.skills import SKILLS
from remac_env.rules.subtasks import Subtask
from remac_env.seeding import generator
from remac_env.start import Start
from remac_env.state import WorldState
from remac_env.tasks import BUILT_IN, known
from remac_env.tasks import get as get_task
from remac_env.tasks.spec import TaskSpec

ROBOT = "robot_0"
_TRIES = 100  # starts drawn until one has the target and the robot gets ready in it
_RARER = 10  # times as many where only some cases are wanted
_PLAIN = 30  # of these are as tasks have them by default; mixed starts have what is rarer, as a pan on the stove
_MOST = 2_000  # states that the search for what comes before looks at
_SEEDS = 100_000  # of the starts that are drawn where the first is of no use
_FROM_PARKING = 0.5  # of the drives begin at a parking place, the others at a station
_TAKEN_AGAIN = 0.25  # of what is handled has been taken and laid down before


@dataclass(frozen=True)
class Ready:
    """A kitchen in which the skill can begin now: its task, the start, and what the robot has done since.

    ``case``: what is handled where, see `case_of`.
    """

    worlds: TaskWorlds
    start: Start
    subtask: Subtask
    before: tuple[Subtask, ...]
    case: str


def get_ready(
    backend_of: dict[str, PhysicsBackend], skill: Skill, target: str | None, seed: int, *, style: str | None,
    layout: str | None, body: str = STANDARD, make: Callable[[TaskWorlds], PhysicsBackend] = PhysicsBackend,
    cases: Sequence[str] = (),
) -> tuple[Ready, PhysicsBackend]:
    """The start of this seed, played up to where the skill begins: a pure function of all but ``backend_of``.

    Args:
        backend_of: task -> the backend in which its kitchens are played; filled here, to be used again.
        make: makes such a backend.
        cases: only starts in one of these, see `case_of`; empty: any. Those of mixed starts come last.

    Raises:
        UnknownNameError: for an unknown target, style or layout.
        SamplingError: if no start is found in which this skill can begin.
    """
    if target is not None:
        check_choice(f"target of {skill.name!r}", target, targets(skill))
    for attempt in range(_TRIES * _RARER if cases else _TRIES):
        chance = generator(seed, "skill", skill.name, target, attempt)
        drawn = seed if attempt == 0 else int(chance.integers(_SEEDS))
        kind = "mixed" if cases and attempt >= _PLAIN else "paper"
        ready = _draw(skill, target, drawn, chance, kind=kind, style=style, layout=layout, body=body, cases=cases)
        if ready is None or (cases and ready.case not in cases):
            continue
        backend = backend_of.setdefault(ready.worlds.spec.name, make(ready.worlds))
        backend.reset(ready.start)
        if all(backend.run_round({ROBOT: subtask}).outcomes[ROBOT].success for subtask in ready.before) and _may_begin(
            ready.start.scene, backend.world, ready.subtask
        ):
            return ready, backend
    where = f" in layout {layout}" if layout else ""
    raise SamplingError(f"{skill.name} {target or 'anything'}{where}: no start was found in which it can begin")


def _draw(
    skill: Skill, target: str | None, seed: int, chance: np.random.Generator, *, kind: str,
    style: str | None, layout: str | None, body: str, cases: Sequence[str] = (),
) -> Ready | None:
    """A start of this kind with what comes before, or None where this one does not do."""
    worlds = TaskWorlds(_one(_kitchens(skill, target), chance))
    worlds.check_cell(style, layout)
    try:
        start, _ = worlds.start(
            seed, style=style, layout=layout, starts=kind, robots=(ROBOT,), perception_noise=0.0, body=body
        )
    except (SamplingError, UnknownNameError):
        return None  # this layout lacks what the task needs; another task may do
    if skill.tool is not None and not any(map(skill.tool, start.scene.objects.values())):
        return None
    names = [name for name in public_scene(start.scene).names(skill.target) if name in targets(skill)]  # type: ignore[arg-type]
    if target is None:
        names = [names[index] for index in chance.permutation(len(names))]
    laden = bool(cases) and EMPTY_HANDED not in cases
    laid = _laid(worlds, start, cases) if skill.puts and kind == "paper" else ()
    for name in names if target is None else [target] * (target in names):
        found = _brought_about(start, Subtask(skill.name, name), chance, laden=laden, laid=laid)
        if found is not None:
            start, before = found
            if skill.moves and not before and chance.random() >= _FROM_PARKING:
                before = (_elsewhere(start.scene, name, chance), *before)
            begun = Subtask(skill.name, name)
            if (skill.takes or skill.puts) and chance.random() < _TAKEN_AGAIN:
                before = _taken_again(start.scene, start.world, (*before, begun))[:-1]
            case = _case(worlds, start, begun, before)
            if kind == "mixed" and case not in cases:
                continue
            return Ready(worlds, start, begun, before, case)
    return None


def _taken_again(scene: Rules, world: WorldState, steps: Sequence[Subtask]) -> tuple[Subtask, ...]:
    """These steps, with what is taken last put back to where it was and taken once more, if it can be put there."""
    last = max(index for index, step in enumerate(steps) if step.row.takes)
    for step in steps[:last]:
        world = step.row.after(scene, world, ROBOT, step.target)
    take = steps[last]
    place = world.objects[take.target].place
    held = take.row.after(scene, world, ROBOT, take.target)
    put = next(skill for skill in SKILLS.values() if skill.puts)
    if place.relation != "slot" or scene.slots[place.where].fixture not in public_scene(scene).names(put.target):  # type: ignore[arg-type]
        return tuple(steps)
    back = Subtask(put.name, scene.slots[place.where].fixture)
    return (*steps[:last], take, back, *steps[last:]) if _may_begin(scene, held, back) else tuple(steps)


def _laid(worlds: TaskWorlds, start: Start, cases: Sequence[str]) -> tuple[str, ...]:
    """The fixtures on or in which a vessel is to stand in these cases; those where one stands by itself left out."""
    kinds = [case.partition(IN_VESSEL)[2] for case in cases if IN_VESSEL in case]
    layout = worlds.layout_of(start)
    return tuple(dict.fromkeys(s.fixture for s in layout.slots.values() if s.kind in kinds and s.kind != "surface"))


def _kitchens(skill: Skill, target: str | None) -> list[TaskSpec]:
    """The tasks in whose kitchens to look: of the table, where no tool is needed; from outside, where they alone do."""
    built_in = [get_task(name) for name in BUILT_IN]
    if target is None:
        found = built_in
    else:
        found = [spec for spec in built_in if _speaks_of(spec, target)]
        found = found or [spec for spec in map(get_task, known()) if _speaks_of(spec, target)] or built_in
    return [spec for spec in found if spec.in_table and skill.tool is None] or found


def _speaks_of(spec: TaskSpec, target: str) -> bool:
    """Whether a task's kitchens have the target for certain, or at least often."""
    return target in (*spec.fixtures, *(noun for role in spec.roles for noun in role.nouns))


def _brought_about(
    start: Start, subtask: Subtask, chance: np.random.Generator, *, laden: bool, laid: Sequence[str] = ()
) -> tuple[Start, tuple[Subtask, ...]] | None:
    """The start with doors and switches as the skill needs them, and what the robot does before it; None: no way.

    ``laden``: a drive is to begin with something in the hand. ``laid``: in one of these fixtures the vessel is to stand
    into which something is put; the robot puts it there.
    """
    scene = start.scene
    names = list(scene.objects)
    empty = [] if laden and subtask.moves else [None]
    for held in (*empty, *(names[index] for index in chance.permutation(len(names)))):
        before = _plan(scene, start.world, subtask, held, laid)
        if before is None:
            continue
        world, doors = start.world, dict(start.doors)
        for step in before:
            if (after := _of_fixtures(scene, world, step)) is not None:
                world = after
        for name, state in world.fixtures.items():
            if state.door != start.world.fixtures[name].door:
                doors[name] = OPEN_TO if state.door == "open" else 0.0
        changed = replace(start, world=world, doors=doors)
        rest = _plan(scene, world, subtask, held, laid)
        if rest is not None and all(_of_fixtures(scene, world, step) is None for step in rest):
            return changed, rest
    return None


def _case(worlds: TaskWorlds, start: Start, subtask: Subtask, before: Sequence[Subtask]) -> str:
    """The case of a skill, as far as the skill table knows what comes of what is done before it."""
    world = start.world
    for step in before:
        world = step.row.after(start.scene, world, ROBOT, step.target)
    objects = {noun: worlds.categories[name] for noun, name in start.categories.items()}
    return case_of(subtask, start.scene, worlds.layout_of(start), objects, world, ROBOT)


def _of_fixtures(scene: Rules, world: WorldState, step: Subtask) -> WorldState | None:
    """The world after a step that changes fixtures alone; None for another."""
    if step.row.effect is None or step.row.goes is not None or step.row.puts:
        return None
    after = step.row.effect(scene, world, ROBOT, step.target)
    return after if after.robots == world.robots and after.objects == world.objects else None


def _plan(
    scene: Rules, world: WorldState, subtask: Subtask, held: str | None, laid: Sequence[str]
) -> tuple[Subtask, ...] | None:
    """The fewest subtasks after which the skill can begin with this in hand, or None."""

    def reached(state: WorldState) -> bool:
        ready = state.robots[ROBOT].holding == held and _may_begin(scene, state, subtask)
        return ready and (not laid or _into_laid(scene, state, subtask, laid))

    found = search_plan(
        scene, world, reached, commands=_commands(scene, world, subtask, held, laid), max_states=_MOST, max_rounds=8
    )
    return None if found is None else tuple(joint[ROBOT] for joint in found.rounds)


def _into_laid(scene: Rules, world: WorldState, subtask: Subtask, laid: Sequence[str]) -> bool:
    """Whether what is held would be put into a vessel that stands in one of these fixtures."""
    place = landing(scene, world, ROBOT, subtask.target)
    if place is None or place.relation != "vessel":
        return False
    under = world.objects[place.where].place
    return under.relation == "slot" and scene.slots[under.where].fixture in laid


def _commands(
    scene: Rules, world: WorldState, subtask: Subtask, held: str | None, laid: Sequence[str]
) -> list[Subtask]:
    """What can help: everything about the target, what is around it, and what is to be held; to put down only vessels
    where they are to be laid.
    """
    nouns = [subtask.target] if held is None else [subtask.target, held]
    if laid:
        nouns += [*laid, *(name for name, facts in scene.objects.items() if facts.vessel_in)]
    kinds = [kind_around(scene, world, noun) for noun in nouns]
    nouns += [name for name, facts in scene.fixtures.items() if facts.kind in kinds]
    kitchen = public_scene(scene)
    return [
        Subtask(skill.name, noun)
        for skill in SKILLS.values()
        for noun in dict.fromkeys(nouns)
        if skill.target != "none" and (not skill.puts or noun in laid) and not skill.leaves
        and noun in kitchen.names(skill.target)
    ]  # fmt: skip


def _may_begin(scene: Rules, world: WorldState, subtask: Subtask) -> bool:
    """Whether nothing speaks against it; of a drive, that it is not there yet."""
    if subtask.moves and all(c.holds(scene, world) for c in subtask.achieves(ROBOT, None)):
        return False
    return all(first_false(scene, world, ROBOT, subtask, mark) is None for mark in ("refuse", "attempt", "advise"))


def _elsewhere(scene: Rules, target: str, chance: np.random.Generator) -> Subtask:
    """A drive to a fixture other than the target."""
    drive = next(skill for skill in SKILLS.values() if skill.moves and skill.target == "thing")
    return Subtask(drive.name, _one([name for name in scene.fixtures if name != target], chance))


def _one(choices: Sequence, chance: np.random.Generator):  # type: ignore[no-untyped-def, type-arg]
    return choices[int(chance.integers(len(choices)))]
