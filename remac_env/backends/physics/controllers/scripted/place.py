"""Place to: set what the hand holds on a worktop, burner or basin, or on or into a vessel standing there."""

from __future__ import annotations

import math
from contextlib import suppress
from itertools import product

from remac_env.backends.physics.controllers.scripted.collision import TARGET
from remac_env.backends.physics.controllers.scripted.grasps import Grasp
from remac_env.backends.physics.controllers.scripted.paths import Path
from remac_env.backends.physics.controllers.scripted.reach import After, Reach, go_to_grasp, reach_in_slot
from remac_env.backends.physics.controllers.scripted.skill import SkillFailure, Steps, check_held, go_home, lowest
from remac_env.backends.physics.controllers.scripted.verdicts import Hit, NoWay
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.kitchen.objects.catalogue import Category
from remac_env.robots.rotation import Array, about_x, about_z, from_rotation_vector, rotation_vector

_RELEASE = 0.008  # m above the surface at which the hand opens
# Leaning back brings wrist and forearm out from under a wall cabinet; in a basin a hand that took an object leaning has
# to be set upright, or its forearm would meet the front edge: the object slides off it into place.
_LEANS = ((0.0, 0.35, 0.6), (0.0, -0.35, -0.6, 0.35, 0.6))
_TURNS = (0.0, 0.4, -0.4, 0.8, -0.8, 1.2, -1.2)
_LEVEL_TURNS = (0.0, 0.2, -0.2, 0.4, -0.4, 0.6, -0.6, 0.8, -0.8, 1.0, -1.0, 1.4, -1.4, 2.0, -2.0)
# Vessels are set down beside and behind a basin's middle, with the hand at their side: at the middle the forearm
# would meet the basin's front edge.
_BASIN_SHIFTS = ((-0.03, 0.065), (-0.05, 0.06), (-0.12, 0.06), (0.03, 0.065), (0.05, 0.06), (0.12, 0.06), (0.0, 0.08))
_BASIN_TURNS = (1.4, -1.4, 1.0, -1.0, 0.8, -0.8, 1.8, -1.8, 0.2, -0.2, 0.0)
# m beside a slot's middle, where a neighbour that stands off its own slot leaves no room there.
_ASIDE = tuple((dx, dy) for dy in (0.0, 0.05, -0.05) for dx in (0.04, -0.04, 0.08, -0.08))
_DROOPS = (0.0, 0.5, 1.0)  # shares of its droop in the hand with which a vessel may be set down
_OVER_RIM = 0.26  # m above a basin's floor
_FROM_ABOVE = 0.10  # m above its place from where the hand comes straight; over the rim into a basin


def place_on(here: Workspace, point: Array, *, kind: str, vessel: str | None = None) -> Steps:
    """Set the held object down with its lowest point at ``point`` (3,), then come home empty-handed.

    ``kind``: of the slot in which the point lies. ``vessel``: hand and object may touch this body.
    """
    body = here.hand.body
    if body is None:
        raise SkillFailure("hands_empty", "there is nothing to place")
    obj, robot = here.kitchen.objects[body], here.robot
    here.begin(here.sensed.geoms(vessel) if vessel else ())
    if not here.clear.checker.free(robot.q):
        here.begin(here.sensed.geoms(vessel) if vessel else (), held_meets=False)
    grip, pose = robot.grip_pose(), here.sensed.pose(body)

    # Out of a basin the arm is folded more easily from over its rim.
    backs = (0.12,) if kind != "basin" else (_OVER_RIM,) if obj.vessel else (_OVER_RIM, 0.12)

    def after(goal: Array, grasp: Grasp) -> Path | Hit | NoWay:
        here.clear.checker.free(goal)
        here.clear.checker.release(leave=True)
        here.clear.checker.mark(here.sensed.geoms(body), TARGET)
        out: Path | Hit | NoWay = NoWay("no way out")
        for back in backs:
            out = out or here.clear.planner.line(goal, grasp.back(back), speed=0.25)
        here.clear.checker.hold(body, grip, pose)
        return out

    found = _way_down(here, kind, point, after, shifted=vessel is None)
    yield from go_to_grasp(here, found, speed=0.7)
    check_held(here)
    yield from release(here)
    yield from here.mover.play(found.after)
    here.begin(here.sensed.geoms(body))
    yield from go_home(here)


def _way_down(here: Workspace, kind: str, point: Array, after: After, *, shifted: bool) -> Reach:
    """A way to set the held object down on ``point`` or, on a worktop where it does not fit, a little beside it."""
    carry = here.robot.q.copy()
    try:
        return reach_in_slot(here, kind, point, upright_poses(here, point, kind), after, carry=carry)
    except SkillFailure as failure:
        if kind != "surface" or not shifted or failure.reason != "blocked":
            raise
        beside = [pose for aside in _ASIDE for pose in upright_poses(here, point + [*aside, 0.0], kind)]
        with suppress(SkillFailure):
            return reach_in_slot(here, kind, point, beside, after, carry=carry)
        raise


def release(here: Workspace, periods: int = 6) -> Steps:
    """Open the fingers; the hand is empty from now on."""
    body = here.hand.body
    level = body is not None and here.kitchen.objects[body].vessel
    yield from here.mover.fingers(min(0.03 if level else 0.04, here.robot.body.finger_travel), periods)
    here.hand.body, here.hand.contents = None, ()


def upright_poses(here: Workspace, point: Array, kind: str) -> list[Grasp]:
    """Poses of the hand that set the held object upright on ``point``; its turn about the vertical is free."""
    body = here.hand.body
    if body is None:
        return []
    obj = here.kitchen.objects[body]
    grip, pose = here.robot.grip_pose(), here.sensed.pose(body)
    offset, turned = grip.of(pose)
    # A vessel droops in the fingers, the more the longer it is carried: the hand sets it level again, or partly where
    # it would touch the worktop itself. Other objects stood as they were found.
    level = about_z(math.atan2(pose.rotation[1, 0], pose.rotation[0, 0]))
    droop = rotation_vector(pose.rotation @ level.T)
    stood = [from_rotation_vector(part * droop) @ level for part in _DROOPS] if obj.vessel else [here.hand.upright]
    edges = [lowest(here, body, upright) - obj.rest_height if obj.vessel else 0.0 for upright in stood]
    goals = [point + [0.0, 0.0, obj.rest_height]]
    if kind == "basin" and obj.vessel:
        goals = [goals[0] + [dx, dy, 0.0] for dx, dy in _BASIN_SHIFTS]
    found = []
    above = _OVER_RIM if kind == "basin" else _FROM_ABOVE
    leans, turns = (0.0,) if obj.vessel else _LEANS[kind == "basin"], _turns(obj, kind)
    for (upright, edge), goal, lean, turn in product(zip(stood, edges, strict=True), goals, leans, turns):
        hand = about_x(lean) @ about_z(turn) @ upright @ turned.T
        shift = [0.0, -0.05 * lean, _RELEASE + 0.035 * math.sin(abs(lean)) + edge]
        at = goal + shift - hand @ offset
        before = at + [0.0, -0.08 * math.sin(max(0.0, lean)), above]
        found.append(Grasp(at, hand, pose.frame, before=before))
    if not obj.vessel and point[2] > 0.85 and _covered(here, point):
        # Under something low every upright hand would be tried in vain: lean first.
        found = found[len(found) // 3 :] + found[: len(found) // 3]
    return found


def _turns(obj: Category, kind: str) -> tuple[float, ...]:
    """Turns of an object about the vertical worth trying, best first."""
    if obj.vessel:
        return _BASIN_TURNS if kind == "basin" else _LEVEL_TURNS
    return tuple(turn + flip for turn in _TURNS for flip in (0.0, math.pi))


def _covered(here: Workspace, point: Array) -> bool:
    """True when a fixture hangs less than 0.6 m above the point, or just behind it."""
    for fixture in here.kitchen.layout.at_wall(here.station.wall):
        for block in fixture.blocks:
            inside = block.low[0] - 0.1 < point[0] < block.high[0] + 0.1 and block.low[1] - 0.15 < point[1]
            if inside and point[2] + 0.1 < block.low[2] < point[2] + 0.6:
                return True
    return False
