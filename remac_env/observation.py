"""Facts about the world as one vector of zeros and ones, sized by the vocabulary so that it never changes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from remac_env.rules.facts import ASIDE, Rules
from remac_env.rules.skills import marks
from remac_env.state import FixtureState, FrozenMap, ObjectState, RobotState, WorldState
from remac_env.vocabulary import Vocabulary

_DOORS = ("closed", "ajar", "open")
_FIXTURE_SIZE = 5
_BLOCKS = 2  # of robots at least: the robot itself, then another one (zeros where there is none)


@dataclass(frozen=True, slots=True)
class _Things:
    """What robots see of one state of the objects and fixtures.

    values: for each robot, (size,), wherever the robots are. at_station: for each station the positions of the objects
    that are used from it. ones: where the robots were -> for each of them the places of the ones in the robots' blocks.
    """

    scene: Rules
    objects: FrozenMap[ObjectState]
    fixtures: FrozenMap[FixtureState]
    values: dict[str, NDArray[np.float32]]
    at_station: dict[str, list[int]]
    ones: dict[tuple[tuple[str, str | None], ...], dict[str, NDArray[np.intp]]] = field(default_factory=dict)

    def are(self, scene: Rules, world: WorldState) -> bool:
        """Whether this is the very state of the objects in that world: equal ones are not looked for."""
        return self.scene is scene and self.objects is world.objects and self.fixtures is world.fixtures


class Facts:
    """Writes WorldStates as vectors.

    Layout, with F fixture nouns and O object nouns of the vocabulary: robot blocks of 1 + F + O + O (aside; at each
    fixture; at each object; holding each object), two or as many as there are robots, the own one first, then the
    others in the order of their names; O object blocks of 1 + F + O + 3 + M (present; in each fixture; on each object;
    held by oneself, held by another, on the floor; each mark, as washed and seasoned); F fixture blocks of 1 + 3 + 1
    (present; door closed, ajar, open; on).
    """

    def __init__(self, vocabulary: Vocabulary, robots: int = _BLOCKS, further_marks: Iterable[str] = ()) -> None:
        """Args: robots: how many there are at most. further_marks: beside those that all kitchens know."""
        self._blocks = max(robots, _BLOCKS)
        self.fixtures = tuple(noun.name for noun in vocabulary.nouns if noun.kind == "fixture")
        self.objects = tuple(noun.name for noun in vocabulary.nouns if noun.kind == "object")
        f, o = len(self.fixtures), len(self.objects)
        self._at = {name: index for index, name in enumerate((*self.fixtures, *self.objects))}
        self._marks = tuple(dict.fromkeys((*marks(), *further_marks)))
        self._robot_size, object_size = 1 + f + 2 * o, f + o + 4 + len(self._marks)
        objects_from = self._blocks * self._robot_size
        fixtures_from = objects_from + o * object_size
        self._object_starts = {name: objects_from + i * object_size for i, name in enumerate(self.objects)}
        self._fixture_starts = {name: fixtures_from + i * _FIXTURE_SIZE for i, name in enumerate(self.fixtures)}
        self._things: _Things | None = None
        self.size = fixtures_from + f * _FIXTURE_SIZE

    def vector(self, scene: Rules, world: WorldState, robot: str) -> NDArray[np.float32]:
        """The world as `robot` sees it; shape (size,), values 0 or 1."""
        return self.vectors(scene, world, (robot,))[robot]

    def vectors(self, scene: Rules, world: WorldState, robots: Iterable[str]) -> dict[str, NDArray[np.float32]]:
        """The world as each of `robots` sees it; what they see alike is worked out once."""
        things = self._things
        if things is None or not things.are(scene, world):
            # Most rounds move robots alone: what was seen of the objects last time is then seen again.
            things = self._things = self._see_things(scene, world)
        # Texts are hashed once and found by identity, which states of robots are not.
        robots_now = tuple([(state.station, state.holding) for state in world.robots.values()])
        ones = things.ones.get(robots_now)
        if ones is None:
            ones = things.ones[robots_now] = self._see_robots(scene, world, things)
        told: dict[str, NDArray[np.float32]] = {}
        for robot in robots:
            values = told[robot] = things.values[robot].copy()
            values[ones[robot]] = 1.0
        return told

    def _see_things(self, scene: Rules, world: WorldState) -> _Things:
        at, slots, objects = self._at, scene.slots, world.objects
        ones: list[int] = []
        held: list[tuple[int, str]] = []
        at_station: dict[str, list[int]] = {}
        for name, item in objects.items():
            start = self._object_starts[name]
            ones.append(start)
            first, place = start + 1, item.place
            rest = first + len(at)
            if place.relation == "held":
                held.append((rest, place.where))
            elif place.relation == "floor":
                ones.append(rest + 2)
            while place.relation == "vessel":
                ones.append(first + at[place.where])
                place = objects[place.where].place
            if place.relation == "slot":
                slot = slots[place.where]
                ones += [first + at[around] for around in (place.where, slot.fixture) if around in at]
                for station in slot.stations:
                    at_station.setdefault(station, []).append(at[name])
            if item.marks:
                ones += [rest + 3 + self._marks.index(mark) for mark in item.marks if mark in self._marks]
        for name, state in world.fixtures.items():
            start = self._fixture_starts[name]
            ones.append(start)
            if state.door is not None:
                ones.append(start + 1 + _DOORS.index(state.door))
            if state.on:
                ones.append(start + 1 + len(_DOORS))
        values = {robot: np.zeros(self.size, dtype=np.float32) for robot in scene.robots}
        for robot in scene.robots:
            values[robot][ones + [place + (holder != robot) for place, holder in held]] = 1.0
        return _Things(scene, objects, world.fixtures, values, at_station)

    def _see_robots(self, scene: Rules, world: WorldState, things: _Things) -> dict[str, NDArray[np.intp]]:
        blocks = {name: self._block(scene, world.robots[name], things) for name in scene.robots}
        ones: dict[str, NDArray[np.intp]] = {}
        for robot in scene.robots:
            places, start = list(blocks[robot]), 0
            for name in scene.robots:
                if name != robot:
                    start += self._robot_size
                    places += [start + place for place in blocks[name]]
            ones[robot] = np.array(places, dtype=np.intp)
        return ones

    def _block(self, scene: Rules, state: RobotState, things: _Things) -> list[int]:
        """Places of the ones in a robot's block, from the beginning of the block."""
        aside = state.station == ASIDE
        ones = [0] if aside else [1 + self._at[name] for name in scene.used_from(state.station)]
        ones += [1 + index for index in things.at_station.get(state.station, ())]
        if state.holding is not None:
            ones.append(1 + self._at[state.holding] + len(self.objects))
        return ones
