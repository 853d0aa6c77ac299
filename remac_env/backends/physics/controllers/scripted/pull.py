"""Open and close what slides: the hand holds the level handle and goes straight with it, arm and base together."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from remac_env.backends.physics.controllers.scripted.collision import OTHER, TARGET
from remac_env.backends.physics.controllers.scripted.grasps import Grasp
from remac_env.backends.physics.controllers.scripted.paths import STEP_LIMIT
from remac_env.backends.physics.controllers.scripted.reach import BACK, go_to_grasp, let_go, plan_reach
from remac_env.backends.physics.controllers.scripted.room import seen_on_slots
from remac_env.backends.physics.controllers.scripted.skill import SkillFailure, Steps, Surroundings, stances, tuck
from remac_env.backends.physics.simulation import CONTROL_PERIOD
from remac_env.kitchen.fixtures.slide import Slide
from remac_env.robots import panda
from remac_env.robots.ik import DOOR_WEIGHTS
from remac_env.robots.rotation import Array, about_z, grip_frame

_SPEED, _STARTING = 0.20, 8  # m/s; control periods in which the hand comes up to speed
_LEAD, _BEYOND = 0.05, 0.01  # m by which the command may run ahead of the drawer, and beyond its end
_NEAR = 0.004  # m from its end at which it is there
_STALLED = 25  # control periods without progress
_SQUEEZE = 20.0  # N with which each finger holds the bar
_MISSED = 0.004  # m of finger travel with nothing between the fingers
_DISTANCES, _SIDES = (0.62, 0.7, 0.55, 0.78), (0.0, 0.12, -0.12, 0.24, -0.24)


@dataclass(frozen=True)
class _Way:
    """A drawer on its way: its joint and address, the handle's middle closed, its way out; from where to where, m."""

    joint: str
    address: int
    bar: Array
    out: Array
    start: float
    end: float
    geoms: tuple[int, ...]
    inside: Mapping[int, float]  # of what lies in it: addresses and how these positions change with each m

    def moved(self, position: float, before: Array) -> dict[int, float]:
        """Positions by address with the drawer there, from those (nq,) with it at the start."""
        come = position - self.start
        return {self.address: position, **{a: float(before[a]) + part * come for a, part in self.inside.items()}}

    def at(self, position: float) -> Array:
        """Where the handle's middle is."""
        return self.bar + position * self.out


def pull(here: Surroundings, slide: Slide, opened: float) -> Steps:
    """Move a drawer to where it is open by so much, let go and back off."""
    simulation, robot, scratch = here.simulation, here.robot, here.scratch
    model = simulation.model
    bar = simulation.located(slide.joint, np.array(model.body(slide.joint).pos) + np.array(model.site(slide.grip).pos))
    seen = about_z(simulation.turned(slide.joint))
    way = _Way(
        slide.joint, int(model.joint(slide.joint).qposadr[0]), bar, seen @ np.array([0.0, -1.0, 0.0]),
        simulation.joint(slide.joint), slide.position(opened), tuple(simulation.geoms(slide.joint)),
        dict(_inside(here, slide.name)),
    )
    here.begin()
    yield from tuck(here)
    here.begin(way.geoms[1:4])
    robot.grip = panda.FINGER_OPEN
    scratch.fingers(robot.grip)
    before = scratch.data.qpos.copy()

    def after(goal: Array, grasp: Grasp) -> bool | None:
        scratch.mark(way.geoms, TARGET)
        free = _way_is_free(here, way, goal, grasp, before)
        scratch.mark(way.geoms[:1] + way.geoms[4:], OTHER)
        scratch.data.qpos[[way.address, *way.inside]] = before[[way.address, *way.inside]]
        scratch.fingers(robot.grip)
        return True if free else None

    grasps = _grasps(way.at(way.start), seen)
    found = plan_reach(here, stances(here, way.at(way.start), _DISTANCES, _SIDES), grasps, after)
    yield from go_to_grasp(here, found)
    yield from here.mover.fingers(0.0, 10)
    if robot.opening < _MISSED:
        yield from here.mover.fingers(panda.FINGER_OPEN, 6)
        raise SkillFailure("slipped", f"the hand missed the handle of {way.joint}")
    yield from _follow(here, way, found.grasp)
    yield from let_go(here, way.geoms, panda.FINGER_OPEN)
    yield from tuck(here)


def _inside(here: Surroundings, name: str) -> Iterator[tuple[int, float]]:
    """Addresses of the positions of what is seen in a drawer, which comes along, with how each changes."""
    out, seen = here.layout.frame(name).rotation @ np.array([0.0, -1.0, 0.0]), seen_on_slots(here)
    for body in (body for slot in here.fixture(name).slots for body in seen.get(slot.name, ())):
        first = int(here.simulation.model.joint(body).qposadr[0])
        yield from ((first + axis, float(out[axis])) for axis in range(3))


def _grasps(at: Array, seen: Array) -> list[Grasp]:
    """Hands around a level bar: fingers above and below it, level or pitched."""
    found = []
    for pitch in (-0.3, 0.0, -0.6, -0.9):
        for side in (1.0, -1.0):
            up = [0.0, -side * math.sin(pitch), side * math.cos(pitch)]
            hand = seen @ grip_frame([0.0, math.cos(pitch), math.sin(pitch)], up)
            found.append(Grasp(at + hand[:, 2] * 0.004, hand, at - hand[:, 2] * 0.12))
    return found


def _way_is_free(here: Surroundings, way: _Way, q: Array, grasp: Grasp, before: Array) -> bool:
    """Whether the whole way, letting go and folding the arm are free, the drawer moving along."""
    planner, scratch = here.planner, here.scratch
    count = max(2, math.ceil(abs(way.end - way.start) / 0.02))
    hold = grasp.position - way.at(way.start)
    for k in range(1, count + 1):
        position = way.start + (way.end - way.start) * k / count
        step = planner.kinematics.track(
            q, way.at(position) + hold, grasp.rotation, weights=DOOR_WEIGHTS, iterations=6, largest=1.7 * STEP_LIMIT
        )
        q = step.q
        off = step.position_error > 0.008 or step.rotation_error > 0.12
        if off or not scratch.free(q, way.moved(position, before)):
            planner.reason = "way at {:.2f} m: {} meets {}".format(position, *scratch.touching)
            return False
    at, rotation = planner.kinematics.forward(q)
    away = planner.line(q, at - rotation[:, 2] * BACK, rotation, weights=DOOR_WEIGHTS)
    return away is not None and planner.path(away[-1], panda.tucked(*away[-1][:3])) is not None


def _follow(here: Surroundings, way: _Way, grasp: Grasp) -> Steps:
    """Lead the bar straight until the drawer is there or stops moving."""
    simulation, planner, robot = here.simulation, here.planner, here.robot
    sign, hold = math.copysign(1.0, way.end - way.start), grasp.position - way.at(way.start)
    led = last = way.start
    stalled = 0
    for period in range(1, 161):
        now = simulation.joint(way.joint)
        limit = min(sign * now + _LEAD, sign * way.end + _BEYOND)
        led = sign * min(sign * led + min(1.0, period / _STARTING) * _SPEED * CONTROL_PERIOD, limit)
        robot.grip = here.mover.squeezed(_SQUEEZE)
        step = planner.kinematics.track(
            robot.q, way.at(led) + hold, grasp.rotation, weights=DOOR_WEIGHTS, largest=STEP_LIMIT
        )
        yield from here.mover.step(step.q)
        if sign * now >= sign * way.end - _NEAR:
            break
        moved = sign * now > sign * last + 0.001
        last, stalled = (now, 0) if moved else (last, stalled + 1)
        if stalled > _STALLED:
            break
    robot.q = robot.measured  # no longer pulling, so that the fingers let go easily
