"""Pick up: from a slot on a worktop, burner or basin, or out of a vessel there."""

from __future__ import annotations

import numpy as np

from remac_env.backends.physics.controllers.scripted.collision import IGNORED, TARGET
from remac_env.backends.physics.controllers.scripted.grasps import Grasp, awkward, candidates, opening, squeeze
from remac_env.backends.physics.controllers.scripted.paths import Path
from remac_env.backends.physics.controllers.scripted.reach import go_to_grasp, reach_in_slot
from remac_env.backends.physics.controllers.scripted.skill import (
    EMPTY,
    SkillFailure,
    Steps,
    check_held,
    go_home,
    take,
    tuck,
)
from remac_env.backends.physics.controllers.scripted.verdicts import Hit, NoWay
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.backends.physics.pose import Pose
from remac_env.robots.rotation import Array

Lifts = tuple[tuple[float, float], ...]
LIFTS: Lifts = ((0.0, 1.0), (-0.08, 1.0), (-0.14, 1.0), (-0.15, 0.6), (-0.25, 0.4))
_LEAST_RISE = 0.02
_RIM_TOLERANCE = 0.001  # m; a hand that closes 3 mm too high holds only a rim's edge


def pick_up(
    here: Workspace, body: str, *, kind: str, vessel: str | None = None, contents: tuple[str, ...] = (),
    lift: float = 0.14, lifts: Lifts = LIFTS,
) -> Steps:
    """Grasp ``body`` where it stands, lift it and come home with it.

    ``kind``: of the slot in which it stands. ``vessel``: what it lies in.
    """
    sensed, obj = here.sensed, here.kitchen.objects[body]
    here.begin()
    carry = here.robot.q.copy() if here.midway else None
    if carry is None:
        yield from tuck(here)
    here.begin(sensed.geoms(body) + (sensed.geoms(vessel) if vessel else []))
    stood = here.sensed.pose(body)
    here.robot.grip = opening(obj, here.robot.body)
    here.clear.checker.fingers(here.robot.grip)
    for inner in contents:
        here.clear.checker.mark(sensed.geoms(inner), IGNORED)

    def after(goal: Array, grasp: Grasp) -> Path | Hit | NoWay:
        return _lift(here, body, goal, grasp, lift, lifts)

    grasps = candidates(obj, stood, here.robot.body)
    # A handle lies well in front of its pan; too near to it the arm could not draw the pan in.
    target = grasps[0].position if obj.grasp.mode == "handle" else stood.position
    askew = awkward(obj, stood, here.robot.body)
    found = reach_in_slot(here, kind, target, grasps, after, awkward=askew, carry=carry)
    yield from go_to_grasp(here, found)
    if obj.grasp.mode == "rim":
        yield from here.mover.settle(_RIM_TOLERANCE, 20)
    yield from here.mover.grasp(squeeze(obj, here.robot.body))
    yield from here.mover.play(found.after)
    risen = sensed.pose(body).position[2] - stood.position[2]
    if here.robot.opening < EMPTY or risen < _LEAST_RISE:
        yield from here.mover.fingers(opening(obj, here.robot.body), 6)
        raise SkillFailure("slipped", f"the {body} did not come up with the hand")
    take(here, body, stood, contents)
    if obj.vessel:
        yield from draw_in(here)
    yield from go_home(here)
    check_held(here)


def _lift(
    here: Workspace, body: str, goal: Array, grasp: Grasp, lift: float, lifts: Lifts
) -> Path | Hit | NoWay:
    """Off the surface unchecked for the object itself, then up, or slanting out from under something."""
    checker, planner = here.clear.checker, here.clear.planner
    at = planner.hand(goal)
    pose = here.sensed.pose(body)
    checker.hold(body, at, pose, meets=False)
    off = path = planner.line(goal, grasp.shifted([0.0, 0.0, 0.03]), speed=0.15)
    if off:
        checker.hold(body, at, pose)
        for back, share in lifts:
            rest = planner.line(off[-1], grasp.shifted([0.0, back, share * lift]))
            path = off + rest if rest else rest
            if path:
                break
    checker.release()
    checker.mark(here.sensed.geoms(body), TARGET)
    return path


def draw_in(here: Workspace) -> Steps:
    """Bring an object that must stay level to the carry posture: near the body, the hand's orientation kept."""
    here.begin()
    robot, planner = here.robot, here.clear.planner
    hand = planner.hand(robot.q)
    height = float(hand.position[2])
    forward = robot.heading
    left = np.array([-forward[1], forward[0], 0.0])
    why: Hit | NoWay = NoWay("no room to stand")
    for back in (0.0, 0.2, 0.4):
        stand = robot.q.copy()
        stand[:2] -= back * forward[:2]
        if stand[1] < here.station.y - 1e-6 or (back and not planner.edge(robot.q, stand)):
            continue
        axis = np.array([stand[0], stand[1], 0.0])
        for ahead in (0.42, 0.50, 0.36, 0.60):
            for up in (0.06, 0.15, 0.0, 1.15 - height, 1.25 - height):
                for side in (0.0, -0.1, 0.1, -0.2, 0.2):
                    target = axis + ahead * forward + side * left + [0.0, 0.0, height + up]
                    path = planner.line(stand, Pose(target, hand.rotation, hand.frame), speed=0.25)
                    if not isinstance(path, Hit | NoWay):
                        yield from here.mover.go([stand] if back else [])
                        yield from here.mover.play(path)
                        return
                    why = path
    raise SkillFailure("blocked", f"no level way to draw the hand in: {why}")
