"""Facts about the world as one vector of zeros and ones, sized by the vocabulary so that it never changes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from remac_env.rules.facts import ASIDE, Rules
from remac_env.rules.skills import marks
from remac_env.state import FixtureState, ObjectState, RobotState, WorldState
from remac_env.vocabulary import Vocabulary

_DOORS = ("closed", "ajar", "open")
_FIXTURE_SIZE = 5
_BLOCKS = 2  # of robots at least: the robot itself, then another one (zeros where there is none)


class Facts:
    """Writes WorldStates as vectors.

    Layout, with F fixture nouns and O object nouns of the vocabulary: robot blocks of 1 + F + O + O (aside; at each
    fixture; at each object; holding each object), two or as many as there are robots, the own one first, then the
    others in the order of their names; O object blocks of 1 + F + O + 3 + M (present; in each fixture; on each object;
    held by oneself, held by another, on the floor; each mark, as washed and seasoned); F fixture blocks of 1 + 3 + 1
    (present; door closed, ajar, open; on).
    """

    def __init__(
        self, vocabulary: Vocabulary, robots: int = _BLOCKS, further_marks: Iterable[str] = (), *, room: int = 0
    ) -> None:
        """Make what writes the worlds of all kitchens with these nouns.

        Args:
            robots: how many there are at most.
            further_marks: beside those that all kitchens know.
            room: zeros at the end of a vector, for figures that others fill in.
        """
        self._blocks = max(robots, _BLOCKS)
        self.fixtures = tuple(noun.name for noun in vocabulary.nouns if noun.kind == "fixture")
        self.objects = tuple(noun.name for noun in vocabulary.nouns if noun.kind == "object")
        f, o = len(self.fixtures), len(self.objects)
        self.at = {name: index for index, name in enumerate((*self.fixtures, *self.objects))}
        self.marks = tuple(dict.fromkeys((*marks(), *further_marks)))
        self.robot_size, object_size = 1 + f + 2 * o, f + o + 4 + len(self.marks)
        objects_from = self._blocks * self.robot_size
        fixtures_from = objects_from + o * object_size
        self.object_starts = {name: objects_from + i * object_size for i, name in enumerate(self.objects)}
        self.fixture_starts = {name: fixtures_from + i * _FIXTURE_SIZE for i, name in enumerate(self.fixtures)}
        self._kitchen: _Kitchen | None = None
        self.size, self.room = fixtures_from + f * _FIXTURE_SIZE, room

    def vector(self, scene: Rules, world: WorldState, robot: str) -> NDArray[np.float32]:
        """The world as `robot` sees it; shape (size + room,), values 0 or 1."""
        return self.vectors(scene, world, (robot,))[robot]

    def vectors(self, scene: Rules, world: WorldState, robots: Iterable[str]) -> dict[str, NDArray[np.float32]]:
        """The world as each of `robots` sees it."""
        kitchen = self._kitchen
        if kitchen is None or kitchen.scene is not scene:
            kitchen = self._kitchen = _Kitchen(self, scene)
        kitchen.become(world)
        return {robot: kitchen.values[robot].copy() for robot in robots}


class _Kitchen:
    """A kitchen as its robots saw it last. What is the very same state in the next world is not looked at again.

    Attributes:
        values: for each robot what it sees, (size + room,).
    """

    def __init__(self, facts: Facts, scene: Rules) -> None:
        self.scene, self._facts = scene, facts
        self.values = {robot: np.zeros(facts.size + facts.room, dtype=np.float32) for robot in scene.robots}
        self._robots: Mapping[str, RobotState] = {}
        self._objects: Mapping[str, ObjectState] = {}
        self._fixtures: Mapping[str, FixtureState] = {}
        self._ones: dict[tuple[str, str], list[int]] = {}
        """(who sees it, robot, object or fixture) -> where ones stand for it."""
        self._used = {name: [1 + facts.at[other] for other in scene.used_from(name)] for name in scene.stations}
        self._near: dict[str, tuple[str, ...]] = {}
        """Object -> the stations from which it is used."""
        self._at_station: dict[str, list[int]] = {}
        """The same the other way round, as positions of objects."""
        self._touched: set[str] = set()
        """Stations from which other objects are used since robots were last looked at."""

    def become(self, world: WorldState) -> None:
        """Look at another world of the kitchen."""
        objects = world.objects
        if world.fixtures is not self._fixtures:
            for name, fixture in world.fixtures.items():
                if fixture is not self._fixtures.get(name):
                    self._write(name, self._fixture(name, fixture))
            self._fixtures = world.fixtures
        if objects is not self._objects:
            for name in self._objects.keys() - objects.keys():
                self._write(name, [])
                self._place(name, ())
            for name, item in objects.items():
                # What an object in a vessel is on hangs on where the vessel is.
                if item is not self._objects.get(name) or item.place.relation == "vessel":
                    self._object(name, item, objects)
            self._objects = objects
        if self._touched or world.robots is not self._robots:
            for name, robot in world.robots.items():
                if robot.station in self._touched or robot is not self._robots.get(name):
                    self._robot(name, robot)
            self._robots = world.robots
            self._touched.clear()

    def _write(self, name: str, ones: list[int], holder: str = "", hands: int = 0) -> None:
        """Let ones stand here for an object or fixture; for one in a hand another one, which hangs on who sees it."""
        for robot in self.values:
            self._set(robot, name, [*ones, hands + (holder != robot)] if holder else ones)

    def _set(self, robot: str, name: str, ones: list[int]) -> None:
        """Let ones stand here for what has this name, in what a robot sees."""
        values, before = self.values[robot], self._ones.get((robot, name), [])
        if before == ones:
            return
        for place in before:
            values[place] = 0.0
        for place in ones:
            values[place] = 1.0
        self._ones[robot, name] = ones

    def _fixture(self, name: str, state: FixtureState) -> list[int]:
        start = self._facts.fixture_starts[name]
        door = [] if state.door is None else [start + 1 + _DOORS.index(state.door)]
        return [start, *door, *([start + 1 + len(_DOORS)] if state.on else ())]

    def _object(self, name: str, item: ObjectState, objects: Mapping[str, ObjectState]) -> None:
        facts, at = self._facts, self._facts.at
        start, place, holder = facts.object_starts[name], item.place, ""
        first, rest, ones = start + 1, start + 1 + len(at), [start]
        if place.relation == "held":
            holder = place.where
        elif place.relation == "floor":
            ones.append(rest + 2)
        while place.relation == "vessel":
            ones.append(first + at[place.where])
            place = objects[place.where].place
        near: tuple[str, ...] = ()
        if place.relation == "slot":
            slot = self.scene.slots[place.where]
            ones += [first + at[around] for around in (place.where, slot.fixture) if around in at]
            near = slot.stations
        if item.marks:
            ones += [rest + 3 + facts.marks.index(mark) for mark in item.marks if mark in facts.marks]
        self._write(name, ones, holder, rest)
        self._place(name, near)

    def _place(self, name: str, stations: tuple[str, ...]) -> None:
        """An object is used from these stations now."""
        before, index = self._near.get(name, ()), 1 + self._facts.at[name]
        if before != stations:
            self._touched.update(before, stations)
            for station in before:
                self._at_station[station].remove(index)
            for station in stations:
                self._at_station.setdefault(station, []).append(index)
            self._near[name] = stations

    def _robot(self, name: str, state: RobotState) -> None:
        """A robot's block: that of its own is the first, then come those of the others in the order of their names."""
        at = state.station
        ones = [0] if at == ASIDE else [*self._used.get(at, ()), *self._at_station.get(at, ())]
        if state.holding is not None:
            ones.append(1 + self._facts.at[state.holding] + len(self._facts.objects))
        own, robots, size = name, self.scene.robots, self._facts.robot_size
        mine = robots.index(name)
        for place_of, robot in enumerate(robots):
            block = 0 if robot == own else size * (mine + (mine < place_of))
            self._set(robot, name, [block + place for place in ones] if block else ones)
