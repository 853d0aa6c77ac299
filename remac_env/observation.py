"""Facts about the world as one vector of zeros and ones, sized by the vocabulary so that it never changes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from remac_env.state import ASIDE, Scene, WorldState, base_place, supports
from remac_env.vocabulary import Vocabulary

_DOORS = ("closed", "ajar", "open")
_MARKS = ("washed", "seasoned")
_FIXTURE_SIZE = 5
_ROBOTS = 2  # blocks: the robot itself, then the other one (zeros where there is none)


class Facts:
    """Writes WorldStates as vectors.

    Layout, with F fixture nouns and O object nouns of the vocabulary: two robot blocks of 1 + F + O + O (aside; at each
    fixture; at each object; holding each object), the own one first; O object blocks of 1 + F + O + 3 + 2 (present; in
    each fixture; on each object; held by oneself, held by another, on the floor; washed, seasoned); F fixture blocks of
    1 + 3 + 1 (present; door closed, ajar, open; on).
    """

    def __init__(self, vocabulary: Vocabulary) -> None:
        self.fixtures = tuple(noun.name for noun in vocabulary.nouns if noun.kind == "fixture")
        self.objects = tuple(noun.name for noun in vocabulary.nouns if noun.kind == "object")
        f, o = len(self.fixtures), len(self.objects)
        self._at = {name: index for index, name in enumerate((*self.fixtures, *self.objects))}
        self._robot_size, self._object_size = 1 + f + 2 * o, f + o + 6
        self._objects_from = _ROBOTS * self._robot_size
        self._fixtures_from = self._objects_from + o * self._object_size
        self.size = self._fixtures_from + f * _FIXTURE_SIZE

    def vector(self, scene: Scene, world: WorldState, robot: str) -> NDArray[np.float32]:
        """The world as `robot` sees it; shape (size,), values 0 or 1."""
        ones: list[int] = []
        order = [robot, *(name for name in scene.robots if name != robot)]
        for index, name in enumerate(order[:_ROBOTS]):
            ones += self._robot(scene, world, name, index * self._robot_size)
        for name in world.objects:
            ones += self._object(scene, world, name, robot)
        for name, state in world.fixtures.items():
            start = self._fixtures_from + self._at[name] * _FIXTURE_SIZE
            ones.append(start)
            if state.door is not None:
                ones.append(start + 1 + _DOORS.index(state.door))
            if state.on:
                ones.append(start + 1 + len(_DOORS))
        values = np.zeros(self.size, dtype=np.float32)
        values[ones] = 1.0
        return values

    def _robot(self, scene: Scene, world: WorldState, robot: str, start: int) -> list[int]:
        """Places of the ones in a robot's block."""
        state, first = world.robots[robot], start + 1
        ones = [start] if state.station == ASIDE else [first + self._at[n] for n in scene.used_from(state.station)]
        for name in world.objects:
            place = base_place(world, name)
            if place.relation == "slot" and scene.slots[place.where].station == state.station:
                ones.append(first + self._at[name])
        if state.holding is not None:
            ones.append(first + self._at[state.holding] + len(self.objects))
        return ones

    def _object(self, scene: Scene, world: WorldState, name: str, robot: str) -> list[int]:
        """Places of the ones in an object's block."""
        start = self._objects_from + (self._at[name] - len(self.fixtures)) * self._object_size
        item, first = world.objects[name], start + 1
        ones = [start, *(first + self._at[other] for other in supports(scene, world, name) if other in self._at)]
        rest = first + len(self._at)
        if item.place.relation == "held":
            ones.append(rest + (item.place.where != robot))
        elif item.place.relation == "floor":
            ones.append(rest + 2)
        return [*ones, *(rest + 3 + _MARKS.index(mark) for mark in item.marks if mark in _MARKS)]
