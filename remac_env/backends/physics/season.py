"""Season: hold the shaker over the food, tip it over, shake, set it upright again and come home with it."""

from __future__ import annotations

import math

import numpy as np

from remac_env.backends.physics.grasps import Grasp
from remac_env.backends.physics.paths import Path
from remac_env.backends.physics.reach import go_to_grasp, plan_reach
from remac_env.backends.physics.skill import SkillFailure, Steps, Surroundings, check_held, go_home, stances
from remac_env.robots.rotation import Array, about_z, from_rotation_vector

_HEIGHT = (0.22, 0.28, 0.34)  # m of the shaker's frame over the food
_TIPPED = 2.0  # rad from upright
_SHAKES, _SHAKE = 3, 0.02  # m up and down
_TURNS = (0.0, 0.5, -0.5, 1.0, -1.0, 1.6, -1.6, 2.4, -2.4, math.pi)


def season(here: Surroundings, food: str, *, inside: str | None = None) -> Steps:
    """Shake the held shaker over ``food``. ``inside``: the fixture it is in, where it is not on top of something."""
    body = here.hand.body
    if body is None:
        raise SkillFailure("hands_empty", "there is no shaker in the hand")
    here.begin()
    robot, planner = here.robot, here.planner
    over = here.seen(food)[0]
    grasps = _in_front(here, over) if inside else _above(here, over)

    def after(goal: Array, grasp: Grasp) -> Path | None:
        up = planner.line(goal, grasp.position + [0.0, 0.0, _SHAKE], grasp.rotation, speed=0.25)
        if up is None:
            return None
        down = [*up[::-1], goal]
        return [q for _ in range(_SHAKES) for q in (*up, *down)]

    found = plan_reach(here, stances(here, over, (0.6, 0.7, 0.5, 0.8), (0.0, -0.12, 0.12, 0.24, -0.24)), grasps,
                       after, carry=robot.q.copy())
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


def _above(here: Surroundings, over: Array) -> list[Grasp]:
    """Hands that hold the shaker tipped over the food, from above."""
    offset, turned = _held(here)
    found = []
    for tip in (_TIPPED, 1.7, 2.3):
        for turn in _TURNS:
            for height in _HEIGHT:
                axis = about_z(turn)[:, 0]
                hand = from_rotation_vector(axis * tip) @ about_z(turn) @ turned.T
                at = over + [0.0, 0.0, height] - hand @ offset
                found.append(Grasp(at, hand, at + [0.0, -0.06, 0.06]))
    return found


def _in_front(here: Surroundings, over: Array) -> list[Grasp]:
    """The same, kept in front of an opening."""
    grasps = []
    for ahead in (0.12, 0.2, 0.28):
        grasps += [
            Grasp(g.position - [0.0, ahead, 0.0], g.rotation, g.before - np.array([0.0, ahead, 0.0]))
            for g in _above(here, over)
        ]
    return grasps
