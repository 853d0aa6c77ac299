"""A body with another arm, by the recipe of docs/extending.md: six joints instead of seven, another hand and base."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from remac_env.robots.body import Array, Fingertip, Kinematics
from remac_env.seeding import digest

MODEL = Path(__file__).with_suffix(".xml")
MOUNT, GRIP = 0.86, 0.132  # m: the arm's foot over the floor with the lift down, and the grip beyond the flange
D1, A2, A3, D4, D5, D6 = 0.1625, -0.425, -0.3922, 0.1333, 0.0997, 0.0996  # m, the maker's table: six_joints.xml
TURN = math.tau
MIDDLE = (0.0, -1.5, 0.0, -1.55, 0.0, 0.0)  # rad: of the ranges in which the arm's joints are planned


class SixJoints:
    """See `remac_env.robots.body.Body`."""

    name = "six joints"
    joints = ("base_x", "base_y", "base_yaw", "lift", "pan", "shoulder", "elbow", "wrist1", "wrist2", "wrist3")
    fingers = ("jaw_a", "jaw_b")
    hands = ("hand",)
    skirt = "skirt"
    lowest = np.array([*[-np.inf] * 3, 0.0, *[-TURN] * 6])
    highest = np.array([*[np.inf] * 3, 0.34, *[TURN] * 6])
    lower = np.array([*[-9.0] * 3, 0.0, -3.1, -3.4, -3.1, -4.7, -3.1, -TURN + 0.02])
    upper = np.array([*[9.0] * 3, 0.34, 3.1, 0.4, 3.1, 1.6, 3.1, TURN - 0.02])
    speed = np.array([0.5, 0.5, 0.8, 0.2, *[1.6] * 6])
    top_speed = np.array([1.0, 1.0, 1.6, 0.4, *[math.pi] * 6])  # the maker's: 180 degrees a second
    acceleration = 2.5
    torques = (150.0, 150.0, 150.0, 28.0, 28.0, 28.0)
    finger_travel, finger_stiffness, grip_friction = 0.0425, 4000.0, 1.0
    fingertip, palm = Fingertip(beyond=0.018, half_width=0.011, thickness=0.012), 0.052
    footprint = ((-0.42, -0.23), (0.14, 0.23))
    folded = np.array([0.0, -2.35, 2.55, -1.77, -1.57, 0.0])
    via = (folded,)
    lift_tucked = 0.05
    lifts = np.array([0.02, 0.10, 0.18, 0.26, 0.33])
    arm_weights = np.array([0.0, 0.0, 0.0, 0.3, *[1.0] * 6])
    door_weights = np.array([0.15, 0.15, 0.05, 0.2, *[1.0] * 6])

    @property
    def fingerprint(self) -> str:
        """Its model and its limits."""
        return digest([MODEL.read_text("utf-8"), *(list(part) for part in (self.lower, self.upper, self.speed))])

    def tuck(self, x: float, y: float, yaw: float) -> Array:
        """See Body."""
        return np.concatenate([[x, y, yaw, self.lift_tucked], self.folded])

    def add_to(
        self, spec: Any, name: str, *, visual: bool = False, accent: tuple[float, float, float] = (0.1, 0.4, 0.8)
    ) -> None:
        """The model's text, attached under the robot's name."""
        import mujoco

        robot = mujoco.MjSpec.from_string(MODEL.read_text("utf-8"))
        robot.geom("accent").rgba = [*accent, 1.0]
        for geom in list(robot.geoms):
            if geom.group == 1 and not visual:
                robot.delete(geom)
        spec.attach(robot, prefix=f"{name}/", frame=spec.worldbody.add_frame())

    def kinematics(self, arm: str = "") -> Kinematics:
        """See Body."""
        from remac_env.robots.tracking import ModelKinematics

        class Arm(ModelKinematics):
            """The model's, and the closed form."""

            def solutions(self, position: Array, rotation: Array, base: Array, *, lifts: Array) -> Array:
                """See Kinematics."""
                found = [q for lift in lifts for q in solved(position, rotation, base, float(lift))]
                within = [q for q in found if (q >= self.body.lower).all() and (q <= self.body.upper).all()]
                return np.array(within).reshape(-1, len(self.body.joints))

        return Arm(self)


def solved(position: Array, rotation: Array, base: Array, lift: float) -> Iterator[Array]:
    """Configurations (10,) that reach a pose of the grip, each joint but the last within half a turn of its middle.

    The wrist's distance from the axis of the pan gives that joint, two ways; the hand's tilt against the arm's plane
    the last two, two ways; and the triangle of upper arm and forearm what is left, two ways.
    """
    c, s = math.cos(base[2]), math.sin(base[2])
    foot = np.array([[-c, -s, 0.0], [s, -c, 0.0], [0.0, 0.0, 1.0]])  # the arm looks backwards at zero, and is turned
    r = foot @ rotation @ np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # the jaws move along y
    flange = foot @ (position - [base[0], base[1], MOUNT + lift]) - GRIP * r[:, 2]
    wrist = flange - D6 * r[:, 2]
    across = math.hypot(wrist[0], wrist[1])
    if across < D4:
        return
    for way, tilt, bend in product((1.0, -1.0), repeat=3):
        q1 = math.atan2(wrist[1], wrist[0]) + way * math.acos(D4 / across) + 0.5 * math.pi
        ahead = np.array([math.cos(q1), math.sin(q1), 0.0])
        aside = np.array([math.sin(q1), -math.cos(q1), 0.0])
        q5 = tilt * math.acos(min(1.0, max(-1.0, float(aside @ r[:, 2]))))
        if abs(math.sin(q5)) < 1e-6:
            continue  # any turn of the last joint would do
        q6 = math.atan2(-float(aside @ r[:, 1]) / math.sin(q5), float(aside @ r[:, 0]) / math.sin(q5))
        down = -math.sin(q6) * r[:, 0] - math.cos(q6) * r[:, 1]
        along = np.cross(aside, down)
        v = wrist - D5 * down - D4 * aside - [0.0, 0.0, D1]
        x, y = float(v @ ahead), float(v[2])
        cosine = (x * x + y * y - A2 * A2 - A3 * A3) / (2.0 * A2 * A3)
        if abs(cosine) > 1.0:
            continue
        q3 = bend * math.acos(cosine)
        q2 = math.atan2(y, x) - math.atan2(A3 * math.sin(q3), A2 + A3 * math.cos(q3))
        q4 = math.atan2(float(along[2]), float(along @ ahead)) - q2 - q3
        turned = zip((q1, q2, q3, q4, q5, q6), MIDDLE, strict=True)
        arm = [middle + math.remainder(q - middle, TURN) for q, middle in turned]
        for turns in (0.0, TURN, -TURN):
            yield np.array([*base, lift, *arm[:5], arm[5] + turns])
