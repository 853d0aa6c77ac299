"""What all skills share: their workspace, how they fail, and how they come home."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import pairwise, product

import mujoco
import numpy as np

from remac_env.backends.physics.controllers.scripted.collision import TRANSIT_MARGIN
from remac_env.backends.physics.controllers.scripted.motion import Steps
from remac_env.backends.physics.controllers.scripted.paths import Path
from remac_env.backends.physics.controllers.scripted.verdicts import FREE, Free, Hit
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.backends.physics.pose import Pose
from remac_env.robots.rotation import Array
from remac_env.rules.outcomes import Reason

STATION_REACH = 0.34  # m, how far aside of its station a robot may stand within a skill
FRONT_LIMIT = -0.20  # y of the arm axis nearest to the counters (their fronts are at 0, the base reaches 0.15 ahead)
EMPTY = 0.002  # m between fingers that hold nothing; the thinnest wall that they hold is 5 mm
_SLIPPED = 0.06  # m by which an object may move in the hand and still be held
_TIGHT, _LOOKS = 0.5, 0.12  # share of its speed with which an arm goes that has little room; rad between looks for that
_RISES = (0.08, 0.16, 0.24)  # m by which a hand is raised that cannot be folded where it is
_SLANTS = ((0.0, 0.0), (0.0, -0.1), (0.1, -0.05), (-0.1, -0.05))  # m by which it may go aside and back on the way
_HARDLY = 0.001  # m around the arm meanwhile

LADEN = 0.6
"""Share of the usual speeds at which a full hand is drawn in."""


class SkillFailure(Exception):
    """A skill gave up. ``reason`` is one of the closed list in :mod:`remac_env.rules.outcomes`."""

    def __init__(self, reason: Reason, detail: str = "") -> None:
        super().__init__(f"{reason}: {detail}")
        self.reason, self.detail = reason, detail


def stances(
    here: Workspace, target: Array, distances: Iterable[float], sides: Iterable[float],
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


def take(here: Workspace, body: str, stood: Pose, contents: tuple[str, ...]) -> None:
    """Note that the hand has taken ``body``, which ``stood`` so with ``contents`` in it."""
    stood.expressed_in(here.robot.frame)
    here.hand.body, here.hand.upright, here.hand.contents = body, stood.rotation, contents
    here.hand.away = _away(here, body)
    here.sensed.hold(body)


def hold(here: Workspace, body: str | None) -> None:
    """Note what the hand holds by now; what it had believed lost lies in it as it does now."""
    if body is not None and here.hand.body != body:
        here.hand.away = _away(here, body)
    here.hand.body = body


def check_held(here: Workspace) -> None:
    """Fail with ``slipped`` when what the hand should hold is no longer in it."""
    body = here.hand.body
    if body is None:
        return
    if here.robot.opening < EMPTY or abs(_away(here, body) - here.hand.away) > _SLIPPED:
        here.hand.body = None
        raise SkillFailure("slipped", f"the {body} slipped out of the hand")


def _away(here: Workspace, body: str) -> float:
    return float(np.linalg.norm(here.sensed.pose(body).position - here.robot.grip_pose().position))


def lowest(here: Workspace, body: str, rotation: Array) -> float:
    """How far the colliders of an object reach below its origin when it is turned so (m)."""
    model = here.sensed.model
    deepest = 0.0
    for geom in here.sensed.geoms(body):
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


def require_open(here: Workspace, name: str) -> None:
    """Fail with door_closed when the fixture has a door that is not open."""
    reading = here.sensed.reading(name)
    if reading.door not in (None, "open"):
        raise SkillFailure("door_closed", f"the {name} door stands at {shown(reading.door_angles)}")


def shown(angles: Iterable[float]) -> str:
    """Angles (rad) of a door's panels, in words."""
    return " and ".join(f"{angle:.2f}" for angle in angles) + " rad"


def tuck(here: Workspace, laden: float = LADEN) -> Steps:
    """Fold the arm where the robot stands, else after backing off. Fails with ``blocked``.

    ``laden``: the share of the usual speeds with which it goes where it holds something.
    """
    planner, robot = here.clear.planner, here.robot
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
            yield from go_carefully(here, ([stand] if back else []) + way, 1.0 if here.hand.body is None else laden)
            return
        met = way
    for up in _ways_up(here):
        folded = planner.path(up[-1], robot.body.tuck(*up[-1][:3])) if here.clear.checker.free(up[-1]) else None
        if folded:
            yield from here.mover.play(up)
            yield from go_carefully(here, folded, 1.0 if here.hand.body is None else laden)
            return
    raise SkillFailure("blocked", f"no way to fold the arm: {met}")


def _ways_up(here: Workspace) -> Iterator[Path]:
    """Up a little, straight or slanting, with hardly any room around the arm; at last whatever is in the way.

    A wrist low in a basin is too near its rim for any planned way.
    """
    q, hand = here.robot.q, here.clear.planner.hand(here.robot.q)
    with here.clear.checker.clearance(_HARDLY, arm=True):
        shifts = [[x, y, rise] for (x, y), rise in product(_SLANTS, _RISES)]
        clear = [here.clear.planner.line(q, hand.shifted(shift), speed=0.2) for shift in shifts]
    yield from (up for up in clear if up)
    for rise in _RISES:
        up = here.clear.planner.line(q, hand.shifted([0.0, 0.0, rise]), speed=0.2, check=False)
        if up:
            yield up


def go_carefully(here: Workspace, way: Path, speed: float = 1.0) -> Steps:
    """Through way points, at half the speed where the arm keeps less room than usual: it lags its command."""
    with here.clear.checker.clearance(TRANSIT_MARGIN):
        roomy = all(here.clear.planner.edge(start, end, _LOOKS) for start, end in pairwise([here.robot.q, *way]))
    yield from here.mover.go(way, speed if roomy else _TIGHT * speed)


def drive_to(here: Workspace, base: Array) -> Steps:
    """Move the base within the station, the arm as it is. Fails with ``blocked``."""
    way = here.clear.planner.drive(here.robot.q, base, here.station.y)
    if not way:
        raise SkillFailure("blocked", f"no way to drive: {way}")
    yield from here.mover.go(way)


def go_home(here: Workspace, *, laden: float = LADEN) -> Steps:
    """Back to the station's home pose: arm folded (`tuck`), or as it is when the hand carries something level."""
    here.begin()
    held = here.hand.body
    if not here.clear.checker.free(here.robot.q):
        here.begin(held_meets=False)
    if held is None or not here.kitchen.objects[held].vessel:
        yield from tuck(here, laden)
    if np.abs(here.robot.q[:3] - here.home).max() > 1e-6:
        yield from drive_to(here, here.home)
