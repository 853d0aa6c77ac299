"""Season: hold the shaker over the food, tip it over, shake, set it upright again and come home with it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product

import numpy as np

from remac_env.backends.physics.grasps import Grasp
from remac_env.backends.physics.paths import Path
from remac_env.backends.physics.reach import go_to_grasp, plan_reach
from remac_env.backends.physics.skill import SkillFailure, Steps, Surroundings, check_held, go_home, stances
from remac_env.robots.rotation import Array, about_z, from_rotation_vector

_HEIGHT = (0.22, 0.28, 0.34)  # m of the shaker's frame over the food
_TIPS = (2.0, 1.8, 2.3)  # rad from upright
# m from the shaker's top to the food, as grains fly; into an opening.
_AHEAD, _AHEAD_IN = (0.05,), (0.20, 0.14, 0.10, 0.23)
_TURNS_IN = (math.pi, 2.7, -2.7, 2.3, -2.3)
_SHAKES, _SHAKE, _SHAKING = 4, 0.04, 0.5  # times, m up and down, m/s
_FIRM = 30.0  # N a finger with which a shaker is held that is to be shaken
_TURNS = (0.0, 0.5, -0.5, 1.0, -1.0, 1.6, -1.6, 2.4, -2.4, math.pi)


def season(here: Surroundings, food: str, *, inside: str | None = None) -> Steps:
    """Shake the held shaker over ``food``. ``inside``: the fixture it is in, where it is not on top of something."""
    body = here.hand.body
    if body is None:
        raise SkillFailure("hands_empty", "there is no shaker in the hand")
    here.begin()
    robot, planner = here.robot, here.planner
    over = here.simulation.pose(food)[0]
    # Behind an opening, the shaker stays in front of it and points in.
    turns, ahead = (_TURNS_IN, _AHEAD_IN) if inside else (_TURNS, _AHEAD)
    grasps = _over(here, over, turns=turns, ahead=ahead)

    def after(goal: Array, grasp: Grasp) -> Path | None:
        up = planner.line(goal, grasp.position + [0.0, 0.0, _SHAKE], grasp.rotation, speed=_SHAKING)
        if up is None:
            return None
        down = [*up[::-1], goal]
        return [q for _ in range(_SHAKES) for q in (*up, *down)]

    found = plan_reach(here, stances(here, over, (0.6, 0.7, 0.5, 0.8), (0.0, -0.12, 0.12, 0.24, -0.24)), grasps,
                       after, carry=robot.q.copy())
    yield from here.mover.fingers(here.mover.squeezed(_FIRM), 3)
    yield from go_to_grasp(here, found, speed=0.7)
    yield from here.mover.play(found.after)
    yield from here.mover.play([*found.approach[::-1]])
    check_held(here)
    here.begin()
    yield from go_home(here)


def _held(here: Surroundings) -> tuple[Array, Array]:
    """Offset (3,) and rotation (3, 3) of the held thing in the grip frame."""
    grip, pose = here.robot.grip_pose(), here.simulation.pose(str(here.hand.body))
    inward = grip[1].T
    return inward @ (pose[0] - grip[0]), inward @ pose[1]


def _over(here: Surroundings, over: Array, *, turns: Sequence[float], ahead: Sequence[float]) -> list[Grasp]:
    """Hands that hold the shaker tipped, its top ``ahead`` (m) of the food that its grains fly to."""
    offset, turned = _held(here)
    top = 2.0 * here.things[str(here.hand.body)].size[2]
    found = []
    for tip, far, turn, height in product(_TIPS, ahead, turns, _HEIGHT):
        upright = about_z(turn)
        tipped = from_rotation_vector(upright[:, 0] * tip) @ upright
        way = tipped[:, 2] * [1.0, 1.0, 0.0]
        hand = tipped @ turned.T
        at = over + [0.0, 0.0, height] - top * way - far * way / np.linalg.norm(way) - hand @ offset
        found.append(Grasp(at, hand, at + [0.0, -0.06, 0.06]))
    return found
