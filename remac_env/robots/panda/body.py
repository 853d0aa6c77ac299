"""The mobile Panda as a body. Importable without MuJoCo."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from remac_env.errors import check_choice
from remac_env.robots.body import Fingertip
from remac_env.robots.panda import measures
from remac_env.seeding import digest

if TYPE_CHECKING:
    import mujoco

    from remac_env.robots.body import Kinematics

Array = NDArray[np.float64]


class Panda:
    """See `remac_env.robots.body.Body`. mount_height: of the first arm link over the floor, with the lift down (m)."""

    joints: tuple[str, ...] = measures.JOINTS
    fingers: tuple[str, ...] = measures.FINGERS
    hands: tuple[str, ...] = ("hand",)
    skirt: str = measures.SKIRT
    lower: Array = measures.LOWER
    upper: Array = measures.UPPER
    lowest: Array = measures.LOWEST
    highest: Array = measures.HIGHEST
    speed: Array = measures.SPEED
    top_speed: Array = measures.TOP_SPEED
    acceleration: float = measures.BASE_ACCELERATION
    torques: tuple[float, ...] = measures.ARM_FORCE
    finger_travel: float = measures.FINGER_OPEN
    finger_stiffness: float = measures.FINGER_STIFFNESS
    grip_friction: float = measures.PAD_FRICTION
    fingertip: Fingertip = measures.FINGERTIP
    palm: float = measures.PALM
    footprint: tuple[tuple[float, float], tuple[float, float]] = ((-0.42, -0.24), (0.15, 0.24))
    folded: Array = measures.TUCK_ARM
    via: tuple[Array, ...] = (
        measures.HOME_ARM,
        measures.TUCK_ARM,
        np.array([0.0, -1.2, 0.0, -2.3, 0.0, 2.2, math.pi / 4]),
        np.array([0.9, -1.2, 0.0, -2.6, 0.0, 2.4, math.pi / 4]),
        np.array([-0.9, -1.2, 0.0, -2.6, 0.0, 2.4, math.pi / 4]),
        np.array([0.0, -0.6, 0.0, -2.9, 0.0, 3.0, math.pi / 4]),
    )
    lift_tucked: float = measures.TUCK_TORSO
    lifts: Array = measures.TORSO_HEIGHTS
    arm_weights: Array = measures.ARM_WEIGHTS
    door_weights: Array = measures.DOOR_WEIGHTS

    def __init__(self, name: str = "panda", mount_height: float = measures.MOUNT_HEIGHT) -> None:
        self.name, self.mount_height = name, mount_height

    @property
    def fingerprint(self) -> str:
        """Its joints, limits, links and fingers."""
        links = [[link.name, *link.position, link.turn_x] for link in measures.LINKS]
        limits = [[round(float(value), 6) for value in values] for values in (self.lower, self.upper, self.speed)]
        hand = [self.finger_travel, measures.FLANGE, measures.GRIP_DEPTH, self.mount_height]
        return digest([self.joints, links, limits, *hand])

    def tuck(self, x: float, y: float, yaw: float) -> Array:
        """See Body."""
        return measures.tucked(x, y, yaw)

    def add_to(
        self, spec: mujoco.MjSpec, name: str, *, visual: bool = False,
        accent: tuple[float, float, float] = (0.1, 0.4, 0.8),
    ) -> None:
        """See Body."""
        from remac_env.robots.panda.model import add_robot

        add_robot(spec, name, visual=visual, accent=accent, mount_height=self.mount_height)

    def kinematics(self, arm: str = "") -> Kinematics:
        """See Body."""
        from remac_env.robots.panda.ik import Kinematics

        check_choice("arm", arm or self.hands[-1], self.hands)
        return Kinematics(self, self.mount_height)
