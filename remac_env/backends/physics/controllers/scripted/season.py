"""Season: hold the shaker over the food, tip it over, shake, set it upright again and come home with it."""

from __future__ import annotations

import math
from itertools import product

from remac_env.backends.physics.controllers.scripted.grasps import Grasp
from remac_env.backends.physics.controllers.scripted.paths import Path
from remac_env.backends.physics.controllers.scripted.reach import go_to_grasp, plan_reach
from remac_env.backends.physics.controllers.scripted.skill import SkillFailure, Steps, check_held, go_home, stances
from remac_env.backends.physics.controllers.scripted.verdicts import Hit, NoWay
from remac_env.backends.physics.controllers.scripted.workspace import Workspace
from remac_env.robots.rotation import Array, about_z, from_rotation_vector

_HEIGHT = (0.22, 0.28, 0.34)  # m of the shaker's frame over the food
_TIPS = (2.0, 1.8, 2.3)  # rad from upright
_AHEAD = (0.20, 0.16, 0.23)  # m that the shaker's top stays before food behind an opening
_SHAKES, _SHAKE, _SHAKING = 4, 0.04, 0.5  # times, m up and down, m/s
_GENTLY = 0.3  # of the arm's usual speed, to the food and back: a shaker creeps the further the faster its hand turns
_FIRM = 30.0  # N a finger with which a shaker is held that is to be shaken
_TURNS = (0.0, 0.5, -0.5, 1.0, -1.0, 1.6, -1.6, 2.4, -2.4, math.pi)


def season(here: Workspace, food: str, *, inside: str | None = None) -> Steps:
    """Shake the held shaker over ``food``. ``inside``: the fixture it is in, where it is not on top of something."""
    body = here.hand.body
    if body is None:
        raise SkillFailure("hands_empty", "there is no shaker in the hand")
    here.begin()
    robot, planner = here.robot, here.clear.planner
    over = here.sensed.pose(food).position
    # Behind an opening, the shaker stays in front of it; grains scatter so far.
    points = [over - [0.0, ahead, 0.0] for ahead in _AHEAD] if inside else [over]
    grasps = [grasp for point in points for grasp in _over(here, point)]

    def after(goal: Array, grasp: Grasp) -> Path | Hit | NoWay:
        up = planner.line(goal, grasp.shifted([0.0, 0.0, _SHAKE]), speed=_SHAKING)
        if not up:
            return up
        down = [*up[::-1], goal]
        return [q for _ in range(_SHAKES) for q in (*up, *down)]

    found = plan_reach(here, stances(here, over, (0.6, 0.7, 0.5, 0.8), (0.0, -0.12, 0.12, 0.24, -0.24)), grasps,
                       after, carry=robot.q.copy())
    yield from here.mover.fingers(here.mover.squeezed(_FIRM), 3)
    yield from go_to_grasp(here, found, speed=_GENTLY)
    yield from here.mover.play(found.after)
    yield from here.mover.play([*found.approach[::-1]])
    check_held(here)
    here.begin()
    yield from go_home(here, laden=_GENTLY)


def _held(here: Workspace) -> tuple[Array, Array]:
    """Offset (3,) and rotation (3, 3) of the held object in the grip frame."""
    return here.robot.grip_pose().of(here.sensed.pose(str(here.hand.body)))


def _over(here: Workspace, point: Array) -> list[Grasp]:
    """Hands that hold the shaker tipped, its top over a point (3,)."""
    offset, turned = _held(here)
    top = 2.0 * here.kitchen.objects[str(here.hand.body)].size[2]
    found = []
    for tip, turn, height in product(_TIPS, _TURNS, _HEIGHT):
        upright = about_z(turn)
        tipped = from_rotation_vector(upright[:, 0] * tip) @ upright
        hand = tipped @ turned.T
        at = point + [0.0, 0.0, height] - top * tipped[:, 2] * [1.0, 1.0, 0.0] - hand @ offset
        found.append(Grasp(at, hand, here.robot.frame, before=at + [0.0, -0.06, 0.06]))
    return found
