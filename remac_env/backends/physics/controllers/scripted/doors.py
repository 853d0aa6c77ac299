"""Open and close a hinged door: the hand holds the handle and goes along the arc, arm and base together."""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import dataclass

import numpy as np

from remac_env.backends.physics.controllers.scripted.collision import OTHER, TARGET
from remac_env.backends.physics.controllers.scripted.grasps import Grasp
from remac_env.backends.physics.controllers.scripted.leaf import Leaf
from remac_env.backends.physics.controllers.scripted.paths import STEP_LIMIT
from remac_env.backends.physics.controllers.scripted.pull import pull
from remac_env.backends.physics.controllers.scripted.reach import BACK, go_to_grasp, let_go, plan_reach
from remac_env.backends.physics.controllers.scripted.skill import (
    SkillFailure,
    Steps,
    Surroundings,
    go_home,
    shown,
    stances,
    tuck,
)
from remac_env.backends.physics.simulation import CONTROL_PERIOD
from remac_env.kitchen.fixtures.door import OPEN_TO, Door
from remac_env.kitchen.fixtures.slide import Slide
from remac_env.robots import panda
from remac_env.robots.ik import DOOR_WEIGHTS
from remac_env.robots.rotation import Array, about_z, grip_frame

_SWUNG, _SHUT = 1.0, 0.045  # rad at which a leaf has been opened, and closed
_CLEAR, _ASIDE = 0.8, 1.0  # rad at which a leaf leaves room for the hand at its neighbour, and to which it is swung
_PLANNED = 0.05  # rad beyond, in planning
_BEYOND = 0.06  # rad by which the command may go beyond
# rad/s; slower where a leaf is nearly shut: a hand that still leads presses bar and panel on the fingers, which then
# do not open.
_SPEED, _SHUTTING, _LANDING = 0.7, 0.35, 0.15
_STARTING = 12  # control periods in which the hand comes up to speed
_LAST = 0.12  # rad before it is shut over which a leaf lands
_LEAD = 0.22  # rad by which the command may run ahead of the door
_STALLED = 25  # control periods without progress
# Share of the door's turn that the hand follows; the round bar turns in the fingers.
_OPENING_FOLLOWS, _CLOSING_FOLLOWS = (0.5, 0.8, 0.3), (0.3, 0.5, 0.15, 0.65)
# Share of what forces hold the hand off the arc by which, each period, the command yields to them across the bar's way.
_YIELD, _YIELD_MOST = 0.3, 0.03  # the latter in m
_NARROW_GRIP = 0.024  # m of finger travel with which the inner finger fits between bar and panel
_SQUEEZE = 20.0  # N with which each finger holds the bar; a door needs 3 N
_BAR_GRIP = 0.010  # m of finger travel around the bar
# How much the base helps along the arc: as ever, or hardly where another robot stands close by.
_HELP = (DOOR_WEIGHTS, DOOR_WEIGHTS * np.array([0.1, 0.1, 0.1, *[1.0] * 8]))
_DISTANCES, _SIDES, _TURNS = (0.58, 0.5, 0.66, 0.74), (-0.05, 0.1, -0.2, 0.25, 0.4), (0.0, 0.3, -0.3)


@dataclass(frozen=True)
class _DoorGrasp(Grasp):
    """A grasp of the bar, so much above its middle (m), with the share of the door's turn that the hand follows."""

    follows: float
    weights: Array
    higher: float


def open_door(here: Surroundings, name: str) -> Steps:
    """Swing every leaf of the door of fixture ``name`` open from any angle."""
    yield from _swing(here, name, OPEN_TO)


def close_door(here: Surroundings, name: str) -> Steps:
    """Swing every leaf of the door of fixture ``name`` shut from any angle."""
    yield from _swing(here, name, 0.0)


def _swing(here: Surroundings, name: str, target: float) -> Steps:
    """The leaves in turn, those nearer to the robot first; of two, one that stands there already is left alone."""
    slides = [leaf for leaf in here.fixture(name).leaves if isinstance(leaf, Slide)]
    leaves = [_door(here, leaf) for leaf in here.fixture(name).leaves if isinstance(leaf, Door)]
    here.begin()
    yield from tuck(here)
    aside, angle = float(here.robot.q[0]), here.simulation.joint
    if len(leaves) > 1:
        leaves.sort(key=lambda leaf: abs(leaf.at(0.0)[0] - aside))
        leaves = [leaf for leaf in leaves if not _there(angle(leaf.joint), target)]
    if len(leaves) > 1 and target == 0.0:
        leaves = yield from _make_room(here, leaves)
    for leaf in leaves:
        yield from _swing_leaf(here, leaf, target)
    for slide in slides:
        yield from pull(here, slide, target)
    yield from go_home(here)
    angles = here.reading(name).door_angles
    if not all(_there(value, target) for value in angles):
        raise SkillFailure("slipped", f"the {name} door stopped at {shown(angles)}")


def _make_room(here: Surroundings, leaves: list[Leaf]) -> Generator[None, None, list[Leaf]]:
    """The order in which to close leaves; beside one that is ajar there is no room for the hand, so it is opened."""
    orders = [leaves, leaves[::-1]]
    for order in orders:
        *_, last = order
        if not _SHUT < here.simulation.joint(last.joint) < _CLEAR:
            break
        try:
            yield from _swing_leaf(here, last, _ASIDE)
            break
        except SkillFailure as failed:
            if failed.reason != "blocked" or order is orders[-1]:
                raise
    return order


def _there(angle: float, target: float) -> bool:
    return angle >= _SWUNG if target > 0.0 else angle <= _SHUT


def _door(here: Surroundings, leaf: Door) -> Leaf:
    model = here.simulation.model
    joint = model.joint(leaf.joint)
    hinge = here.simulation.located(leaf.joint, np.array(model.body(leaf.joint).pos))
    bar = np.array(model.site(leaf.grip).pos)
    radius, half, _ = model.geom(leaf.grip).size
    geoms = tuple(here.simulation.geoms(leaf.joint))
    return Leaf(
        leaf.joint, hinge, bar, float(half), float(radius), -float(joint.axis[2]), int(joint.qposadr[0]), geoms,
        here.simulation.turned(leaf.joint),
    )


def _swing_leaf(here: Surroundings, door: Leaf, target: float) -> Steps:
    """Swing one leaf, let go and back off."""
    simulation, robot, scratch = here.simulation, here.robot, here.scratch
    here.begin()
    yield from tuck(here)
    start = simulation.joint(door.joint)
    bar, posts = door.geoms[1:2], door.geoms[2:]
    here.begin(bar)
    robot.grip = panda.FINGER_OPEN if target > start else _NARROW_GRIP
    scratch.fingers(robot.grip)
    grasps = _grasps(door, start, closing=target < start)

    def after(goal: Array, grasp: Grasp) -> bool | None:
        if not isinstance(grasp, _DoorGrasp):
            return None
        scratch.mark(posts, TARGET)  # which the bar may turn against the fingers, once they hold it
        free = _arc_is_free(here, door, goal, grasp, start, target)
        scratch.mark(posts, OTHER)
        scratch.data.qpos[door.address] = start
        scratch.fingers(robot.grip)
        return True if free else None

    sides, turns = ([door.sign * value for value in values] for values in (_SIDES, _TURNS))
    found = plan_reach(here, stances(here, door.at(start), _DISTANCES, sides, turns), grasps, after)
    yield from go_to_grasp(here, found)
    yield from here.mover.fingers(0.0, 10)
    if robot.opening < 0.008:
        yield from here.mover.fingers(panda.FINGER_OPEN, 6)
        raise SkillFailure("slipped", f"the hand missed the handle of {door.joint}")
    if isinstance(found.grasp, _DoorGrasp):
        yield from _follow_arc(here, door, found.grasp, start, target)
    yield from _back_off(here, door)


def _back_off(here: Surroundings, door: Leaf) -> Steps:
    """Let go of the handle, straight back from it, away from the fronts, and fold the arm."""
    robot, planner = here.robot, here.planner
    yield from let_go(here, door.geoms, _NARROW_GRIP)
    back = robot.q.copy()
    back[:2] -= min(0.3, max(0.0, back[1] - here.station.y)) * robot.heading[:2]
    if planner.edge(robot.q, back):
        yield from here.mover.go([back])
    here.begin()
    try:
        yield from tuck(here)
    except SkillFailure:
        # Beside a wall there may be no room to fold the arm; there is at the station, to which it goes as it is.
        home = np.concatenate([here.home, robot.q[3:]])
        if not planner.edge(robot.q, home):
            raise
        yield from here.mover.go([home])
        yield from tuck(here)


def _grasps(door: Leaf, angle: float, *, closing: bool) -> list[_DoorGrasp]:
    """Hands on the bar: level or pitched down, either way round.

    To open, the hand starts square to the panel. To close, it starts turned from the wall by its share of the door's
    angle, so that it ends square: the mirror of opening, and the robot stays in front of the fixture.
    """
    pitches = (0.0, -0.4, -0.8) if door.bar[2] > 1.25 else (-0.8, -0.5, 0.0)
    found: list[_DoorGrasp] = []
    for pitch in pitches:
        higher = door.clear_of_palm(pitch)
        at = door.at(angle, higher)
        for follows in _CLOSING_FOLLOWS if closing else _OPENING_FOLLOWS:
            turn = door.turn(follows * angle if closing else angle)
            for side in (1.0, -1.0):
                approach = turn @ np.array([0.0, math.cos(pitch), math.sin(pitch)])
                hand = grip_frame(approach, turn @ np.array([side, 0.0, 0.0]))
                for help_ in _HELP:
                    before = at - hand[:, 2] * 0.12
                    found.append(_DoorGrasp(at + hand[:, 2] * 0.004, hand, before, follows, help_, higher))
    return sorted(found, key=lambda grasp: grasp.weights is not _HELP[0])


def _arc_is_free(
    here: Surroundings, door: Leaf, q: Array, grasp: _DoorGrasp, start: float, target: float
) -> bool:
    """Whether the whole swing, the release and the way home are free, the panel moving along."""
    planner, scratch = here.planner, here.scratch
    beyond = target + math.copysign(_PLANNED, target - start)
    count = max(1, int(abs(beyond - start) / 0.06))
    angle = start
    scratch.fingers(_BAR_GRIP)
    for k in range(1, count + 1):
        angle = start + (beyond - start) * k / count
        at = about_z(-door.sign * grasp.follows * (angle - start)) @ grasp.rotation
        step = planner.kinematics.track(
            q, door.at(angle, grasp.higher), at, weights=grasp.weights, iterations=6, largest=1.7 * STEP_LIMIT
        )
        q = step.q
        panel = {door.address: max(angle, 0.0)}
        if step.position_error > 0.008 or step.rotation_error > 0.12 or not scratch.free(q, panel):
            planner.reason = "arc at {:.2f} rad: {} meets {}".format(angle, *scratch.touching)
            return False
    position, turned = planner.kinematics.forward(q)
    scratch.fingers(_NARROW_GRIP)
    away = planner.line(q, position - turned[:, 2] * BACK, turned, weights=grasp.weights)
    if away is None:
        return False
    back = away[-1].copy()
    heading = np.array([math.cos(back[2]), math.sin(back[2])])
    back[:2] -= min(0.3, max(0.0, back[1] - here.station.y)) * heading
    return planner.edge(away[-1], back) and planner.path(back, panda.tucked(*back[:3])) is not None


def _follow_arc(here: Surroundings, door: Leaf, grasp: _DoorGrasp, start: float, target: float) -> Steps:
    """Lead the bar along its arc until the door is there or stops moving."""
    simulation, planner, robot = here.simulation, here.planner, here.robot
    sign = math.copysign(1.0, target - start)
    angle, last, stalled, shift = start, start, 0, np.zeros(3)
    for period in range(1, 301):
        now = simulation.joint(door.joint)
        limit = min(sign * now + _LEAD, sign * target + _BEYOND)
        speed = min(1.0, period / _STARTING) * (_pace(sign * angle) if sign < 0.0 else _SPEED)
        angle = sign * min(sign * angle + speed * CONTROL_PERIOD, limit)
        at = about_z(-door.sign * grasp.follows * (angle - start)) @ grasp.rotation
        robot.grip = here.mover.squeezed(_SQUEEZE)
        bar = door.at(angle, grasp.higher) + shift
        step = planner.kinematics.track(robot.q, bar, at, weights=grasp.weights, largest=STEP_LIMIT)
        yield from here.mover.step(step.q)
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
    """How fast (rad/s) a leaf is shut that stands at ``-angle``."""
    return _SPEED if angle < -_LEAD else _SHUTTING if angle < -_LAST else _LANDING


def _yielding(shift: Array, outward: Array) -> Array:
    """The parts of a shift (3,) along the leaf and upwards: along its way the hand has to pull."""
    along = float(np.clip(shift @ outward, -_YIELD_MOST, _YIELD_MOST))
    return along * outward + [0.0, 0.0, float(np.clip(shift[2], -_YIELD_MOST, _YIELD_MOST))]
