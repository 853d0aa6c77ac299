"""Open and close drawers and flaps: the hand holds the level handle and goes with it, arm and base together."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np

from remac_env.backends.physics.controllers.scripted.collision import OTHER, TARGET
from remac_env.backends.physics.controllers.scripted.grasps import Grasp
from remac_env.backends.physics.controllers.scripted.reach import BACK, go_to_grasp, let_go, plan_reach
from remac_env.backends.physics.controllers.scripted.room import seen_on_slots
from remac_env.backends.physics.controllers.scripted.skill import SkillFailure, Steps, stances, tuck
from remac_env.backends.physics.controllers.scripted.verdicts import FREE, Free, Hit, NoWay
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.backends.physics.simulation import CONTROL_PERIOD
from remac_env.kitchen.fixtures.door import OPEN_TO
from remac_env.kitchen.fixtures.level import Level
from remac_env.kitchen.frame import Frame
from remac_env.robots.rotation import Array, about_x, about_z, grip_frame

_SPEED, _STARTING = 0.20, 8  # m/s of the handle; control periods in which the hand comes up to speed
_LEAD, _BEYOND = 0.05, 0.01  # m by which the command may run ahead of the handle, and beyond its end
_NEAR = 0.004  # m from its end at which it is there
_STALLED = 25  # control periods without progress
_SQUEEZE = 20.0  # N with which each finger holds the bar
_MISSED = 0.004  # m of finger travel with nothing between the fingers
_INTO = 0.004  # m that the grip site is beyond the bar's middle
_DISTANCES, _SIDES = (0.62, 0.7, 0.55, 0.78), (0.0, 0.12, -0.12, 0.24, -0.24)
_PITCHES = (-0.3, 0.0, -0.6, -0.9)
_TURNING_PITCHES, _TURNING_FOLLOWS = (0.0, -0.3, 0.3, 0.6, -0.6), (0.3, 0.0, 0.6)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Hold(Grasp):
    """A hand around the bar, with the share of the door's turn that it follows; the round bar turns in the fingers."""

    follows: float


@dataclass(frozen=True)
class _Way:
    """A drawer or flap on its way: the handle's middle closed, and from where to where its joint goes, m or rad.

    seen: (3, 3), how the wall seems to be turned. inside: of what lies in it, addresses and how these positions change
    with each m.
    """

    door: Level
    address: int
    frame: Frame
    bar: Array
    seen: Array
    start: float
    end: float
    geoms: tuple[int, ...]
    inside: Mapping[int, float]

    def moved(self, position: float, before: Array) -> dict[int, float]:
        """Positions by address with the drawer there, from those (nq,) with it at the start."""
        come = position - self.start
        return {self.address: position, **{a: float(before[a]) + part * come for a, part in self.inside.items()}}

    def at(self, position: float) -> Array:
        """Where the handle's middle is."""
        return self.bar + self.seen @ np.array(self.door.way(position))

    def hand(self, hold: _Hold, position: float) -> tuple[Array, Array]:
        """Position (3,) and rotation (3, 3) of the hand when the joint is there."""
        turn = hold.follows * (self.door.turn(position) - self.door.turn(self.start))
        turned = self.seen @ about_x(turn) @ self.seen.T @ hold.rotation if turn else hold.rotation
        return self.at(position) + turned[:, 2] * _INTO, turned


def pull(here: Workspace, door: Level, opened: float) -> Steps:
    """Move a drawer or flap to where it is open by so much, let go and back off."""
    sensed, robot, checker = here.sensed, here.robot, here.clear.checker
    model = sensed.model
    bar = sensed.located(door.joint, np.array(model.body(door.joint).pos) + np.array(model.site(door.grip).pos))
    way = _Way(
        door, int(model.joint(door.joint).qposadr[0]), robot.frame, bar, about_z(sensed.turned(door.joint)),
        sensed.joint(door.joint), door.position(opened), tuple(sensed.geoms(door.joint)),
        dict(_inside(here, door.name)),
    )  # fmt: skip
    opening = min(robot.body.finger_travel, door.room)
    here.begin()
    yield from tuck(here)
    here.begin(way.geoms[1:4])
    robot.grip = opening
    checker.fingers(robot.grip)
    before = checker.data.qpos.copy()

    def after(goal: Array, grasp: Grasp) -> Free | Hit | NoWay:
        if not isinstance(grasp, _Hold):
            return NoWay("no hand at a handle")
        checker.mark(way.geoms, TARGET)
        free = _way_is_free(here, way, goal, grasp, before)
        checker.mark(way.geoms[:1] + way.geoms[4:], OTHER)
        checker.data.qpos[[way.address, *way.inside]] = before[[way.address, *way.inside]]
        checker.fingers(robot.grip)
        return free

    found = plan_reach(here, stances(here, way.at(way.start), _DISTANCES, _SIDES), _grasps(way), after)
    yield from go_to_grasp(here, found)
    yield from here.mover.fingers(0.0, 10)
    if robot.opening < _MISSED:
        yield from here.mover.fingers(here.robot.body.finger_travel, 6)
        raise SkillFailure("slipped", f"the hand missed the handle of {door.joint}")
    if isinstance(found.grasp, _Hold):
        yield from _follow(here, way, found.grasp)
    yield from let_go(here, way.geoms, opening)
    yield from tuck(here)


def _inside(here: Workspace, name: str) -> Iterator[tuple[int, float]]:
    """Addresses of the positions of what is seen in a drawer, which comes along, with how each changes."""
    fixture = here.kitchen.fixture(name)
    if not any(fixture.shift(OPEN_TO)):
        return
    out, seen = here.kitchen.layout.frame(name).rotation @ np.array([0.0, -1.0, 0.0]), seen_on_slots(here)
    for body in (body for slot in fixture.slots for body in seen.get(slot.name, ())):
        first = int(here.sensed.model.joint(body).qposadr[0])
        yield from ((first + axis, float(out[axis])) for axis in range(3))


def _grasps(way: _Way) -> list[_Hold]:
    """Hands around a level bar: fingers above and below it, level or pitched; of a flap they go along with its turn."""
    found, at = [], way.at(way.start)
    turns = way.door.turn(way.end) != way.door.turn(way.start)
    choices = product(_TURNING_FOLLOWS, _TURNING_PITCHES) if turns else product((0.0,), _PITCHES)
    for follows, pitch in choices:
        pitch += follows * way.door.turn(way.start)
        for side in (1.0, -1.0):
            up = [0.0, -side * math.sin(pitch), side * math.cos(pitch)]
            hand = way.seen @ grip_frame([0.0, math.cos(pitch), math.sin(pitch)], up)
            before = at - hand[:, 2] * 0.12
            found.append(_Hold(at + hand[:, 2] * _INTO, hand, way.frame, before=before, follows=follows))
    return found


def _way_is_free(here: Workspace, way: _Way, q: Array, hold: _Hold, before: Array) -> Free | Hit | NoWay:
    """Whether the whole way, letting go and folding the arm are free, the drawer moving along."""
    planner, checker = here.clear.planner, here.clear.checker
    count = max(2, math.ceil(abs(way.end - way.start) * way.door.arm / 0.02))
    for k in range(1, count + 1):
        position = way.start + (way.end - way.start) * k / count
        step = planner.kinematics.track(
            q, *way.hand(hold, position), weights=planner.body.door_weights, iterations=6, largest=1.7 * planner.step
        )
        q = step.q
        off = step.position_error > 0.008 or step.rotation_error > 0.12
        free = NoWay("the arm cannot follow") if off else checker.free(q, way.moved(position, before))
        if not free:
            return NoWay(f"way at {position:.2f}: {free}")
    away = planner.line(q, planner.hand(q).back(BACK), weights=planner.body.door_weights)
    if isinstance(away, Hit | NoWay):
        return away
    return FREE if planner.path(away[-1], planner.body.tuck(*away[-1][:3])) else NoWay("no way on")


def _follow(here: Workspace, way: _Way, hold: _Hold) -> Steps:
    """Lead the bar until the drawer or flap is there or stops moving."""
    sensed, planner, robot, arm = here.sensed, here.clear.planner, here.robot, way.door.arm
    sign = math.copysign(1.0, way.end - way.start)
    led = last = way.start
    stalled = 0
    for period in range(1, 161):
        now = sensed.joint(way.door.joint)
        limit = min(sign * now + _LEAD / arm, sign * way.end + _BEYOND / arm)
        led = sign * min(sign * led + min(1.0, period / _STARTING) * _SPEED / arm * CONTROL_PERIOD, limit)
        robot.grip = here.mover.squeezed(_SQUEEZE)
        weights = planner.body.door_weights
        step = planner.kinematics.track(robot.q, *way.hand(hold, led), weights=weights, largest=planner.step)
        yield from here.mover.step(step.q)
        if sign * now >= sign * way.end - _NEAR / arm:
            break
        moved = sign * now > sign * last + 0.001 / arm
        last, stalled = (now, 0) if moved else (last, stalled + 1)
        if stalled > _STALLED:
            break
    robot.q = robot.measured  # no longer pulling, so that the fingers let go easily
