"""Turns a subtask into the motion that carries it out, from the scene's facts and the present world."""

from __future__ import annotations

from remac_env.backends.physics.controllers.scripted.doors import close_door, open_door
from remac_env.backends.physics.controllers.scripted.insert import insert, take_out
from remac_env.backends.physics.controllers.scripted.pick_up import LIFTS, pick_up
from remac_env.backends.physics.controllers.scripted.place import place_on
from remac_env.backends.physics.controllers.scripted.room import Spot, forbidden, free_slot, spot_in, vessels_on
from remac_env.backends.physics.controllers.scripted.season import season
from remac_env.backends.physics.controllers.scripted.skill import SkillFailure, Steps, require_open
from remac_env.backends.physics.controllers.scripted.switches import work
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.kitchen.fixtures import Slot
from remac_env.rules.facts import FixtureFacts, Rules
from remac_env.rules.places import switch_for
from remac_env.rules.subtasks import Subtask
from remac_env.state import WorldState, base_place, contents

_CAVITY_LIFT = 0.10  # m by which a vessel is raised in a cavity where there is room
_OUTWARDS = ((-0.35, 0.6), (-0.35, 0.4), (-0.30, 0.8))  # back (m) and share of the lift
_OUT_OF_BASIN = ((0.0, 1.0), (-0.08, 1.0), (-0.14, 1.0), (-0.2, 1.0))
_FALL = 20  # control periods in which a dropped object reaches the floor


def motion(here: Workspace, scene: Rules, world: WorldState, robot: str, subtask: Subtask) -> Steps:
    """The generator that runs an accepted subtask other than driving."""
    target = subtask.target
    if subtask.skill == "pick up":
        yield from _pick_up(here, scene, world, target)
    elif subtask.skill == "place to":
        yield from _place(here, scene, world, robot, target)
    elif subtask.skill == "season":
        yield from _season(here, world, target)
    elif subtask.skill in ("open door", "close door"):
        yield from _empty(here)
        yield from (open_door if subtask.skill == "open door" else close_door)(here, target)
    elif subtask.skill in ("turn on", "turn off"):
        yield from _empty(here)
        yield from _switch(here, scene, world, target, on=subtask.skill == "turn on")
    else:
        raise SkillFailure("invalid", f"physics has no skill {subtask.skill!r}")


def _empty(here: Workspace) -> Steps:
    """Open the hand where the robot stands; what it held falls, and the skill with it."""
    body = here.hand.body
    if body is None:
        return
    yield from here.mover.fingers(here.robot.body.finger_travel, _FALL)
    here.hand.body = None
    raise SkillFailure("dropped", f"the hand opened and the {body} fell")


def _slot_of(here: Workspace, world: WorldState, name: str) -> Slot:
    """The slot in which an object stands, directly or in a vessel."""
    place = base_place(world, name)
    if place.relation != "slot":
        raise SkillFailure("unreachable", f"the {name} is in no slot")
    return here.kitchen.layout.slots[place.where]


def _pick_up(here: Workspace, scene: Rules, world: WorldState, target: str) -> Steps:
    slot = _slot_of(here, world, target)
    require_open(here, slot.fixture)
    place = world.objects[target].place
    vessel = place.where if place.relation == "vessel" else None
    inner = tuple(contents(world, target))
    if slot.kind == "cavity" and here.kitchen.objects[target].vessel:
        yield from pick_up(here, target, kind=slot.kind, contents=inner, lift=_CAVITY_LIFT, lifts=_OUTWARDS)
    elif slot.kind == "cavity":
        yield from take_out(here, target, vessel=vessel)
    else:
        big = here.kitchen.objects[target].vessel
        lift = 0.26 if slot.kind == "basin" else 0.20 if big else 0.14
        lifts = _OUT_OF_BASIN if slot.kind == "basin" and big else LIFTS
        yield from pick_up(here, target, kind=slot.kind, vessel=vessel, contents=inner, lift=lift, lifts=lifts)


def _place(here: Workspace, scene: Rules, world: WorldState, robot: str, target: str) -> Steps:
    if here.hand.body is None:
        raise SkillFailure("hands_empty", "there is nothing to place")
    require_open(here, target if target in scene.fixtures else _slot_of(here, world, target).fixture)
    spot = _spot(here, scene, world, robot, target)
    if spot.slot.kind == "cavity":
        yield from insert(here, spot.point, vessel=spot.vessel)
    else:
        yield from place_on(here, spot.point, kind=spot.slot.kind, vessel=spot.vessel)


def _spot(here: Workspace, scene: Rules, world: WorldState, robot: str, target: str) -> Spot:
    """Where there seems to be room for the held object. Fails with ``blocked`` where there is none."""
    body, options = str(here.hand.body), list[tuple[Slot, str | None]]()
    if target in scene.objects:
        slot = _slot_of(here, world, target)
        kind, options = here.kitchen.fixture(slot.fixture).kind, [(slot, target)]
    else:
        kind, station = scene.fixtures[target].kind, world.robots[robot].station
        slots = [name for name in scene.fixtures[target].slots if scene.slots[name].station == station]
        free = free_slot(here, slots, here.sensed.reading(target).on)
        options = [(free, None)] if free else [*vessels_on(here, slots, kind)]
    why = f"no room is seen on the {target}"
    for slot, vessel in options:
        rule = forbidden(here.kitchen.objects[body], kind, here.kitchen.objects[vessel] if vessel else None)
        spot = spot_in(here, slot, vessel, body) if rule is None else None
        if spot is not None:
            return spot
        why = rule or why
    raise SkillFailure("blocked", f"{why}, for the {body}")


def _season(here: Workspace, world: WorldState, target: str) -> Steps:
    slot = _slot_of(here, world, target)
    require_open(here, slot.fixture)
    yield from season(here, target, inside=slot.fixture if slot.kind == "cavity" else None)


def _switch(here: Workspace, scene: Rules, world: WorldState, target: str, *, on: bool) -> Steps:
    facts, actuators = scene.fixtures[target], {a.switch: a for a in here.kitchen.fixture(target).actuators}
    switches = list(facts.switches)
    if facts.switch_per_slot:
        switches = [switch_for(scene, world, target)] if on else sorted(world.fixtures[target].on)
    try:
        for switch in switches:
            yield from work(here, actuators[switch], on=on)
    except SkillFailure:
        _check_runs(here, facts, on=on)  # a knob may have come back for that
        raise
    _check_runs(here, facts, on=on)


def _check_runs(here: Workspace, facts: FixtureFacts, *, on: bool) -> None:
    """Raise SkillFailure where something was turned on that runs only shut, and is open."""
    if on and facts.shut_to_run and here.sensed.reading(facts.name).door not in (None, "closed"):
        raise SkillFailure("blocked", f"the {facts.name} does not run with its door open")

