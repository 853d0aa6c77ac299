"""Facts about the world as one vector of zeros and ones, sized by the vocabulary so that it never changes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from remac_env.conditions import stations_of
from remac_env.state import ASIDE, Scene, WorldState, supports
from remac_env.vocabulary import Vocabulary

_DOORS = ("closed", "ajar", "open")
_MARKS = ("washed", "seasoned")
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
        self.size = _ROBOTS * (1 + f + 2 * o) + o * (f + o + 6) + f * 5

    def vector(self, scene: Scene, world: WorldState, robot: str) -> NDArray[np.float32]:
        """The world as `robot` sees it; shape (size,), values 0 or 1."""
        values: list[float] = []
        order = [robot, *(name for name in scene.robots if name != robot)]
        for index in range(_ROBOTS):
            values += self._robot(scene, world, order[index] if index < len(order) else None)
        for name in self.objects:
            values += self._object(scene, world, name, robot)
        for name in self.fixtures:
            state = world.fixtures.get(name)
            doors = [state is not None and state.door == door for door in _DOORS]
            values += [state is not None, *doors, state is not None and bool(state.on)]
        return np.array(values, dtype=np.float32)

    def _robot(self, scene: Scene, world: WorldState, robot: str | None) -> list[float]:
        if robot is None:
            return [0.0] * (1 + len(self.fixtures) + 2 * len(self.objects))
        state = world.robots[robot]
        nouns = [*self.fixtures, *self.objects]
        known = [n in scene.fixtures or n in world.objects for n in nouns]
        at = [k and state.station in stations_of(scene, world, n) for n, k in zip(nouns, known, strict=True)]
        return [state.station == ASIDE, *at, *(state.holding == name for name in self.objects)]

    def _object(self, scene: Scene, world: WorldState, name: str, robot: str) -> list[float]:
        if name not in world.objects:
            return [0.0] * (len(self.fixtures) + len(self.objects) + 6)
        item = world.objects[name]
        around = supports(scene, world, name)
        inside = [other in around for other in (*self.fixtures, *self.objects)]
        held = item.place.relation == "held"
        own = held and item.place.where == robot
        marks = [mark in item.marks for mark in _MARKS]
        return [True, *inside, own, held and not own, item.place.relation == "floor", *marks]
