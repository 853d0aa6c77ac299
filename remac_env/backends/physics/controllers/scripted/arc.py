"""Along the arc of one door panel: whether a hand can go with it all the way, and going with it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from remac_env.backends.physics.controllers.scripted.grasps import Grasp
from remac_env.backends.physics.controllers.scripted.panel import DoorPanel
from remac_env.backends.physics.controllers.scripted.reach import BACK
from remac_env.backends.physics.controllers.scripted.skill import Steps
from remac_env.backends.physics.controllers.scripted.verdicts import FREE, Free, Hit, NoWay
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.backends.physics.simulation import CONTROL_PERIOD
from remac_env.robots.rotation import Array, about_z

NARROW_GRIP = 0.024
"""m of finger travel with which the inner finger fits between bar and panel."""

_PLANNED = 0.05  # rad beyond, in planning
_BEYOND = 0.06  # rad by which the command may go beyond
# rad/s; slower where a panel is nearly shut: a hand that still leads presses bar and panel on the fingers, which then
# do not open.
_SPEED, _SHUTTING, _LANDING = 0.7, 0.35, 0.15
_STARTING = 12  # control periods in which the hand comes up to speed
_LAST = 0.12  # rad before it is shut over which a panel lands
_LEAD = 0.22  # rad by which the command may run ahead of the door
_STALLED = 25  # control periods without progress
# Share of what forces hold the hand off the arc by which, each period, the command yields to them across the bar's way.
_YIELD, _YIELD_MOST = 0.3, 0.03  # the latter in m
_SQUEEZE = 20.0  # N with which each finger holds the bar; a door needs 3 N
_BAR_GRIP = 0.010  # m of finger travel around the bar


@dataclass(frozen=True, eq=False, kw_only=True)
class DoorGrasp(Grasp):
    """A hand at a panel, with the share of the door's turn that it follows.

    higher: by how much (m) it is above the bar's middle; beside: where it is from there (3,), in the panel's frame, m.
    pushes: whether it pushes the panel with closed fingers, instead of holding the bar.
    """

    follows: float
    weights: Array
    higher: float
    beside: Array = field(default_factory=lambda: np.zeros(3))
    pushes: bool = False

    def at(self, door: DoorPanel, angle: float) -> Array:
        """Where the hand is (3,) when the panel stands at an angle."""
        at = door.at(angle, self.higher)
        return at + door.turn(angle) @ self.beside if self.pushes else at


def arc_is_free(
    here: Workspace, door: DoorPanel, q: Array, grasp: DoorGrasp, start: float, target: float
) -> Free | Hit | NoWay:
    """Whether the whole swing, the release and the way home are free, the panel moving along."""
    planner, checker = here.clear.planner, here.clear.checker
    beyond = target if grasp.pushes else target + math.copysign(_PLANNED, target - start)
    count = max(1, int(abs(beyond - start) / 0.06))
    angle = start
    checker.fingers(0.0 if grasp.pushes else _BAR_GRIP)
    for k in range(1, count + 1):
        angle = start + (beyond - start) * k / count
        at = about_z(-door.sign * grasp.follows * (angle - start)) @ grasp.rotation
        step = planner.kinematics.track(
            q, grasp.at(door, angle), at, weights=grasp.weights, iterations=6, largest=1.7 * planner.step
        )
        q = step.q
        panel = {door.address: max(angle, 0.0)}
        off = step.position_error > 0.008 or step.rotation_error > 0.12
        free = NoWay("the arm cannot follow") if off else checker.free(q, panel)
        if not free:
            return NoWay(f"arc at {angle:.2f} rad: {free}")
    checker.fingers(0.0 if grasp.pushes else NARROW_GRIP)
    away = planner.line(q, planner.hand(q).back(BACK), weights=grasp.weights)
    if isinstance(away, Hit | NoWay):
        return away
    back = away[-1].copy()
    heading = np.array([math.cos(back[2]), math.sin(back[2])])
    back[:2] -= min(0.3, max(0.0, back[1] - here.station.y)) * heading
    home = planner.edge(away[-1], back) and planner.path(back, planner.body.tuck(*back[:3]))
    return FREE if home else NoWay("no way on")


def follow_arc(here: Workspace, door: DoorPanel, grasp: DoorGrasp, start: float, target: float) -> Steps:
    """Lead the bar along its arc until the door is there or stops moving."""
    sensed, planner, robot = here.sensed, here.clear.planner, here.robot
    sign = math.copysign(1.0, target - start)
    angle, last, stalled, shift = start, start, 0, np.zeros(3)
    for period in range(1, 301):
        now = sensed.joint(door.joint)
        limit = min(sign * now + _LEAD, sign * target + _BEYOND)
        speed = min(1.0, period / _STARTING) * (_pace(sign * angle) if sign < 0.0 else _SPEED)
        angle = sign * min(sign * angle + speed * CONTROL_PERIOD, limit)
        at = about_z(-door.sign * grasp.follows * (angle - start)) @ grasp.rotation
        robot.grip = 0.0 if grasp.pushes else here.mover.squeezed(_SQUEEZE)
        bar = grasp.at(door, angle) + shift
        step = planner.kinematics.track(robot.q, bar, at, weights=grasp.weights, largest=planner.step)
        yield from here.mover.step(step.q)
        if not grasp.pushes:
            shift = _yielding(shift + _YIELD * here.mover.deflection(), door.outward(now))
        reached = sign * now >= sign * target - (0.005 if sign < 0 else 0.0)
        if reached:
            break
        if sign * now > sign * last + 0.004:
            last, stalled = now, 0
        else:
            stalled += 1
        if stalled > _STALLED:
            break
    robot.q = robot.measured  # no longer pressing on, so that the fingers let go easily


def _pace(angle: float) -> float:
    """How fast (rad/s) a panel is shut that stands at ``-angle``."""
    return _SPEED if angle < -_LEAD else _SHUTTING if angle < -_LAST else _LANDING


def _yielding(shift: Array, outward: Array) -> Array:
    """The parts of a shift (3,) along the panel and upwards: along its way the hand has to pull."""
    along = float(np.clip(shift @ outward, -_YIELD_MOST, _YIELD_MOST))
    return along * outward + [0.0, 0.0, float(np.clip(shift[2], -_YIELD_MOST, _YIELD_MOST))]
