"""The aims of skills: what there is to see of doors, switches, and objects that are taken and put."""

from __future__ import annotations

import math

import numpy as np

from remac_env.backends.physics.controllers.base import Sensing
from remac_env.backends.physics.controllers.learned.aim import CLEAR, Aim, Target, feels
from remac_env.backends.physics.controllers.learned.drive import Drive
from remac_env.backends.physics.controllers.learned.stand import Stand
from remac_env.kitchen.fixtures.actuator import Actuator
from remac_env.kitchen.fixtures.door import OPEN_TO, Door
from remac_env.kitchen.fixtures.level import Level
from remac_env.kitchen.scene import build_scene
from remac_env.robots import bodies
from remac_env.robots.bodies import STANDARD
from remac_env.robots.rotation import Array, rotation_vector
from remac_env.rules.places import landing, switch_for
from remac_env.rules.subtasks import Subtask
from remac_env.state import CLOSED_MAX, OPEN_MIN, Place

_RISE = 0.10  # m that an object is lifted once it is picked up for certain
_ROLLED = 0.05  # m by which an object that was missed lies higher or lower at most; else it has fallen
_HELD_PART = 0.5  # of picking up that is done once the hand holds the object
_IN_HAND = 0.15  # m between the hand and the frame of what it holds, at most
_HELD_OFF = 0.06  # m by which a hand holds it at most from where it is to be grasped, where that is further off
_THERE = 0.08  # m from its spot at which an object has been put there


def aim_of(subtask: Subtask, sensing: Sensing, body: str = STANDARD) -> Aim:
    """The aim of a subtask that begins now and that the skill table does not refuse. ``body``: of the robot."""
    name, row, layout, world = subtask.target, subtask.row, sensing.layout, sensing.told
    stand = Stand.at(layout, sensing.goal or sensing.station)
    wanted = [condition.predicate for condition in subtask.achieves(sensing.name, None)]
    if row.goes is not None:
        return Drive(sensing, stand, bodies.get(body))
    if row.target == "door":
        return _Panels(sensing, stand, name, OPEN_TO if "door_open" in wanted else 0.0)
    rules = build_scene(layout, sensing.objects, (sensing.name,))
    if row.target == "switch":
        on = "switched_on" in wanted
        switches = [switch_for(rules, world, name)] if on else sorted(world.fixtures[name].on)
        actuator = next(each for each in layout.fixtures[name].actuators if each.switch in switches)
        return _Switch(sensing, stand, name, actuator, on=on)
    if row.takes:
        return _Taken(sensing, stand, name)
    place = landing(rules, world, sensing.name, name) if row.puts else None
    held = world.robots[sensing.name].holding
    return _Object(sensing, stand, name) if place is None or held is None else _Put(sensing, stand, held, place)


class _Panels(Aim):
    """The panels of a door, or a drawer: the one nearer to the robot first, each until it is there and let go."""

    def __init__(self, sensing: Sensing, stand: Stand, name: str, opened: float) -> None:
        super().__init__(sensing, stand)
        self._name, self._opened, self._turn = name, opened, 0
        panels = list(enumerate(sensing.layout.fixtures[name].door_panels))
        aside = stand.joints(sensing.body.q)[0]
        self._panels = sorted(panels, key=lambda each: abs(self._handle(each[1])[0] - aside))
        self._first = sensing.reading(name).door_angles

    def update(self) -> None:
        """Go on to the next panel once one is where it is wanted and the hand has let go of it."""
        last = len(self._panels) - 1
        while self._turn < last and self._there(self._panels[self._turn][0]) and not feels(self._sensing.body):
            self._turn += 1

    def achieved(self) -> bool:
        """Whether every panel is where it is wanted."""
        return all(self._there(number) for number, _ in self._panels)

    def missed(self) -> bool:
        """Where one is not."""
        return not self.achieved()

    def target(self) -> Target:
        """The handle of the panel whose turn it is."""
        number, panel = self._panels[self._turn]
        hinged = panel.sign if isinstance(panel, Door) else 0.0
        joint, bar = panel.position(self._angles[number]), panel.bar if hinged else (0.0, 0.0, 0.0)
        goal = panel.position(self._opened)
        return Target(self._handle(panel), -hinged * joint, bar, joint=joint, goal=goal, side=hinged)

    def done(self) -> float:
        """The share of their ways that the panels have gone."""
        return float(np.mean([_share(*way, self._opened) for way in zip(self._angles, self._first, strict=True)]))

    @property
    def _angles(self) -> tuple[float, ...]:
        return self._sensing.reading(self._name).door_angles

    def _handle(self, panel: Door | Level) -> Array:
        return self.stand.point(self._sensing.pose(panel.grip).position)

    def _there(self, number: int) -> bool:
        angle = self._angles[number]
        return angle >= OPEN_MIN if self._opened > 0.0 else angle <= CLOSED_MAX


def _share(now: float, first: float, goal: float) -> float:
    """The share of the way from `first` to `goal` that has been gone."""
    way = goal - first
    return float(np.clip((now - first) / way, 0.0, 1.0)) if abs(way) > 1e-6 else 1.0


class _Switch(Aim):
    """What the hand works to turn something on or off."""

    def __init__(self, sensing: Sensing, stand: Stand, name: str, actuator: Actuator, *, on: bool) -> None:
        super().__init__(sensing, stand)
        self._name, self._actuator, self._pressed = name, actuator, False
        self._goal = actuator.worked if on or actuator.springs_back else 0.0
        self._rest = stand.point(sensing.pose(actuator.joint).position)
        self._first = self._furthest = self._position()

    def update(self) -> None:
        """Remember whether a button was pressed, and how far."""
        self._furthest = max(self._furthest, self._position())
        self._pressed |= self._actuator.switch in self._sensing.reading(self._name).pressed

    def achieved(self) -> bool:
        """Whether the switch is on, or off, or its button was pressed."""
        if self._actuator.springs_back:
            return self._pressed
        return (self._actuator.switch in self._sensing.reading(self._name).on) == (self._goal > 0.0)

    def missed(self) -> bool:
        """Where it is not so."""
        return not self.achieved()

    def target(self) -> Target:
        """Where the hand takes hold of it or pushes, as it is turned now."""
        at = self.stand.point(self._sensing.pose(self._actuator.site).position)
        return Target(at, joint=self._position(), goal=self._goal, worked=float(self._pressed))

    def done(self) -> float:
        """The share of its way that it has gone; of a button's, the furthest."""
        if self._actuator.springs_back:
            return 1.0 if self._pressed else float(np.clip(self._furthest / self._actuator.counts, 0.0, 1.0))
        return _share(self._position(), self._first, self._goal)

    def _position(self) -> float:
        """Where its joint stands, rad from rest; of a button m from where it was."""
        pose = self._sensing.pose(self._actuator.joint)
        if self._actuator.springs_back:
            return float(np.linalg.norm(self.stand.point(pose.position) - self._rest))
        return float(np.linalg.norm(rotation_vector(self.stand.turn(pose.rotation))))


class _Object(Aim):
    """An object that stays where it is, as food that is to be seasoned."""

    def __init__(self, sensing: Sensing, stand: Stand, name: str) -> None:
        super().__init__(sensing, stand)
        self._name, self._kind = name, sensing.objects[name]

    def target(self) -> Target:
        """The object as it is seen, with how it is to be grasped."""
        pose = self._sensing.pose(self._name)
        axes, grasp = self.stand.turn(pose.rotation), self._kind.grasp
        axis = axes[:, 0] if abs(axes[2, 0]) < 0.8 else axes[:, 1]
        return Target(
            self.stand.point(pose.position), math.atan2(axis[1], axis[0]), self._kind.size,
            (grasp.height, grasp.width, grasp.lean[0], float(grasp.any_yaw)),
        )  # fmt: skip

    def done(self) -> float:
        """Nothing shows it."""
        return 0.0


class _Taken(_Object):
    """An object that is to be taken into the hand."""

    def __init__(self, sensing: Sensing, stand: Stand, name: str) -> None:
        super().__init__(sensing, stand, name)
        self._lay, grasp = float(sensing.pose(name).position[2]), self._kind.grasp
        self._within = max(_IN_HAND, math.hypot(max(grasp.reach, default=0.0), grasp.height) + _HELD_OFF)

    def missed(self) -> bool:
        """Where the hand is empty, and it lies about as high as it did."""
        return self.done() == 0.0 and abs(float(self._sensing.pose(self._name).position[2]) - self._lay) < _ROLLED

    def over(self) -> bool:
        """Once it is held and has risen."""
        return self.achieved()

    def done(self) -> float:
        """Half once it is held, the rest as it rises."""
        body, at = self._sensing.body, self._sensing.pose(self._name).position
        if not feels(body) or np.linalg.norm(at - body.grip.position) > self._within:
            return 0.0
        return _HELD_PART + (1.0 - _HELD_PART) * float(np.clip((at[2] - self._lay) / _RISE, 0.0, 1.0))


class _Put(Aim):
    """Where what is held is to be put down."""

    def __init__(self, sensing: Sensing, stand: Stand, held: str, place: Place) -> None:
        super().__init__(sensing, stand)
        self._held, self._place = held, place
        self._first = max(1e-6, self._away())
        self._let_go = sensing.body.grip.position

    def update(self) -> None:
        """Remember where the hand last held it."""
        if feels(self._sensing.body):
            self._let_go = self._sensing.body.grip.position

    def over(self) -> bool:
        """Once the hand has let go of it and is clear, wherever it lies now: there is no more to do."""
        gone = float(np.linalg.norm(self._sensing.body.grip.position - self._let_go))
        return not feels(self._sensing.body) and gone > CLEAR

    def target(self) -> Target:
        """Where its frame is to come, with its size."""
        kind = self._sensing.objects[self._held]
        return Target(self._spot() + [0.0, 0.0, kind.rest_height], size=kind.size)

    def achieved(self) -> bool:
        """Whether it is about there."""
        return self._away() < _THERE

    def missed(self) -> bool:
        """Where it is not, and still in the hand."""
        return not self.achieved() and feels(self._sensing.body)

    def done(self) -> float:
        """The share of its way that the object has gone."""
        return max(0.0, 1.0 - self._away() / self._first)

    def _spot(self) -> Array:
        where = self._place.where
        if self._place.relation == "vessel":
            inside = np.array([0.0, 0.0, self._sensing.objects[where].inside_height])
            return self.stand.point(self._sensing.pose(where).position + inside)
        return self.stand.point(self._sensing.slot(where).position)

    def _away(self) -> float:
        at = self.stand.point(self._sensing.pose(self._held).position)
        return float(np.linalg.norm(at - self.target().at))
