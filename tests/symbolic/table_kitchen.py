"""A kitchen for tests of the skill table: worlds are set up by hand and one round is run by the table."""

from __future__ import annotations

from collections.abc import Mapping

from remac_env.kitchen import layout
from remac_env.kitchen.objects import catalogue
from remac_env.kitchen.scene import build_scene, resting_fixtures
from remac_env.rules.facts import Rules
from remac_env.rules.outcomes import Outcome
from remac_env.rules.rounds import transition
from remac_env.state import FrozenMap, ObjectState, Place, RobotState, WorldState
from remac_env.vocabulary import built_in

A, B = "robot_0", "robot_1"

_THINGS = {noun: noun for noun in ("fish", "plate", "bowl", "pan", "seasoning")}
_PLACES = {
    "vegetable": "counter.0",
    "fish": "counter.3",
    "plate": "cabinet.0",
    "bowl": "counter.1",
    "pan": "counter.4",
    "seasoning": "counter.5",
}


class TableKitchen:
    """One kitchen with two robots aside; every method that changes something returns the kitchen itself.

    vegetable, bowl and the slot counter.2 are at counter_mid; fish, pan and seasoning at counter_right; a plate fills
    the closed cabinet.
    """

    def __init__(self, *, vegetable: str = "carrot") -> None:
        categories = catalogue.load()
        things = {noun: categories[name] for noun, name in {**_THINGS, "vegetable": vegetable}.items()}
        self.scene: Rules = build_scene(layout.load("one_wall_large"), things, (A, B))
        self.world = WorldState(
            FrozenMap({name: RobotState() for name in (A, B)}),
            FrozenMap({noun: ObjectState(Place("slot", slot)) for noun, slot in _PLACES.items()}),
            resting_fixtures(self.scene),
        )
        self.outcomes: Mapping[str, Outcome] = {}

    def stand(self, robot: str, station: str) -> TableKitchen:
        self.world = self.world.with_robot(robot, station=station)
        return self

    def hold(self, robot: str, noun: str) -> TableKitchen:
        self.world = self.world.with_robot(robot, holding=noun).with_object(noun, place=Place("held", robot))
        return self

    def put(self, noun: str, where: str) -> TableKitchen:
        relation = "vessel" if where in self.scene.objects else "slot"
        self.world = self.world.with_object(noun, place=Place(relation, where))  # type: ignore[arg-type]
        return self

    def door(self, fixture: str, state: str) -> TableKitchen:
        self.world = self.world.with_fixture(fixture, door=state)
        return self

    def on(self, fixture: str, *switches: str) -> TableKitchen:
        self.world = self.world.with_fixture(fixture, on=frozenset(switches))
        return self

    def run(self, **commands: str) -> TableKitchen:
        """One round: robot -> command; the others wait."""
        subtasks = {robot: built_in().parse(commands.get(robot, "wait")) for robot in (A, B)}
        self.world, self.outcomes = transition(self.scene, self.world, subtasks)  # type: ignore[arg-type]
        return self

    def reason(self, robot: str = A) -> str | None:
        """Why the robot's last subtask failed; None on success."""
        return self.outcomes[robot].reason

    def false(self, robot: str, command: str) -> list[tuple[str, str]]:
        """Mark and predicate of each requirement that does not hold now."""
        subtask = built_in().parse(command)
        assert subtask is not None
        needed = subtask.requirements(robot)
        return [(r.mark, r.condition.predicate) for r in needed if not r.condition.holds(self.scene, self.world)]

    def place(self, noun: str) -> Place:
        return self.world.objects[noun].place
