"""What a policy sees of a skill, as one flat vector with names, units and ranges.

Recording, training and playing share this file; VERSION is raised whenever numbers of the same names change, and
policies that were trained on another version, or on other names, are refused. Everything is expressed in the frame of
the stand.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from remac_env.backends.physics.controllers.base import Sensing
from remac_env.backends.physics.controllers.learned.aim import Aim, Target, feels
from remac_env.backends.physics.controllers.learned.drive import CORNERS, FINE
from remac_env.robots import bodies
from remac_env.robots.bodies import STANDARD
from remac_env.robots.body import Body
from remac_env.robots.rotation import Array
from remac_env.rules.skill_row import Skill
from remac_env.rules.skills import SKILLS

VERSION = 1

RANGES = 24
FARTHEST = 4.0  # m that is looked around at most
_WAYS = math.tau * np.arange(RANGES) / RANGES  # rad, from straight ahead to the left
_LEVEL = 0.25  # m over the floor: through the middle of bases and of base cabinets

_ROOM = 12.0  # m, further than any two points of a kitchen are apart
_REACH = 2.0  # m, further than a hand gets from its station


class Entry(NamedTuple):
    """One number of a vector: its name, unit ("" for none) and range."""

    name: str
    unit: str
    low: float
    high: float


def taught() -> tuple[Skill, ...]:
    """The skills that a policy can carry out: those with a target."""
    return tuple(skill for skill in SKILLS.values() if skill.target != "none")


def _point(name: str, far: float, axes: str = "xyz") -> tuple[Entry, ...]:
    return tuple(Entry(f"{name}_{axis}", "m", -far, far) for axis in axes)


def _axis(name: str) -> tuple[Entry, ...]:
    return tuple(Entry(f"{name}_{axis}", "", -1.0, 1.0) for axis in "xyz")


def _of_body(body: Body) -> tuple[Entry, ...]:
    lift, *arm = [(float(low), float(high)) for low, high in zip(body.lowest[3:], body.highest[3:], strict=True)]
    return (
        *_point("base", _ROOM, "xy"), Entry("base_yaw_cos", "", -1.0, 1.0), Entry("base_yaw_sin", "", -1.0, 1.0),
        Entry("torso", "m", *lift), *(Entry(f"joint{number}", "rad", *ends) for number, ends in enumerate(arm, 1)),
        Entry("finger_command", "m", 0.0, body.finger_travel), Entry("opening", "m", 0.0, 2.0 * body.finger_travel),
        Entry("hand_feels", "", 0.0, 1.0),
        *_point("hand", _ROOM), *_axis("hand_opening"), *_axis("hand_approach"),
    )  # fmt: skip


_TARGET = (
    *_point("target", _ROOM), *_point("hand_to_target", _ROOM), *_point("target_from_hand", _ROOM),
    *(Entry(f"target_{name}", "", -1.0, 1.0) for name in ("yaw_cos", "yaw_sin", "two_yaw_cos", "two_yaw_sin")),
    *_point("target_size", _REACH),
    Entry("grasp_height", "m", -1.0, 1.0), Entry("grasp_width", "m", 0.0, 1.0), Entry("grasp_lean", "rad", -3.2, 3.2),
    Entry("grasp_any_yaw", "", 0.0, 1.0),
    Entry("target_joint", "rad or m", -3.2, 3.2), Entry("target_joint_goal", "rad or m", -3.2, 3.2),
    Entry("target_side", "", -1.0, 1.0), Entry("target_worked", "", 0.0, 1.0),
    *(Entry(f"skill_{skill.name.replace(' ', '_')}", "", 0.0, 1.0) for skill in taught()),
)  # fmt: skip
_AROUND = tuple(Entry(f"range_{360 * number // RANGES}", "m", 0.0, FARTHEST) for number in range(RANGES))
_FAR, _CORNER = math.asinh(_ROOM / FINE), "corner"
_WAY = tuple(
    Entry(f"{_CORNER}{number}_{name}", "", -far, far)
    for number in range(CORNERS)
    for name, far in (("right", 1.0), ("to_wall", 1.0), ("far", _FAR), ("turn", _FAR))
)


def entries(skill: Skill, body: str = STANDARD) -> tuple[Entry, ...]:
    """What the numbers of a skill's observation are, of robots with this body. Skills that move it also look around,
    and see the corners of their way.
    """
    return (*_of_body(bodies.get(body)), *_TARGET, *((*_AROUND, *_WAY) if skill.moves else ()))


def overlooked(skill: Skill, body: str = STANDARD) -> list[int]:
    """Which numbers of its observation a network does not look at, so that what it learns in one kitchen holds in all.

    Of a drive they are where in the kitchen it is and what is around, as that is different in each, and how the arm is
    held, which is not moved: its way is enough.
    """
    names = [entry.name for entry in entries(skill, body)]
    return [number for number, name in enumerate(names) if skill.moves and not name.startswith(_CORNER)]


def observe(sensing: Sensing, aim: Aim, skill: Skill, kind: str = STANDARD) -> NDArray[np.float32]:
    """The observation (n,) now, within the ranges of `entries(skill, kind)`; ``kind``: the name of the robot's body."""
    body, stand, target = sensing.body, aim.stand, aim.target()
    q, grip = stand.joints(body.q), body.grip
    hand, turn = stand.point(grip.position), stand.turn(grip.rotation)
    way = target.at - hand
    parts: list[Any] = [
        q[:2], [math.cos(q[2]), math.sin(q[2])], q[3:], [body.commanded_opening, body.opening, float(feels(body))],
        hand, turn[:, 0], turn[:, 2], target.at, way, way @ turn, _facts(target),
        [float(other.name == skill.name) for other in taught()],
        *([sensing.scan(_WAYS, height=_LEVEL, farthest=FARTHEST), aim.ahead()] if skill.moves else []),
    ]  # fmt: skip
    low, high = _ranges(skill, kind)
    return np.clip(np.concatenate(parts), low, high).astype(np.float32)


def _facts(target: Target) -> list[float]:
    yaw = target.yaw
    return [
        math.cos(yaw), math.sin(yaw), math.cos(2 * yaw), math.sin(2 * yaw), *target.size, *target.grasp,
        target.joint, target.goal, target.side, target.worked,
    ]  # fmt: skip


@lru_cache(maxsize=32)
def _ranges(skill: Skill, body: str) -> tuple[Array, Array]:
    known = entries(skill, body)
    return np.array([entry.low for entry in known]), np.array([entry.high for entry in known])
