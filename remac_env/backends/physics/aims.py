"""What a skill is about, in numbers: where the hand is wanted, how the target is turned, and how far it has come.

An aim is made when a skill begins, `update` is called once a control period, and everything is told in the robot's
frame, as the robot sees it.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from remac_env.backends.physics.controllers.scripted.robot import Robot
from remac_env.backends.physics.controllers.scripted.skill import EMPTY, Surroundings
from remac_env.kitchen.fixtures.actuator import Actuator
from remac_env.kitchen.fixtures.door import OPEN_TO, Door
from remac_env.kitchen.fixtures.level import Level
from remac_env.robots.rotation import Array
from remac_env.rules.facts import Rules
from remac_env.rules.places import landing, switch_for
from remac_env.rules.subtasks import Subtask
from remac_env.state import CLOSED_MAX, OPEN_MIN, Place, WorldState

_RISE = 0.10  # m that a thing is lifted once it is picked up for certain
_HELD_PART = 0.5  # of picking up that is done once the hand holds the thing
_IN_HAND = 0.15  # m between the hand and the frame of what it holds, at most
_SQUEEZED = 0.001  # m by which fingers are commanded closer than they come, where something is between them


@dataclass(frozen=True)
class Target:
    """What is known of a target. Lengths m, angles rad.

    at: where the hand is wanted (3,). yaw: about the vertical. size: half extents (3,) of a thing, or the handle's
    place on a leaf. grasp: how a thing is grasped: height, width, lean, and 1 where from any side. joint, goal: where a
    joint stands and is to stand. side: 1 for a leaf hinged on the left or a joint turned upright, -1 for the right.
    worked: 1 once a button has been pressed by this skill.
    """

    at: Array
    yaw: float = 0.0
    size: tuple[float, float, float] = (0.0, 0.0, 0.0)
    grasp: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    joint: float = 0.0
    goal: float = 0.0
    side: float = 0.0
    worked: float = 0.0


class Aim(ABC):
    """Of one skill of one robot."""

    def __init__(self, here: Surroundings) -> None:
        self._here = here

    @abstractmethod
    def target(self) -> Target:
        """What is seen of it now."""

    @abstractmethod
    def done(self) -> float:
        """How much of the skill is done, 0..1, apart from bringing the hand there."""

    def update(self) -> None:
        """Take the last control period into account."""
        return

    @property
    def by_hand(self) -> bool:
        """Whether the hand has to come to `target().at`."""
        return True


def aim_of(here: Surroundings, scene: Rules, world: WorldState, robot: str, subtask: Subtask) -> Aim:
    """The aim of a subtask that begins in this world and that the skill table would not refuse."""
    name, row = subtask.target, subtask.row
    wanted = [condition.predicate for condition in subtask.achieves(robot, None)]
    if row.goes is not None:
        return _Stand(here)
    if row.target == "door":
        return _Leaves(here, name, OPEN_TO if "door_open" in wanted else 0.0)
    if row.target == "switch":
        on = "switched_on" in wanted
        switches = [switch_for(scene, world, name)] if on else sorted(world.fixtures[name].on)
        return _Switch(here, next(a for a in here.fixture(name).actuators if a.switch in switches), on=on)
    if row.takes:
        return _Taken(here, name)
    place = landing(scene, world, robot, name) if row.puts else None
    return _Thing(here, name) if place is None else _Put(here, place)


def feels(robot: Robot) -> bool:
    """Whether a hand feels something between its fingers."""
    return robot.opening > EMPTY and robot.grip < 0.5 * robot.opening - _SQUEEZED


class _Stand(Aim):
    """The station at which the robot is to stand."""

    def __init__(self, here: Surroundings) -> None:
        super().__init__(here)
        self._first = max(1e-6, self._away())

    @property
    def by_hand(self) -> bool:
        """Driving is the base's."""
        return False

    def target(self) -> Target:
        """The station itself, on the floor."""
        x, y, yaw = self._here.home
        return Target(np.array([x, y, 0.0]), yaw)

    def done(self) -> float:
        """The share of the way that is behind the robot."""
        return max(0.0, 1.0 - self._away() / self._first)

    def _away(self) -> float:
        q = self._here.robot.measured
        turn = math.remainder(float(q[2] - self._here.home[2]), math.tau)
        return float(math.hypot(*(q[:2] - self._here.home[:2])) + 0.3 * abs(turn))


class _Leaves(Aim):
    """The leaves of a door, or a drawer: the one nearer to the robot first, each until it is there and let go."""

    def __init__(self, here: Surroundings, name: str, opened: float) -> None:
        super().__init__(here)
        aside = float(here.robot.q[0])
        self._leaves = sorted(here.fixture(name).leaves, key=lambda leaf: abs(self._handle(leaf)[0] - aside))
        self._opened, self._turn = opened, 0
        self._first = [self._at(leaf) for leaf in self._leaves]

    def update(self) -> None:
        """Go on to the next leaf once one is where it is wanted and the hand has let go of it."""
        last = len(self._leaves) - 1
        while self._turn < last and self._there(self._leaves[self._turn]) and not feels(self._here.robot):
            self._turn += 1

    def target(self) -> Target:
        """The handle of the leaf whose turn it is."""
        leaf = self._leaves[self._turn]
        joint, turned = self._here.simulation.joint(leaf.joint), self._here.simulation.turned(leaf.joint)
        hinged = leaf.sign if isinstance(leaf, Door) else 0.0
        x, y, z = (float(value) for value in self._here.simulation.model.site(leaf.grip).pos)
        return Target(
            self._handle(leaf), turned - hinged * joint, (x, y, z) if hinged else (0.0, 0.0, 0.0),
            joint=joint, goal=leaf.position(self._opened), side=hinged,
        )  # fmt: skip

    def done(self) -> float:
        """The share of their ways that the leaves have gone."""
        ways = zip(self._leaves, self._first, strict=True)
        return float(np.mean([_share(self._at(leaf), first, self._opened) for leaf, first in ways]))

    def _handle(self, leaf: Door | Level) -> Array:
        return self._here.simulation.pose(leaf.grip)[0]

    def _at(self, leaf: Door | Level) -> float:
        return leaf.opened(self._here.simulation.joint(leaf.joint))

    def _there(self, leaf: Door | Level) -> bool:
        return self._at(leaf) >= OPEN_MIN if self._opened > 0.0 else self._at(leaf) <= CLOSED_MAX


def _share(now: float, first: float, goal: float) -> float:
    """The share of the way from `first` to `goal` that has been gone."""
    way = goal - first
    return float(np.clip((now - first) / way, 0.0, 1.0)) if abs(way) > 1e-6 else 1.0


class _Switch(Aim):
    """What the hand works to turn something on or off."""

    def __init__(self, here: Surroundings, actuator: Actuator, *, on: bool) -> None:
        super().__init__(here)
        self._actuator = actuator
        self._goal = actuator.worked if on or actuator.springs_back else 0.0
        self._first = self._furthest = here.simulation.joint(actuator.joint)

    def update(self) -> None:
        """Remember how far a button was pressed."""
        self._furthest = max(self._furthest, self._here.simulation.joint(self._actuator.joint))

    def target(self) -> Target:
        """Where the hand takes hold of it or pushes, as it is turned now."""
        simulation, actuator = self._here.simulation, self._actuator
        joint = actuator.joint
        upright = abs(simulation.model.joint(joint).axis[2]) > 0.5
        worked = actuator.springs_back and self._furthest >= actuator.counts
        return Target(
            simulation.pose(actuator.site)[0], simulation.turned(joint), joint=simulation.joint(joint),
            goal=self._goal, side=float(upright), worked=float(worked),
        )  # fmt: skip

    def done(self) -> float:
        """The share of its way that it has gone; of a button's, the furthest."""
        if self._actuator.springs_back:
            return min(1.0, max(0.0, self._furthest / self._actuator.counts))
        return _share(self._here.simulation.joint(self._actuator.joint), self._first, self._goal)


class _Thing(Aim):
    """A thing that stays where it is, as food that is to be seasoned."""

    def __init__(self, here: Surroundings, name: str) -> None:
        super().__init__(here)
        self._name, self._kind = name, here.things[name]

    def target(self) -> Target:
        """The thing as it is seen, with how it is to be grasped."""
        position, axes = self._here.simulation.pose(self._name)
        axis = axes[:, 0] if abs(axes[2, 0]) < 0.8 else axes[:, 1]
        grasp = self._kind.grasp
        return Target(
            position, math.atan2(axis[1], axis[0]), self._kind.size,
            (grasp.height, grasp.width, grasp.lean[0], float(grasp.any_yaw)),
        )

    def done(self) -> float:
        """Nothing shows it."""
        return 0.0


class _Taken(_Thing):
    """A thing that is to be taken into the hand."""

    def __init__(self, here: Surroundings, name: str) -> None:
        super().__init__(here, name)
        self._lay = float(here.simulation.pose(name)[0][2])

    def done(self) -> float:
        """Half once it is held, the rest as it rises."""
        position, _ = self._here.simulation.pose(self._name)
        if not feels(self._here.robot) or np.linalg.norm(position - self._here.robot.grip_pose()[0]) > _IN_HAND:
            return 0.0
        risen = float(position[2]) - self._lay
        return _HELD_PART + (1.0 - _HELD_PART) * float(np.clip(risen / _RISE, 0.0, 1.0))


class _Put(Aim):
    """Where what is held is to be put down."""

    def __init__(self, here: Surroundings, place: Place) -> None:
        super().__init__(here)
        self._place, self._body = place, str(here.hand.body)
        self._first = max(1e-6, self._away())

    def target(self) -> Target:
        """Where its frame is to come, with its size."""
        kind = self._here.things[self._body]
        return Target(self._spot() + [0.0, 0.0, kind.rest_height], size=kind.size)

    def done(self) -> float:
        """The share of its way that the thing has gone."""
        return max(0.0, 1.0 - self._away() / self._first)

    def _spot(self) -> Array:
        here, where = self._here, self._place.where
        if self._place.relation == "vessel":
            return np.asarray(here.simulation.pose(where)[0] + [0.0, 0.0, here.things[where].inside_height])
        slot = here.layout.slots[where]
        opened = max(here.reading(slot.fixture).door_angles, default=0.0)
        return here.simulation.located(slot.fixture, np.array(slot.center) + here.fixture(slot.fixture).shift(opened))

    def _away(self) -> float:
        return float(np.linalg.norm(self._here.simulation.pose(self._body)[0] - self.target().at))
