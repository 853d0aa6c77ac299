"""Starts that a task states (`TaskSpec.setup`): the world is given, and only poses are drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from remac_env.errors import OptionError, check_choice
from remac_env.kitchen.fixtures.door import OPEN_TO
from remac_env.kitchen.floor_plan import Layout
from remac_env.kitchen.mixed import AJAR
from remac_env.kitchen.objects.catalogue import Category
from remac_env.kitchen.scene import build_scene, resting_fixtures
from remac_env.kitchen.starts import CLOSED_AT_RESET, offset_in, park
from remac_env.rules.facts import Rules
from remac_env.rules.quirks import laid_out
from remac_env.rules.rounds import at_rest
from remac_env.seeding import generator
from remac_env.start import Offset, Start
from remac_env.state import Door, FrozenMap, ObjectState, RobotState, WorldState, base_place
from remac_env.tasks.setup import Setup
from remac_env.tasks.spec import TaskSpec

_CROWDED = 0.4
"""Share of the usual way from a slot's middle where neighbouring slots are full: a hand is as wide as a slot."""


def stated_scene(
    spec: TaskSpec, layout: Layout, categories: Mapping[str, Category], robots: Sequence[str], *, knowledge: str
) -> Rules:
    """The facts of a kitchen with the objects of a setup, or of a task without one with no objects."""
    objects = {} if spec.setup is None else spec.setup.objects
    for name in objects.values():
        check_choice(f"category of task {spec.name}", name, categories)
    chosen = {noun: categories[name] for noun, name in objects.items()}
    scene = build_scene(layout, chosen, robots, annexes=spec.annexes, gives=spec.gives)
    return laid_out(replace(scene, quirks=spec.quirks, orders=spec.orders, hides=knowledge == "seen"))


def stated_world(scene: Rules, setup: Setup) -> WorldState:
    """The world of a setup, with whatever happens by itself at once; all robots are aside.

    Raises:
        OptionError: for two objects in one slot, or places that the kitchen does not have.
    """
    fixtures = {n: replace(state, door=setup.doors.get(n, state.door)) for n, state in resting_fixtures(scene).items()}
    fixtures |= {n: replace(fixtures[n], on=frozenset(on)) for n, on in setup.on.items()}
    taken: dict[str, str] = {}
    for noun, place in setup.places.items():
        known = scene.slots if place.relation == "slot" else scene.objects
        if place.relation not in ("slot", "vessel") or place.where not in known:
            raise OptionError(f"place of the {noun}: {place.where!r} is not valid; valid: {', '.join(known)}")
        if place.relation == "slot" and (other := taken.setdefault(place.where, noun)) != noun:
            raise OptionError(f"places: the {other} and the {noun} are both in {place.where}; valid: one of them")
    objects = {noun: ObjectState(setup.places[noun]) for noun in scene.objects}
    robots = {name: RobotState() for name in scene.robots}
    return at_rest(scene, WorldState(FrozenMap(robots), FrozenMap(objects), FrozenMap(fixtures)))


def stated_start(
    spec: TaskSpec,
    setup: Setup,
    layout: Layout,
    categories: Mapping[str, Category],
    *,
    style: str,
    seed: int,
    robots: Sequence[str],
    perception_noise: float,
    knowledge: str,
) -> tuple[Start, dict[str, str]]:
    """The start of a setup, and for each role of the task what its object is called."""
    scene = stated_scene(spec, layout, categories, robots, knowledge=knowledge)
    world = stated_world(scene, setup)
    rng = generator(seed, "stated start", spec.name, layout.name, style)
    doors = {n: _angle(state.door, rng.uniform(0.0, 1.0)) for n, state in world.fixtures.items() if state.door}
    offsets = {}
    for noun, category in setup.objects.items():
        drawn = world.objects[noun].place.where in layout.slots
        offsets[noun] = offset_in(world, layout, noun, categories[category], rng) if drawn else Offset()
        if spec.generated and not spec.symbolic_only:
            offsets[noun] = _near_middle(offsets[noun], world, layout, noun)
    start = Start(
        scene=scene, world=world, layout=layout.name, style=style, categories=dict(setup.objects), offsets=offsets,
        robots=park(layout, robots, rng), doors=doors, seed=int(seed), perception_noise=perception_noise,
    )  # fmt: skip
    return start, {role.name: role.nouns[0] for role in spec.roles}


def _near_middle(offset: Offset, world: WorldState, layout: Layout, noun: str) -> Offset:
    """The same nearer to the middle of a worktop's slot, whose neighbours hold objects as well."""
    on_top = layout.slots[base_place(world, noun).where].kind == "surface"
    return replace(offset, dx=_CROWDED * offset.dx, dy=_CROWDED * offset.dy) if on_top else offset


def _angle(door: Door | None, share: float) -> float:
    """An angle, rad, at which a door is so."""
    if door == "ajar":
        return AJAR[0] + share * (AJAR[1] - AJAR[0])
    return OPEN_TO if door == "open" else share * CLOSED_AT_RESET
