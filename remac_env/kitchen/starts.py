"""Draws one exact start of an episode: a pure function of task, cell, kind of start, robots and seed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from remac_env.errors import SamplingError, check_choice
from remac_env.kitchen.draft import Draft
from remac_env.kitchen.floor_plan import Layout
from remac_env.kitchen.mixed import vary
from remac_env.kitchen.objects.catalogue import Category
from remac_env.kitchen.scene import build_scene, resting_fixtures
from remac_env.options import NAMINGS, STARTS
from remac_env.robots import bodies
from remac_env.rules.facts import Rules
from remac_env.rules.processes import chosen
from remac_env.rules.quirks import laid_out
from remac_env.rules.rounds import at_rest
from remac_env.seeding import generator
from remac_env.start import Offset, Start
from remac_env.state import FrozenMap, ObjectState, Place, RobotState, WorldState, base_place
from remac_env.tasks.goals import Goal, Inside
from remac_env.tasks.spec import Role, TaskSpec

CLOSED_AT_RESET = 0.02
"""A closed door stands at most this far open at the start, rad (released code)."""

PARKING_JITTER = (0.12, 0.12, 0.2)
"""How far a robot stands from its parking place at most: x and y in m, yaw in rad."""

HANDLE_YAW = 0.6
"""How far a handle is turned at most from pointing at the robot, rad."""

INWARD_YAW = 0.4
"""How far a long object behind a door is turned at most from pointing inwards, rad; across, no hand gets at it."""

HAND_ROOM = 0.14
"""How far from the sides of a cavity objects stand that a hand reaching in must straddle, m."""

EDGE = 0.02
"""Room kept between an object and the edge of its slot, m, so that neighbours leave space for a hand."""

VESSELS = 3
"""How many vessels a kitchen has, those of the task among them, so that commands do not tell which of them it needs."""

SPARE_VESSELS = 2
"""How many of them the task does not need at least."""

_ATTEMPTS = 100


def sample(
    spec: TaskSpec,
    layout: Layout,
    categories: Mapping[str, Category],
    *,
    style: str,
    starts: str,
    seed: int,
    robots: Sequence[str],
    naming: str = "role",
    perception_noise: float = 0.0,
    knowledge: str = "full",
    body: str = bodies.STANDARD,
) -> tuple[Start, dict[str, str]]:
    """Draw the start of an episode. It is the same for both namings, but for the names, and whatever is known of it.

    Returns:
        (start, names): the start, and for each role of the task what its object is called.

    Raises:
        UnknownNameError: for an unknown kind of start.
        SamplingError: if the kitchen has no room for what the task needs.
    """
    check_choice("starts", starts, STARTS)
    check_choice("naming", naming, NAMINGS)
    bodies.get(body)
    rng = generator(seed, "start", spec.name, layout.name, style, starts)
    names, objects = _choose_objects(spec, layout, categories, naming, rng)
    others = _choose_distractors(spec, layout, categories, objects, rng)
    extra = generator(seed, "vessels", spec.name, layout.name, style, starts)
    objects |= _with_vessels(others, layout, categories, objects, extra)
    slow = [(name, tuple(noun.format(**names) for noun in about)) for name, about in spec.processes]
    scene = laid_out(replace(
        build_scene(layout, objects, robots, annexes=spec.annexes, gives=spec.gives),
        quirks=spec.quirks, orders=spec.orders, hides=knowledge == "seen", processes=chosen(slow),
    ))  # fmt: skip
    for needed in spec.fixtures:
        check_choice(f"fixture (in layout {layout.name}, for {spec.name})", needed, scene.fixtures)
    goal = spec.goal.bind(names)
    draft = _drawn(spec, layout, scene, goal, names, rng, varied=starts == "mixed")
    start = Start(
        scene=scene,
        world=at_rest(scene, draft.world),
        layout=layout.name,
        style=style,
        categories={noun: category.name for noun, category in objects.items()},
        offsets={noun: offset_in(draft.world, layout, noun, objects[noun], rng) for noun in objects},
        robots=park(layout, robots, rng),
        doors=draft.doors,
        seed=int(seed),
        perception_noise=perception_noise,
        body=body,
    )
    return start, names


def _drawn(
    spec: TaskSpec, layout: Layout, scene: Rules, goal: Goal, names: Mapping[str, str], rng: np.random.Generator,
    *, varied: bool,
) -> Draft:  # fmt: skip
    """Where everything is at first, in a kitchen whose goal is still open; raises SamplingError."""
    for _ in range(_ATTEMPTS):
        draft = Draft(scene, _place(spec, layout, scene, names, rng))
        draft.doors = {n: float(rng.uniform(0, CLOSED_AT_RESET)) for n, f in scene.fixtures.items() if f.door}
        if varied:
            vary(draft, goal, names[spec.roles[0].name], rng)
        if not goal.holds(scene, draft.world):
            return draft
    raise SamplingError(f"{spec.name} in {layout.name}: no start was found in which the goal is still open")


def _choose_objects(
    spec: TaskSpec, layout: Layout, categories: Mapping[str, Category], naming: str, rng: np.random.Generator
) -> tuple[dict[str, str], dict[str, Category]]:
    """What the object of each role is called, and the categories of the objects by what they are called."""
    names: dict[str, str] = {}
    objects: dict[str, Category] = {}
    for role in spec.roles:
        noun = str(rng.choice(role.nouns))
        options = [c for c in categories.values() if noun in (c.name, *c.roles) and c.attributes.issuperset(role.needs)]
        if not options:
            such = f" that is {' and '.join(role.needs)}" if role.needs else ""
            raise SamplingError(f"{spec.name}: no category of the catalogue{such} can be the {noun!r}")
        drawn = int(rng.integers(len(options)))
        # The draw is kept, and what is too big for its place makes way for the next that is not: other starts stay.
        in_turn = [*options[drawn:], *options[:drawn]]
        obj = next((each for each in in_turn if _fits(spec, layout, role, each)), in_turn[0])
        names[role.name] = obj.name if naming == "category" else noun
        objects[names[role.name]] = obj
    return names, objects


def _fits(spec: TaskSpec, layout: Layout, role: Role, category: Category) -> bool:
    """Whether an object of this category goes into every fixture into which the goal wants the role's object."""
    inside = (atom for atom in spec.goal.atoms() if isinstance(atom, Inside))
    wanted = (atom.container for atom in inside if atom.name == f"{{{role.name}}}")
    fixtures = (layout.fixtures[name] for name in wanted if name in layout.fixtures)
    return all(each.kind not in category.too_big_for and each.takes(category.size) for each in fixtures)


def _choose_distractors(
    spec: TaskSpec,
    layout: Layout,
    categories: Mapping[str, Category],
    objects: Mapping[str, Category],
    rng: np.random.Generator,
) -> dict[str, Category]:
    """Objects that could not be mistaken for one of the task's, as many as there is room for.

    One slot in the open stays free, so that whatever is in the way can be put down.
    """
    taken = {word for noun, category in objects.items() for word in (noun, category.name, *category.roles)}
    others = [c for c in categories.values() if not c.holds and not taken & {c.name, *c.roles}]
    count = int(rng.integers(spec.distractors[0], spec.distractors[1] + 1))
    slots = sum(layout.fixtures[slot.fixture].worktop for slot in layout.slots.values())
    used = sum(layout.fixtures[role.at].worktop for role in spec.roles if role.at in layout.fixtures)
    count = max(0, min(count, slots - used - 1))
    chosen: dict[str, Category] = {}
    for index in rng.permutation(len(others)):
        other = others[index]
        if len(chosen) < count and not any(_confused(other, obj) for obj in chosen.values()):
            chosen[other.name] = other
    return chosen


def _with_vessels(
    others: Mapping[str, Category],
    layout: Layout,
    categories: Mapping[str, Category],
    objects: Mapping[str, Category],
    rng: np.random.Generator,
) -> dict[str, Category]:
    """The distractors with some of them, in their very places, replaced by vessels that the task does not need.

    What is small stays before what is not: in mixed starts it may lie in the way.
    """
    words = {word for noun, obj in objects.items() for word in (noun, obj.name, *obj.roles)}
    open_slots = (slot for slot in layout.slots.values() if layout.fixtures[slot.fixture].worktop)
    room = min((min(slot.half) for slot in open_slots), default=0.0)
    fits = [c for c in categories.values() if c.holds and not words & {c.name, *c.roles} and min(c.size[:2]) <= room]
    wanted = max(SPARE_VESSELS, VESSELS - sum(obj.holds > 0 for obj in objects.values()))
    spare = [fits[index] for index in rng.permutation(len(fits))][:wanted]
    names = list(others)
    leaving = sorted((names[index] for index in rng.permutation(len(names))), key=lambda name: others[name].small)
    exchanged = dict(zip(leaving, spare, strict=False))
    return {obj.name: obj for obj in (exchanged.get(name, kept) for name, kept in others.items())}


def _confused(one: Category, other: Category) -> bool:
    """Whether the name of one could mean the other."""
    return one.name in other.roles or other.name in one.roles


def _place(
    spec: TaskSpec, layout: Layout, scene: Rules, names: Mapping[str, str], rng: np.random.Generator
) -> WorldState:
    """Everything in a slot: the roles at stations of their own that the goal's fixtures do not use."""
    worktops = [name for name, facts in scene.fixtures.items() if facts.slots and layout.fixtures[name].worktop]
    places: dict[str, Place] = {}
    stations = {scene.fixtures[name].station for name in spec.goal.names() if name in scene.fixtures}
    for role in spec.roles:
        slot = _role_slot(spec, scene, role, worktops, places, stations, rng)
        places[names[role.name]] = Place("slot", slot)
        stations.add(scene.slots[slot].station)
    slots = [slot for name in worktops for slot in scene.fixtures[name].slots]
    free = [slot for slot in slots if Place("slot", slot) not in places.values()]
    rest = [noun for noun in scene.objects if noun not in places]
    if len(free) < len(rest):
        raise SamplingError(f"{spec.name}: {len(rest)} more objects than the {len(free)} free slots can hold")
    for noun, index in zip(rest, rng.permutation(len(free)), strict=False):
        places[noun] = Place("slot", free[index])
    objects = {noun: ObjectState(places[noun]) for noun in scene.objects}
    robots = {name: RobotState() for name in scene.robots}
    return WorldState(FrozenMap(robots), FrozenMap(objects), resting_fixtures(scene))


def _role_slot(
    spec: TaskSpec,
    scene: Rules,
    role: Role,
    worktops: Sequence[str],
    places: Mapping[str, Place],
    stations: set[str],
    rng: np.random.Generator,
) -> str:
    check_choice(f"fixture for role {role.name!r} of {spec.name}", role.at, scene.fixtures)
    free = [slot for slot in scene.fixtures[role.at].slots if Place("slot", slot) not in places.values()]
    if role.at in worktops:
        # Goal-relevant stations must not conflict, or two robots could not work at the same time.
        free = [s for s in free if not any(scene.conflicting(scene.slots[s].station, other) for other in stations)]
    if not free:
        raise SamplingError(f"{spec.name}: no free slot at {role.at} for role {role.name!r}")
    return free[int(rng.integers(len(free)))]


def offset_in(world: WorldState, layout: Layout, noun: str, category: Category, rng: np.random.Generator) -> Offset:
    """A pose within the slot: as far from its middle as the object's size allows, at any yaw its grasp allows.

    Behind a door objects stand in the nearest part of their slot and point inwards, also on a plate, so that a hand
    gets at them.
    """
    yaw_range = HANDLE_YAW if category.grasp.mode == "handle" else np.pi
    yaw = float(rng.uniform(-yaw_range, yaw_range))
    spread = rng.uniform(-1.0, 1.0, 2)
    slot = layout.slots[base_place(world, noun).where]
    half = slot.half
    if slot.kind == "cavity":
        spread[1] = -0.75 - 0.25 * abs(spread[1])
        if category.grasp.mode == "side" and not category.grasp.any_yaw:
            yaw = float(np.copysign(0.5 * np.pi, yaw)) + INWARD_YAW * yaw / yaw_range
    if world.objects[noun].place.relation == "vessel":
        return Offset(0.0, 0.0, yaw)
    radius = max(category.size[:2]) if category.vessel else float(np.hypot(*category.size[:2]))
    edge = 0.5 * EDGE if slot.kind == "cavity" else EDGE
    room = [max(0.0, side - radius - edge) for side in half]
    if slot.kind == "cavity" and not category.vessel:
        room[0] = min(room[0], max(0.0, half[0] - HAND_ROOM))
    return Offset(float(spread[0] * room[0]), float(spread[1] * room[1]), yaw)


def park(layout: Layout, robots: Sequence[str], rng: np.random.Generator) -> dict[str, tuple[int, Offset]]:
    """A parking place of its own for each robot, drawn so that no robot has a fixed one."""
    if len(robots) > len(layout.asides):
        raise SamplingError(f"{layout.name} has {len(layout.asides)} parking places for {len(robots)} robots")
    order = rng.permutation(len(layout.asides))
    jitter = rng.uniform(-1.0, 1.0, (len(layout.asides), 3)) * PARKING_JITTER
    return {
        name: (int(order[i]), Offset(*(float(v) for v in jitter[i]))) for i, name in enumerate(robots)
    }
