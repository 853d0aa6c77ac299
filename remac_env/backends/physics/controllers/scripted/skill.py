"""What all skills share: their surroundings, how they fail, and how they come home."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise, product

import mujoco
import numpy as np

from remac_env.backends.physics.controllers.scripted.collision import IGNORED, TRANSIT_MARGIN, Scratch
from remac_env.backends.physics.controllers.scripted.motion import Mover, Steps
from remac_env.backends.physics.controllers.scripted.paths import Path, Planner
from remac_env.backends.physics.controllers.scripted.robot import Robot, View
from remac_env.backends.physics.controllers.scripted.verdicts import FREE, Free, Hit
from remac_env.backends.physics.pose import Pose
from remac_env.kitchen.fixtures import Fixture, FixtureReading
from remac_env.kitchen.floor_plan import Layout, Station
from remac_env.kitchen.frame import WORLD
from remac_env.kitchen.objects.catalogue import Category
from remac_env.robots.body import Kinematics
from remac_env.robots.rotation import Array
from remac_env.rules.outcomes import Reason

_FACING = 0.5 * math.pi  # rad, heading of a robot that faces its wall, in the wall's frame
STATION_REACH = 0.34  # m, how far aside of its station a robot may stand within a skill
FRONT_LIMIT = -0.20  # y of the arm axis nearest to the counters (their fronts are at 0, the base reaches 0.15 ahead)
EMPTY = 0.002  # m between fingers that hold nothing; the thinnest wall that they hold is 5 mm
_SLIPPED = 0.06  # m by which a thing may move in the hand and still be held
_TIGHT, _LOOKS = 0.5, 0.12  # share of its speed with which an arm goes that has little room; rad between looks for that
_LADEN = 0.6  # share of the usual speeds at which a full hand is drawn in
_RISES = (0.08, 0.16, 0.24)  # m by which a hand is raised that cannot be folded where it is
_SLANTS = ((0.0, 0.0), (0.0, -0.1), (0.1, -0.05), (-0.1, -0.05))  # m by which it may go aside and back on the way
_HARDLY = 0.001  # m around the arm meanwhile
_FLOOR_THING = 0.4  # m; things lower than this have fallen down


class SkillFailure(Exception):
    """A skill gave up. ``reason`` is one of the closed list in :mod:`remac_env.rules.outcomes`."""

    def __init__(self, reason: Reason, detail: str = "") -> None:
        super().__init__(f"{reason}: {detail}")
        self.reason, self.detail = reason, detail


@dataclass
class Hand:
    """What a robot holds, and how that was turned when it stood: leaning hands must set it upright again."""

    body: str | None = None
    upright: Array = field(default_factory=lambda: np.eye(3))
    contents: tuple[str, ...] = ()
    away: float = 0.0  # m between its frame and the grip site when it was taken


@dataclass
class Surroundings:
    """One robot with everything its skills need, all of it told in the frame of the wall that the robot faces.

    A skill that is right at one wall is right at every wall: poses are read, and configurations given, in this frame.
    """

    simulation: View
    robot: Robot
    layout: Layout
    things: Mapping[str, Category]
    kinematics: Kinematics
    scratch: Scratch
    planner: Planner
    mover: Mover
    hand: Hand
    station: Station
    keep_off: frozenset[str] = frozenset()

    def enter(self, station: Station) -> None:
        """Take ``station`` (world frame) for the robot's own; from now on all is told in the frame of its wall."""
        frame = self.layout.facing(station)
        if station.wall:
            turns = round((self.robot.in_world(self.robot.q)[2] - _FACING) / _FACING)
            frame = replace(frame, quarters=turns)
        self.robot.enter(frame)
        near = station.seen_from(frame)
        # The robot may have gone round since; its station is the same direction at the nearest value of its joint.
        rounds = round((near.yaw - float(self.robot.q[2])) / math.tau)
        self.station = replace(near, yaw=near.yaw - rounds * math.tau)

    def leave(self) -> None:
        """Tell everything in the frame of the room, as drives do."""
        self.robot.enter(WORLD)

    @property
    def place(self) -> Station:
        """The robot's station in the world."""
        return self.layout.stations.get(self.station.name, self.station)

    @property
    def home(self) -> Array:
        """The base pose (3,) at the station."""
        return np.array([self.station.x, self.station.y, self.station.yaw])

    def fixture(self, name: str) -> Fixture:
        """A fixture of the layout."""
        return self.layout.fixtures[name]

    def reading(self, name: str) -> FixtureReading:
        """What a fixture's joints say now."""
        return self.simulation.senses.reading(name)

    def on_floor(self, body: str) -> bool:
        """Whether a thing lies on the floor, as the robot sees it."""
        return bool(self.simulation.pose(body).position[2] < _FLOOR_THING)

    def begin(
        self, target: Iterable[int] = (), *, held_meets: bool = True, avoid: Collection[str] = ()
    ) -> None:
        """Refresh the scratch world, with what the hand holds.

        avoid: things on the floor to keep off; by default those of `keep_off`.
        """
        self.scratch.begin(target=target, held=self.hand.body, contents=self.hand.contents, held_meets=held_meets)
        for body in self.things:
            # What lies on the floor is pushed aside by the base, and must not keep the robot from moving.
            if body != self.hand.body and body not in (avoid or self.keep_off) and self.on_floor(body):
                self.scratch.mark(self.simulation.geoms(body), IGNORED)
        self.scratch.fingers(self.robot.grip if self.hand.body is None else 0.5 * self.robot.opening)


def stances(
    here: Surroundings, target: Array, distances: Iterable[float], sides: Iterable[float],
    turns: Iterable[float] = (0.0,),
) -> list[Array]:
    """Base poses (3,) in front of ``target``, best first, near the robot's station."""
    first, *_ = distances = tuple(distances)
    found: list[tuple[float, tuple[float, float, float]]] = []
    for distance in distances:
        for side in sides:
            for turn in turns:
                x = float(target[0]) + side
                x = min(max(x, here.station.x - STATION_REACH), here.station.x + STATION_REACH)
                y = min(float(target[1]) - distance, FRONT_LIMIT)
                cost = abs(x - float(target[0])) + 0.5 * abs(distance - first) + 0.3 * abs(turn)
                found.append((cost, (round(x, 6), round(y, 6), 0.5 * math.pi + turn)))
    found.sort()
    return [np.array(pose) for pose in dict.fromkeys(pose for _, pose in found)]


def take(here: Surroundings, body: str, stood: Pose, contents: tuple[str, ...]) -> None:
    """Note that the hand has taken ``body``, which ``stood`` so with ``contents`` in it."""
    stood.expressed_in(here.robot.frame)
    here.hand.body, here.hand.upright, here.hand.contents = body, stood.rotation, contents
    here.hand.away = _away(here, body)
    here.simulation.hold(body)


def check_held(here: Surroundings) -> None:
    """Fail with ``slipped`` when what the hand should hold is no longer in it."""
    body = here.hand.body
    if body is None:
        return
    if here.robot.opening < EMPTY or abs(_away(here, body) - here.hand.away) > _SLIPPED:
        here.hand.body = None
        raise SkillFailure("slipped", f"the {body} slipped out of the hand")


def _away(here: Surroundings, body: str) -> float:
    return float(np.linalg.norm(here.simulation.pose(body).position - here.robot.grip_pose().position))


def lowest(here: Surroundings, body: str, rotation: Array) -> float:
    """How far the colliders of a thing reach below its origin when it is turned so (m)."""
    model = here.simulation.model
    deepest = 0.0
    for geom in here.simulation.geoms(body):
        if not (model.geom_contype[geom] or model.geom_conaffinity[geom]):
            continue
        turn = np.empty(9)
        mujoco.mju_quat2Mat(turn, model.geom_quat[geom])
        down = (rotation @ turn.reshape(3, 3))[2]
        size, kind = model.geom_size[geom], model.geom_type[geom]
        if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
            reach = abs(down[2]) * size[1] + size[0]
        elif kind == mujoco.mjtGeom.mjGEOM_ELLIPSOID:
            reach = float(np.linalg.norm(down * size))
        elif kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
            reach = abs(down[2]) * size[1] + math.hypot(down[0], down[1]) * size[0]
        elif kind == mujoco.mjtGeom.mjGEOM_SPHERE:
            reach = size[0]
        else:
            reach = float(np.abs(down) @ size)
        deepest = max(deepest, reach - float((rotation @ model.geom_pos[geom])[2]))
    return deepest


def require_open(here: Surroundings, name: str) -> None:
    """Fail with door_closed when the fixture has a door that is not open."""
    reading = here.reading(name)
    if reading.door not in (None, "open"):
        raise SkillFailure("door_closed", f"the {name} door stands at {shown(reading.door_angles)}")


def shown(angles: Iterable[float]) -> str:
    """Angles (rad) of a door's leaves, in words."""
    return " and ".join(f"{angle:.2f}" for angle in angles) + " rad"


def tuck(here: Surroundings) -> Steps:
    """Fold the arm where the robot stands, else after backing off. Fails with ``blocked``."""
    planner, robot = here.planner, here.robot
    if np.abs(robot.q[4:] - robot.body.folded).max() < 0.02 and abs(robot.q[3] - robot.body.lift_tucked) < 0.01:
        return
    met: Free | Hit = FREE
    for back in (0.0, 0.15, 0.3, 0.45):
        start = robot.q.copy()
        stand = start.copy()
        stand[:2] -= back * here.robot.heading[:2]
        if stand[1] < here.station.y - 0.05 and back:
            break
        met = planner.edge(start, stand) if back else FREE
        if not met:
            continue
        way = planner.path(stand, robot.body.tuck(*stand[:3]), tree=back == 0.3)
        if not isinstance(way, Hit):
            yield from go_carefully(here, ([stand] if back else []) + way, 1.0 if here.hand.body is None else _LADEN)
            return
        met = way
    for up in _ways_up(here):
        folded = planner.path(up[-1], robot.body.tuck(*up[-1][:3])) if here.scratch.free(up[-1]) else None
        if folded:
            yield from here.mover.play(up)
            yield from go_carefully(here, folded, 1.0 if here.hand.body is None else _LADEN)
            return
    raise SkillFailure("blocked", f"no way to fold the arm: {met}")


def _ways_up(here: Surroundings) -> Iterator[Path]:
    """Up a little, straight or slanting, with hardly any room around the arm; at last whatever is in the way.

    A wrist low in a basin is too near its rim for any planned way.
    """
    q, hand = here.robot.q, here.planner.hand(here.robot.q)
    with here.scratch.clearance(_HARDLY, arm=True):
        clear = [
            here.planner.line(q, hand.shifted([x, y, rise]), speed=0.2) for (x, y), rise in product(_SLANTS, _RISES)
        ]
    yield from (up for up in clear if up)
    for rise in _RISES:
        up = here.planner.line(q, hand.shifted([0.0, 0.0, rise]), speed=0.2, check=False)
        if up:
            yield up


def go_carefully(here: Surroundings, way: Path, speed: float = 1.0) -> Steps:
    """Through way points, at half the speed where the arm keeps less room than usual: it lags its command."""
    with here.scratch.clearance(TRANSIT_MARGIN):
        roomy = all(here.planner.edge(start, end, _LOOKS) for start, end in pairwise([here.robot.q, *way]))
    yield from here.mover.go(way, speed if roomy else _TIGHT * speed)


def drive_to(here: Surroundings, base: Array) -> Steps:
    """Move the base within the station, the arm as it is. Fails with ``blocked``."""
    way = here.planner.drive(here.robot.q, base, here.station.y)
    if not way:
        raise SkillFailure("blocked", f"no way to drive: {way}")
    yield from here.mover.go(way)


def go_home(here: Surroundings) -> Steps:
    """Back to the station's home pose: arm folded, or as it is when the hand carries something level."""
    here.begin()
    held = here.hand.body
    if not here.scratch.free(here.robot.q):
        here.begin(held_meets=False)
    if held is None or not here.things[held].vessel:
        yield from tuck(here)
    if np.abs(here.robot.q[:3] - here.home).max() > 1e-6:
        yield from drive_to(here, here.home)
