"""Turn switches on and off: knobs, levers and push buttons."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from remac_env.backends.physics.controllers.scripted.grasps import MEASURED, Grasp
from remac_env.backends.physics.controllers.scripted.paths import Path
from remac_env.backends.physics.controllers.scripted.reach import go_to_grasp, plan_reach
from remac_env.backends.physics.controllers.scripted.skill import SkillFailure, Steps, go_home, stances, tuck
from remac_env.backends.physics.controllers.scripted.verdicts import FREE, Free, Hit, NoWay
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.backends.physics.simulation import CONTROL_PERIOD
from remac_env.kitchen.fixtures.actuator import Actuator
from remac_env.robots.rotation import Array, about_x, about_y, about_z, grip_frame

_BEFORE = 0.021  # m from a button's face to the grip site of a hand with measured fingertips, which end 17 mm beyond it


def work(here: Workspace, actuator: Actuator, *, on: bool) -> Steps:
    """Turn a knob or lever on or off, or push a button."""
    if actuator.motion == "knob":
        yield from _turn_knob(here, actuator, on=on)
    elif actuator.motion == "lever":
        yield from _swing_lever(here, actuator, on=on)
    else:
        yield from _push_button(here, actuator)


@dataclass(frozen=True)
class _Turn:
    """A hinge and how the hand goes with it: positions and turns of the hand by hinge angle."""

    joint: str
    body: str
    at: Callable[[float], Array]
    turn: Callable[[float], Array]
    target: float
    beyond: float  # rad commanded past the target
    rate: float  # rad/s
    opening: float
    closing: float


def _turn_knob(here: Workspace, actuator: Actuator, *, on: bool) -> Steps:
    """Turn a knob about its own axis."""
    model, joint = here.sensed.model, actuator.joint
    at = here.sensed.located(joint, np.array(model.body(joint).pos) + np.array(model.site(actuator.site).pos))
    start, above = here.sensed.joint(joint), abs(float(model.joint(joint).axis[2])) > 0.5
    seen = about_z(here.sensed.turned(joint))

    def turn_by(angle: float) -> Array:
        """Rotation of the knob: clockwise as seen from the robot, or from above."""
        return about_z(-angle) if above else seen @ about_y(angle) @ seen.T

    grasps = []
    for pitch in (0.0, 0.3, -0.3):
        for side in (1.0, -1.0):
            approach = [0.0, math.sin(pitch), -math.cos(pitch)] if above else [0.0, math.cos(pitch), -math.sin(pitch)]
            hand = grip_frame(seen @ approach, turn_by(start) @ seen @ [side, 0.0, 0.0])
            grasps.append(Grasp(at, hand, here.robot.frame, before=at - hand[:, 2] * 0.12))
    target, beyond = (actuator.worked, 0.15) if on else (0.0, -0.10)
    turn = _Turn(joint, joint, lambda _: at, turn_by, target, beyond, 1.2, 0.035, 0.0)
    stands = stances(here, at, (0.66, 0.74, 0.58, 0.82), (0.0, 0.12, -0.12, 0.25, -0.25))
    yield from _turn_hinge(here, turn, grasps, stands)


def _swing_lever(here: Workspace, actuator: Actuator, *, on: bool) -> Steps:
    """Lift or lower a lever, pinched from above and below: the hand is wide along its fingers."""
    model, joint = here.sensed.model, actuator.joint
    hinge = here.sensed.located(joint, np.array(model.body(joint).pos))
    grip = np.array(model.site(actuator.site).pos)
    seen = about_z(here.sensed.turned(joint))
    start = here.sensed.joint(joint)

    def at(angle: float) -> Array:
        return hinge + seen @ about_x(-angle) @ grip

    tilted, grasps = seen @ about_x(-start), []
    for pitch in (0.0, 0.3, 0.6, -0.3):
        for yaw in (0.0, -0.4, -0.8, 0.4):
            for side in (1.0, -1.0):
                approach = tilted @ about_z(yaw) @ [0.0, math.cos(pitch), -math.sin(pitch)]
                hand = grip_frame(approach, tilted @ [0.0, 0.0, side])
                grasps.append(Grasp(at(start), hand, here.robot.frame, before=at(start) - hand[:, 2] * 0.10))
    for pitch in (0.8, 1.1):
        for side in (1.0, -1.0):
            hand = seen @ grip_frame([0.0, math.cos(pitch), -math.sin(pitch)], [side, 0.0, 0.0])
            grasps.append(Grasp(at(start), hand, here.robot.frame, before=at(start) - hand[:, 2] * 0.12))
    target, beyond = (actuator.worked, 0.2) if on else (0.0, -0.15)
    turn = _Turn(joint, joint, at, lambda a: about_x(-0.6 * a), target, beyond, 0.8, 0.03, 0.004)
    stands = stances(here, at(start), (0.64, 0.7, 0.58, 0.76), (0.0, 0.12, -0.12, 0.25, -0.25))
    yield from _turn_hinge(here, turn, grasps, stands)


def _push_button(here: Workspace, actuator: Actuator) -> Steps:
    """Push a button in with closed fingertips and let go."""
    sensed, robot, planner = here.sensed, here.robot, here.clear.planner
    name = actuator.joint
    here.begin()
    yield from tuck(here)
    robot.grip = 0.0
    yield from here.mover.fingers(0.0, 8)
    here.begin(sensed.geoms(name))
    here.clear.checker.fingers(0.0)
    face = np.array(sensed.model.body(name).pos) + np.array(sensed.model.site(actuator.site).pos)
    face, seen = sensed.located(name, face), about_z(sensed.turned(name))
    longer, grasps = robot.body.fingertip.beyond - MEASURED.beyond, []
    for pitch in (0.5, 0.8, 0.3, 0.0):
        for yaw in (0.0, 0.4, -0.4):
            for side in (1.0, -1.0):
                approach = about_z(yaw) @ [0.0, math.cos(pitch), -math.sin(pitch)]
                hand = seen @ grip_frame(approach, about_z(yaw) @ [side, 0.0, 0.0])
                at = face - hand[:, 2] * (_BEFORE + longer)
                grasps.append(Grasp(at, hand, here.robot.frame, before=at - hand[:, 2] * 0.10))

    def after(goal: Array, grasp: Grasp) -> Path | Hit | NoWay:
        return planner.line(goal, grasp.shifted(seen @ [0.0, 0.018, 0.0]), speed=0.05, check=False)

    stands = stances(here, face, (0.66, 0.74, 0.58, 0.82), (0.0, -0.12, 0.12, -0.25, 0.25))
    found = plan_reach(here, stands, grasps, after)
    yield from go_to_grasp(here, found)
    yield from here.mover.play(found.after)
    pushed = sensed.joint(name)
    yield from here.mover.play(found.approach[::-1])
    yield from here.mover.fingers(min(0.04, robot.body.finger_travel), 4)
    here.begin()
    yield from go_home(here)
    if pushed < actuator.counts:
        raise SkillFailure("slipped", f"the {actuator.switch} button went in by only {1000 * pushed:.0f} mm")


def _turn_hinge(here: Workspace, turn: _Turn, grasps: Sequence[Grasp], stands: Sequence[Array]) -> Steps:
    """Grasp, go along with the hinge, let go, straight back, home."""
    sensed, robot, planner = here.sensed, here.robot, here.clear.planner
    here.begin()
    yield from tuck(here)
    geoms = sensed.geoms(turn.body)
    here.begin(geoms)
    here.clear.checker.fingers(turn.opening)
    robot.grip = turn.opening
    start = sensed.joint(turn.joint)
    end = turn.target + turn.beyond

    def after(goal: Array, grasp: Grasp) -> Free | Hit | NoWay:
        q = goal
        for k in range(1, 9):
            angle = start + (end - start) * k / 8
            step = planner.kinematics.track(
                q, turn.at(angle), turn.turn(angle - start) @ grasp.rotation, iterations=8, largest=3 * planner.step
            )
            q = step.q
            off = step.position_error > 0.006 or step.rotation_error > 0.08
            free = NoWay("the arm cannot follow") if off else here.clear.checker.free(q)
            if not free:
                return NoWay(f"turning: {free}")
        away = planner.line(q, planner.hand(q).back(0.12))
        return away if isinstance(away, Hit | NoWay) else FREE

    found = plan_reach(here, stands, grasps, after)
    yield from go_to_grasp(here, found)
    yield from here.mover.fingers(turn.closing, 7)
    sign, angle = math.copysign(1.0, end - start), start
    for _ in range(80):
        angle = sign * min(sign * angle + turn.rate * CONTROL_PERIOD, sign * end)
        wanted = turn.turn(angle - start) @ found.grasp.rotation
        step = planner.kinematics.track(robot.q, turn.at(angle), wanted, largest=planner.step)
        yield from here.mover.step(step.q)
        if sign * sensed.joint(turn.joint) >= sign * turn.target:
            break
    yield from here.mover.fingers(turn.opening, 5)
    here.begin(geoms)
    away = planner.hand(robot.q).back(0.12)
    path = planner.line(robot.q, away) or planner.line(robot.q, away, check=False)
    yield from here.mover.play(path or [])
    here.begin()
    yield from go_home(here)
    reached = sensed.joint(turn.joint)
    if abs(reached - turn.target) > 0.25:
        raise SkillFailure("slipped", f"{turn.joint} stands at {reached:.2f} rad")
