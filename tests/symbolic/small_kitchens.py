"""Small kitchens drawn at random, and a search over them that shares nothing with the oracle's but the skill table."""

from __future__ import annotations

import heapq
import itertools
import random
from dataclasses import dataclass

from remac_env.rules.facts import FixtureFacts, ObjectFacts, Rules, SlotFacts
from remac_env.rules.rounds import transition
from remac_env.rules.subtasks import Subtask
from remac_env.state import FLOOR, FixtureState, FrozenMap, ObjectState, Place, RobotState, WorldState
from remac_env.tasks.goals import All, DoorIs, Goal, Inside, Marked, Released, SwitchedOn

LITTER = 4
"""Rounds that an object on the floor costs; written down again here on purpose."""

FIXTURES = {
    "counter": FixtureFacts("counter", "counter", "mid", slots=("counter.0", "counter.1", "counter.2")),
    "sink": FixtureFacts("sink", "sink", "sink", slots=("sink.0",)),
    "faucet": FixtureFacts("faucet", "faucet", "sink", switches=("faucet",), wets=("sink",)),
    "cabinet": FixtureFacts("cabinet", "cabinet", "high", door=True, slots=("cabinet.0",)),
    "microwave": FixtureFacts(
        "microwave", "microwave", "oven", door=True, switches=("microwave",), slots=("microwave.0",), shut_to_run=True
    ),
    "stove": FixtureFacts(
        "stove", "stove", "hob", switches=("stove.0", "stove.1"), slots=("stove.0", "stove.1")
    ),
}
STATIONS = {"counter.0": "mid", "counter.1": "mid", "counter.2": "left"}
OBJECTS = {
    "carrot": ObjectFacts("carrot", "carrot", washable=True),
    "fish": ObjectFacts("fish", "fish", needs_vessel_in=frozenset({"sink"})),
    "bowl": ObjectFacts("bowl", "bowl", holds=1, small=False, vessel_in=frozenset({"sink"})),
    "pan": ObjectFacts("pan", "pan", holds=1, small=False, vessel_in=frozenset({"stove"})),
    "salt": ObjectFacts("salt", "salt", seasons=True),
}


@dataclass(frozen=True)
class Problem:
    """A start and a goal."""

    scene: Rules
    world: WorldState
    goal: Goal

    @property
    def commands(self) -> list[Subtask]:
        """Every command that names anything here, whether it can matter or not."""
        commands = [Subtask("wait"), Subtask("navigate aside")]
        for name, obj in self.scene.objects.items():
            commands += [Subtask("navigate to", name), Subtask("pick up", name), Subtask("season", name)]
            commands += [Subtask("place to", name)] if obj.holds else []
        for name, facts in self.scene.fixtures.items():
            commands.append(Subtask("navigate to", name))
            commands += [Subtask("place to", name)] if facts.slots else []
            commands += [Subtask(f"{verb} door", name) for verb in ("open", "close") if facts.door]
            commands += [Subtask(f"turn {way}", name) for way in ("on", "off") if facts.switches]
        return commands


def draw(seed: int) -> Problem:
    """A kitchen of two to four fixtures and two or three objects, one robot or two, and a goal of a few parts."""
    dice = random.Random(seed)
    names = ["counter", *dice.sample(["sink", "cabinet", "microwave", "stove"], dice.randint(1, 2))]
    names += ["faucet"] if "sink" in names else []
    fixtures = FrozenMap({name: FIXTURES[name] for name in names})
    slots = [slot for facts in fixtures.values() for slot in facts.slots]
    of = {slot: facts.name for facts in fixtures.values() for slot in facts.slots}
    objects = dice.sample(sorted(OBJECTS), dice.randint(2, 3))
    robots = ("a", "b")[: dice.randint(1, 2)]
    scene = Rules(
        robots,
        fixtures,
        FrozenMap({slot: SlotFacts(slot, of[slot], STATIONS.get(slot, fixtures[of[slot]].station)) for slot in slots}),
        FrozenMap({name: OBJECTS[name] for name in objects}),
        frozenset({frozenset({"sink", "hob"})}) if dice.random() < 0.3 else frozenset(),
    )
    return Problem(scene, _world(scene, dice, slots), _goal(scene, dice))


def _world(scene: Rules, dice: random.Random, slots: list[str]) -> WorldState:
    free = dice.sample(slots, len(slots))
    places: dict[str, ObjectState] = {}
    holding: dict[str, str | None] = dict.fromkeys(scene.robots)
    for name in scene.objects:
        vessels = [other for other in places if scene.objects[other].holds and scene.objects[name].small]
        vessels = [other for other in vessels if all(item.place.where != other for item in places.values())]
        if vessels and dice.random() < 0.3:
            places[name] = ObjectState(Place("vessel", vessels[0]))
        elif dice.random() < 0.15 and holding[scene.robots[-1]] is None:
            places[name] = ObjectState(Place("held", scene.robots[-1]))
            holding[scene.robots[-1]] = name
        else:
            places[name] = ObjectState(Place("slot", free.pop()))
    stations = dice.sample(["aside", *scene.stations], len(scene.robots))
    if len(stations) > 1 and scene.conflicting(*stations):
        stations[0] = "aside"
    doors = {name: dice.choice(["closed", "ajar", "open"]) for name, facts in scene.fixtures.items() if facts.door}
    lit = {name: dice.random() < 0.3 and doors.get(name, "closed") == "closed" for name in scene.fixtures}
    states = {
        name: FixtureState(doors.get(name), frozenset(facts.switches[:1] if lit[name] else ()))  # type: ignore[arg-type]
        for name, facts in scene.fixtures.items()
    }
    there = {robot: RobotState(at, holding[robot]) for robot, at in zip(scene.robots, stations, strict=True)}
    return WorldState(FrozenMap(there), FrozenMap(places), FrozenMap(states))


def _goal(scene: Rules, dice: random.Random) -> Goal:
    parts: list[Goal] = []
    for name in dice.sample(sorted(scene.objects), dice.randint(1, 2)):
        into = [fixture for fixture, facts in scene.fixtures.items() if facts.slots]
        into += [other for other, facts in scene.objects.items() if facts.holds and other != name]
        parts += [Inside(name, dice.choice(into)), Released(name)]
        if "faucet" in scene.fixtures and scene.objects[name].washable and dice.random() < 0.7:
            parts.append(Marked(name, "washed"))
        if "salt" in scene.objects and name != "salt" and dice.random() < 0.3:
            parts.append(Marked(name, "seasoned"))
    for name, facts in scene.fixtures.items():
        if facts.switches and dice.random() < 0.3:
            parts.append(SwitchedOn(name))
        if facts.door and dice.random() < 0.3:
            parts.append(DoorIs(name, dice.choice(["closed", "open"])))
    return All(*parts)


def cheapest(problem: Problem, *, most: int, states: int = 10**9) -> int | None | str:
    """The cost of the cheapest plan over all commands, None where none costs at most `most`; "gave up" after `states`.

    Uniform-cost search: rounds by the table, whether their subtasks succeed or not, four more for what falls.
    """
    scene, commands = problem.scene, problem.commands
    counter = itertools.count()
    costs, queue, looked = {problem.world: 0}, [(0, 0, problem.world)], 0
    while queue:
        cost, _, world = heapq.heappop(queue)
        if cost > costs[world]:
            continue
        if problem.goal.holds(scene, world):
            return cost
        looked += 1
        if looked > states:
            return "gave up"
        for joint in itertools.product(commands, repeat=len(scene.robots)):
            after, _ = transition(scene, world, dict(zip(scene.robots, joint, strict=True)))
            fallen = _fallen(after) - _fallen(world)
            total = cost + 1 + LITTER * fallen
            if total <= most and total < costs.get(after, most + 1):
                costs[after] = total
                heapq.heappush(queue, (total, next(counter), after))
    return None


def _fallen(world: WorldState) -> int:
    return sum(item.place == FLOOR for item in world.objects.values())
