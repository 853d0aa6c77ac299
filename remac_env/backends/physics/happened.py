"""What happened does not always show in where objects are: buttons that were pressed, and objects that were seasoned.

Both are read from the simulation at every control step. What a controller believes to have done plays no part.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from remac_env.backends.physics.bodies import Bodies
from remac_env.backends.physics.simulation import CONTROL_PERIOD
from remac_env.kitchen.fixtures import Fixture, FixtureReading
from remac_env.kitchen.floor_plan import Layout
from remac_env.kitchen.objects.catalogue import Category
from remac_env.robots.rotation import Array
from remac_env.rules.facts import Rules
from remac_env.rules.marks import SEASONED

_LET_GO = 3  # control periods for which a button has to be out before it can be pressed again

# A shaker gives grains when it is jerked with its top down. Hands shake with 5 m/s2 and more; a hand that carries it
# stays below 2 m/s2 and does not tip it.
JERK = 2.0  # m/s2, of the shaker along the vertical
TIPPED = -0.1  # z component of its axis from which on its top points down
JERKS = 4  # of them, to and fro in turn, season what lies below
SCATTER = 0.2  # m to each side of the shaker's top that grains fly: 1 m/s for the 0.2 s of a fall
HIGHEST = 0.45  # m of the shaker over an object from which grains still land on it


@dataclass
class _Button:
    """A push button's fixture, and for how many control periods it has been out.

    addresses: of its joints, in qpos; at: their positions when they were read last; reading: what they said then.
    """

    fixture: Fixture
    addresses: NDArray[np.int_]
    out: int = _LET_GO
    at: list[float] = field(default_factory=list)
    reading: FixtureReading = FixtureReading()


@dataclass
class _Shaker:
    """How a shaker moved: height and vertical speed at the last step, and jerks since it was tipped by object below."""

    height: float = math.nan
    speed: float = math.nan
    side: float = 0.0
    jerks: dict[str, int] = field(default_factory=dict)


class Happened:
    """``running``: switches that push buttons have left on. ``marks``: of an object, those that no pose shows.

    ``update`` is to be called after every control step.
    """

    def __init__(
        self, simulation: Bodies, scene: Rules, layout: Layout, objects: Mapping[str, Category], on: Collection[str]
    ) -> None:
        self._simulation, self._scene, self._objects = simulation, scene, objects
        self._buttons = [self._button(fixture) for fixture in layout.fixtures.values() if fixture.buttons]
        self._shakers = {name: _Shaker() for name, kind in objects.items() if kind.seasons}
        pushed = {button.switch for fixture in layout.fixtures.values() for button in fixture.buttons}
        self.running = frozenset(on) & pushed
        self.marks: dict[str, frozenset[str]] = {}

    def update(self) -> None:
        """Take the last control step into account."""
        for button in self._buttons:
            self._watch_button(button)
        for name, shaker in self._shakers.items():
            self._watch_shaker(name, shaker)

    def _button(self, fixture: Fixture) -> _Button:
        joints = (self._simulation.model.joint(name) for name in fixture.joints(0.0, frozenset()))
        return _Button(fixture, np.array([joint.qposadr[0] for joint in joints]))

    def _watch_button(self, button: _Button) -> None:
        """A press starts what stands still and stops what runs; a door that is not shut stops what runs only shut."""
        fixture, simulation = button.fixture, self._simulation
        at = simulation.data.qpos[button.addresses].tolist()
        if at != button.at:  # what sleeps stands still to the last bit
            button.at, button.reading = at, fixture.read(simulation.model, simulation.data)
        reading = button.reading
        if reading.pressed and button.out >= _LET_GO:
            self.running = self.running ^ reading.pressed
        button.out = 0 if reading.pressed else button.out + 1
        facts = self._scene.fixtures.get(fixture.name)
        if self.running and facts is not None and facts.shut_to_run and reading.door not in (None, "closed"):
            self.running -= frozenset(fixture.switches)

    def _watch_shaker(self, name: str, shaker: _Shaker) -> None:
        """Count jerks that change sides, for what lies where the grains fall."""
        pose = self._simulation.pose(name)
        position, rotation = pose.position, pose.rotation
        height, before = float(position[2]), shaker.height
        speed, last = (height - before) / CONTROL_PERIOD, shaker.speed
        shaker.height, shaker.speed = height, speed
        if rotation[2, 2] > TIPPED:
            shaker.jerks, shaker.side = {}, 0.0
            return
        pull = (speed - last) / CONTROL_PERIOD
        side = math.copysign(1.0, pull)
        if not abs(pull) >= JERK or side == shaker.side:
            return
        shaker.side = side
        obj = self._below(name, position, rotation)
        if obj is None:
            return
        shaker.jerks[obj] = shaker.jerks.get(obj, 0) + 1
        if shaker.jerks[obj] >= JERKS:
            self.marks[obj] = self.marks.get(obj, frozenset()) | {SEASONED}

    def _below(self, name: str, position: Array, rotation: Array) -> str | None:
        """The object on which most grains land that leave the shaker's top now: the nearest in reach, on top."""
        top = position + rotation[:, 2] * 2.0 * self._objects[name].size[2]
        found: list[tuple[float, float, str]] = []
        for obj, kind in self._objects.items():
            at = self._simulation.pose(obj).position
            if obj != name and 0.0 < top[2] - at[2] < HIGHEST:
                miss = max(0.0, math.dist(at[:2], top[:2]) - max(kind.size[:2]))
                found += [(miss, -float(at[2]), obj)] if miss <= SCATTER else []
        return min(found)[2] if found else None
