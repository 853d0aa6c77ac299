"""What a robot's skills work with: what is sensed, what is known of the kitchen, what keeps clear, and the hand."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from remac_env.backends.physics.controllers.scripted.collision import IGNORED, CollisionChecker
from remac_env.backends.physics.controllers.scripted.motion import Mover
from remac_env.backends.physics.controllers.scripted.paths import Planner
from remac_env.backends.physics.controllers.scripted.robot import Robot, View
from remac_env.kitchen.fixtures import Fixture
from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.kitchen.frame import WORLD
from remac_env.kitchen.objects.catalogue import Category
from remac_env.robots.rotation import Array

_FACING = 0.5 * math.pi  # rad, heading of a robot that faces its wall, in the wall's frame


@dataclass
class Hand:
    """What a robot holds, and how that was turned when it stood: leaning hands must set it upright again."""

    body: str | None = None
    upright: Array = field(default_factory=lambda: np.eye(3))
    contents: tuple[str, ...] = ()
    away: float = 0.0  # m between its frame and the grip site when it was taken


@dataclass(frozen=True)
class Kitchen:
    """What is known of the kitchen: its floor plan, and what objects there are by name."""

    layout: Layout
    objects: Mapping[str, Category]

    def fixture(self, name: str) -> Fixture:
        """A fixture of the layout."""
        return self.layout.fixtures[name]


@dataclass
class Clear:
    """What keeps the robot clear: collision checks, planned ways, and the objects on the floor that it keeps off."""

    checker: CollisionChecker
    planner: Planner
    litter: frozenset[str] = frozenset()


@dataclass
class Workspace:
    """One robot with everything its skills need, expressed in the frame of the wall that the robot faces.

    A skill that is right at one wall is right at every wall: poses are read, and configurations given, in this frame.
    ``midway``: objects are picked up from where the arm is, without folding it first: for demonstrations from there.
    """

    sensed: View
    kitchen: Kitchen
    clear: Clear
    robot: Robot
    mover: Mover
    hand: Hand
    station: Station
    midway: bool = False

    def enter(self, station: Station) -> None:
        """Take ``station`` (frame of the room) for the robot's own; from now on the frame is that of its wall."""
        frame = self.kitchen.layout.facing(station)
        if station.wall:
            turns = round((self.robot.in_world(self.robot.q)[2] - _FACING) / _FACING)
            frame = replace(frame, quarters=turns)
        self.robot.enter(frame)
        near = station.seen_from(frame)
        # The robot may have gone round since; its station is the same direction at the nearest value of its joint.
        rounds = round((near.yaw - float(self.robot.q[2])) / math.tau)
        self.station = replace(near, yaw=near.yaw - rounds * math.tau)

    def leave(self) -> None:
        """Express everything in the frame of the room, as drives do."""
        self.robot.enter(WORLD)

    @property
    def place(self) -> Station:
        """The robot's station, in the frame of the room."""
        return self.kitchen.layout.stations.get(self.station.name, self.station)

    @property
    def home(self) -> Array:
        """The base pose (3,) at the station."""
        return np.array([self.station.x, self.station.y, self.station.yaw])

    def begin(
        self, target: Iterable[int] = (), *, held_meets: bool = True, avoid: Collection[str] = ()
    ) -> None:
        """Check paths in the world as it is seen now, with what the hand holds.

        avoid: objects on the floor to keep off; by default those of `clear.litter`.
        """
        checker, hand = self.clear.checker, self.hand
        checker.begin(target=target, held=hand.body, contents=hand.contents, held_meets=held_meets)
        for body in self.kitchen.objects:
            # What lies on the floor is pushed aside by the base, and must not keep the robot from moving.
            if body != hand.body and body not in (avoid or self.clear.litter) and self.sensed.on_floor(body):
                checker.mark(self.sensed.geoms(body), IGNORED)
        checker.fingers(self.robot.grip if hand.body is None else 0.5 * self.robot.opening)
