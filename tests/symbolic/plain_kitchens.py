"""One real floor plan with five objects in a row, and commands played in it by the table."""

from __future__ import annotations

from dataclasses import replace

from remac_env.kitchen import layout as layouts
from remac_env.kitchen.objects import catalogue
from remac_env.kitchen.scene import build_scene, resting_fixtures
from remac_env.rules.facts import Quirk, Rules
from remac_env.rules.rounds import transition
from remac_env.rules.subtasks import WAIT
from remac_env.state import FrozenMap, ObjectState, Place, RobotState, WorldState
from remac_env.vocabulary import built_in

THINGS = ("carrot", "pan", "plate", "bowl", "apple")


def kitchen(*quirks: Quirk, robots: int = 1, gives: dict[str, str] | None = None) -> tuple[Rules, WorldState]:
    """A kitchen with one object in each of the first counter slots, everything shut and off."""
    names = tuple(f"robot_{index}" for index in range(robots))
    scene = build_scene(layouts.load("one_wall_large"), {n: catalogue.load()[n] for n in THINGS}, names)
    fixtures = {n: replace(f, gives=(gives or {}).get(n, "")) for n, f in scene.fixtures.items()}
    scene = replace(scene, quirks=quirks, fixtures=FrozenMap(fixtures))
    places = {n: ObjectState(Place("slot", f"counter.{i}")) for i, n in enumerate(THINGS)}
    robots_at = FrozenMap({name: RobotState() for name in names})
    return scene, WorldState(robots_at, FrozenMap(places), resting_fixtures(scene))


def play(scene: Rules, world: WorldState, text: str, *, other: str = "") -> tuple[WorldState, list[bool]]:
    """The world after commands of robot_0, commas between them, and which succeeded; `other`: robot_1's."""
    ends = []
    rest = [part.strip() for part in other.split(",")] if other else []
    for number, part in enumerate(text.split(",")):
        joint = {"robot_0": built_in().parse(part.strip()) or WAIT}
        if len(scene.robots) > 1:
            joint["robot_1"] = (built_in().parse(rest[number]) if number < len(rest) else None) or WAIT
        world, outcomes = transition(scene, world, joint)
        ends.append(outcomes["robot_0"].success)
    return world, ends
