"""What spoils in the open and cannot be shut away in time any more: a search for plans goes on from no such moment."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping

from remac_env.rules.facts import Process, Rules
from remac_env.rules.processes import SHUT_AWAY
from remac_env.rules.skills import SKILLS
from remac_env.state import WorldState, base_place

PICK, PLACE = SKILLS["pick up"].seconds, SKILLS["place to"].seconds
OPEN, CLOSE, DRIVE = SKILLS["open door"].seconds, SKILLS["close door"].seconds, SKILLS["navigate to"].seconds
"""s that robots take by the skill table."""


class ShutAway:
    """How long it takes at least until each of some objects has been behind a shut door.

    What no plan can do without is counted, each step once: an object is taken from where it stands, driven to a
    compartment and put down, by a gripper that holds one at a time; a door is shut on it, and was opened before.

    Args:
        names: what the goal is about.
    """

    def __init__(self, rules: Rules, names: Iterable[str]) -> None:
        self._rules, self._names = rules, frozenset(names)
        self._doors = [name for name, facts in rules.fixtures.items() if facts.door]
        self._there = {station for name in self._doors for station in rules.stations_of(name)}
        self._elsewhere = {station for slot in rules.slots.values() for station in slot.stations} - self._there
        self._room = max((len(rules.fixtures[name].slots) for name in self._doors), default=1)
        # Some doors move by themselves, and over a counter an object comes to another station without a drive.
        self._by_hand = not rules.quirks and not any(process.does == "shut" for process in rules.processes)
        self._by_drive = not any(slot.across for slot in rules.slots.values())
        self._known: dict[tuple[WorldState, frozenset[str]], float] = {}

    def too_late(self, running: Mapping[tuple[Process, str], float], after: WorldState, now: float) -> bool:
        """Whether something that the goal is about spoils, whatever the robots do.

        Args:
            running: what goes on by itself, and since when, s.
            after: the world once what is under way has ended.
            now: s on the clock.
        """
        ends = {
            name: since + process.seconds
            for (process, name), since in running.items()
            if process.spoils and process.during in SHUT_AWAY and name in self._names
        }
        return any(
            now + self._seconds(after, frozenset(name for name in ends if ends[name] <= end)) > end + 1e-6
            for end in set(ends.values())
        )

    def _seconds(self, world: WorldState, names: frozenset[str]) -> float:
        """The work of all robots, shared out evenly among them."""
        rules, key = self._rules, (world, names)
        if key not in self._known:
            # Two on one vessel are carried and shut away together: then only what each needs for itself is certain.
            together = any(facts.holds > 1 for facts in rules.objects.values())
            together = together or any(rules.objects[name].holds for name in names)
            groups = [[name] for name in names] if together else [names]
            self._known[key] = max(self._work(world, group) for group in groups) / len(rules.robots)
        return self._known[key]

    def _work(self, world: WorldState, names: Collection[str]) -> float:
        """s of robots until each has been shut away."""
        rules = self._rules
        places = [base_place(world, name) for name in names]
        held = [place.where for place in places if place.relation == "held"]
        stand = [rules.slots[place.where] for place in places if place.relation == "slot"]
        lie = [slot for slot in stand if slot.fixture not in self._doors]
        shut = sum(world.fixtures[slot.fixture].door == "closed" for slot in stand)
        hands = PICK * len(lie) + PLACE * (len(lie) + len(held))
        drives = self._driving(world, held, [slot.stations for slot in lie])
        return hands + drives + self._closing(world, len(names) - shut)

    def _driving(self, world: WorldState, held: list[str], lie: list[tuple[str, ...]]) -> float:
        """s of drives with each, and to each but those at which a robot may stand already."""
        if not self._by_drive:
            return 0.0
        far = sum(self._there.isdisjoint(stations) for stations in lie)
        with_it = far + sum(world.robots[robot].station not in self._there for robot in held)
        begun = sum(robot.station in self._elsewhere for robot in world.robots.values())
        return DRIVE * (with_it + max(0, far - begun))

    def _closing(self, world: WorldState, objects: int) -> float:
        """s of closing doors on so many objects, and of opening those doors that do not stand open."""
        if not self._by_hand:
            return 0.0
        closed = math.ceil(objects / max(1, self._room))
        ajar = sum(world.fixtures[name].door != "closed" for name in self._doors)
        return CLOSE * closed + OPEN * max(0, closed - ajar)
