"""The robot as data: a Franka Panda on a lifting holonomic base. Importable without MuJoCo.

Joint limits and the Denavit-Hartenberg offsets are the manufacturer's published ones; link masses are those of the
identified model of Gaz et al. (RA-L 2019). Lengths in m, angles in rad, masses in kg, forces in N or N m.
A configuration ``q`` is a vector of 11: base x, base y, base yaw, torso lift, arm joints 1 to 7. The base
turns about the vertical axis of the arm's first link, so ``q[:2]`` is where that axis stands.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from remac_env.robots.body import Fingertip

JOINTS = ("base_x", "base_y", "base_yaw", "torso", *(f"joint{i}" for i in range(1, 8)))
FINGERS = ("finger_left", "finger_right")

# Offsets of the arm (Denavit-Hartenberg, modified convention).
SHOULDER_HEIGHT = 0.333  # d1
UPPER_ARM = 0.316  # d3
ELBOW_OFFSET = 0.0825  # a4 = -a5
FOREARM = 0.384  # d5
WRIST_OFFSET = 0.088  # a7
FLANGE = 0.1065  # link 7 frame to the hand's frame
GRIP_DEPTH = 0.097  # hand frame to the grip site, between the fingertip pads
HAND_TURN = -0.25 * math.pi  # the hand sits on the flange turned by -45 degrees
GRIP_TURN = -0.75 * math.pi  # grip site (x along the opening) from the link 7 frame, about z

MOUNT_HEIGHT = 0.70  # first arm link above the floor with the torso down
TORSO_RANGE = (0.0, 0.34)
FINGER_OPEN = 0.04  # travel of each finger
FINGERTIP = Fingertip(beyond=0.0164, half_width=0.0095, thickness=0.010)
PALM = 0.032  # from the grip site

ARM_LOWER = np.array([-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973])
ARM_UPPER = np.array([2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973])
LIMIT_MARGIN = 0.02  # planned configurations keep this far from the arm's limits
LOWER = np.concatenate([[-9.0, -9.0, -9.0, TORSO_RANGE[0]], ARM_LOWER + LIMIT_MARGIN])
UPPER = np.concatenate([[9.0, 9.0, 9.0, TORSO_RANGE[1]], ARM_UPPER - LIMIT_MARGIN])
# Speeds used by the controllers (m/s, rad/s); the arm's own limits are 2.175 and 2.61 rad/s.
SPEED = np.array([0.5, 0.5, 0.8, 0.2, *[1.6] * 7])
# How fast set-points move at most: the arm's own limits (Franka Emika, FCI documentation); base and torso as assumed.
TOP_SPEED = np.array([1.0, 1.0, 1.6, 0.4, *[2.175] * 4, *[2.61] * 3])
# Where set-points are at most: the manufacturer's limits of arm and torso; a base stands anywhere and goes round.
LOWEST = np.concatenate([[-np.inf] * 3, [TORSO_RANGE[0]], ARM_LOWER])
HIGHEST = np.concatenate([[np.inf] * 3, [TORSO_RANGE[1]], ARM_UPPER])

# Position servos: stiffness, damping, largest force.
ARM_STIFFNESS = (4500.0, 4500.0, 3500.0, 3500.0, 2000.0, 2000.0, 2000.0)
ARM_DAMPING = (450.0, 450.0, 350.0, 350.0, 200.0, 200.0, 200.0)
# N m, the manufacturer's largest torques (Franka Emika, Panda datasheet and FCI documentation), gravity included.
ARM_FORCE = (87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0)
# N, of each finger: what the hand's manufacturer allows continuously (70 N; up to 140 N for a moment).
FINGER_FORCE = 70.0
FINGER_STIFFNESS = 4000.0  # N/m
# N along each axis: together no more than wheels with a friction of 0.5 give the robot's 105 kg on a floor.
BASE_FORCE = 350.0
BASE_ACCELERATION = 2.5  # m/s2 in drives, which the base can follow with that force

# Postures of the arm (7 joints).
HOME_ARM = np.array([0.0, -0.35, 0.0, -2.3, 0.0, 1.95, math.pi / 4])
TUCK_ARM = np.array([0.0, -1.5, 0.0, -2.8, 0.0, 2.6, math.pi / 4])  # fingertips 0.28 ahead of the arm axis
TUCK_TORSO = 0.05

ARM_WEIGHTS = np.array([0.0, 0.0, 0.0, 0.3, *[1.0] * 7])  # arm and a little torso
DOOR_WEIGHTS = np.array([0.15, 0.15, 0.05, 0.2, *[1.0] * 7])  # the base helps, slowly
TORSO_HEIGHTS = np.array([0.02, 0.10, 0.18, 0.26, 0.33])

PAD_FRICTION = 1.0

SKIRT = "skirt"
"""The lowest part of the base, 5 to 30 mm over the floor, which pushes away what lies there."""


@dataclass(frozen=True)
class Link:
    """One arm link: its frame in the frame before it, its mass and its fitted collision capsule."""

    name: str
    position: tuple[float, float, float]
    turn_x: float  # rotation about x before the joint (rad)
    mass: float
    capsule: tuple[float, float, float, float, float, float, float]  # two ends, radius

_Q = 0.5 * math.pi
LINK0 = Link("link0", (0.0, 0.0, 0.0), 0.0, 0.629769, (-0.0596, -0.0063, 0.0157, -0.0035, 0.0075, 0.0545, 0.1065))
LINKS = (
    Link("link1", (0.0, 0.0, SHOULDER_HEIGHT), 0.0, 4.970684,
         (0.0, -0.0532, 0.0001, 0.0059, -0.0006, -0.1463, 0.0762)),
    Link("link2", (0.0, 0.0, 0.0), -_Q, 0.646926, (0.0, -0.1413, 0.0002, -0.0004, 0.0002, 0.0531, 0.0765)),
    Link("link3", (0.0, -UPPER_ARM, 0.0), _Q, 3.228604,
         (0.0839, 0.0434, 0.0016, 0.0026, 0.0011, -0.0832, 0.0693)),
    Link("link4", (ELBOW_OFFSET, 0.0, 0.0), _Q, 3.587895,
         (0.0016, -0.0015, 0.0433, -0.0818, 0.0833, 0.0004, 0.0693)),
    Link("link5", (-ELBOW_OFFSET, FOREARM, 0.0), -_Q, 1.225946,
         (0.0002, 0.0638, 0.0025, -0.0014, 0.0106, -0.2441, 0.0675)),
    Link("link6", (0.0, 0.0, 0.0), _Q, 1.666555, (0.022, 0.0053, 0.0018, 0.0881, 0.0091, 0.0004, 0.075)),
    Link("link7", (WRIST_OFFSET, 0.0, 0.0), _Q, 0.735522,
         (-0.0051, -0.0051, 0.0731, 0.0329, 0.0328, 0.082, 0.0493)),
)
HAND_MASS = 0.73
FINGER_MASS = 0.1
BASE_MASS = 60.0
TORSO_MASS = 8.0

# Neighbours whose capsules always overlap.
ALWAYS_NEAR = (
    ("link0", "link2"), ("link1", "link3"), ("link2", "link4"), ("link3", "link5"), ("link4", "link6"),
    ("link5", "link7"), ("link6", "hand"), ("link7", "hand"), ("link1", "link4"), ("link0", "base"),
    ("link1", "lift"), ("link0", "lift"), ("lift", "base"), ("link1", "base"),
    ("finger_left", "finger_right"),
)


def tucked(x: float, y: float, yaw: float, torso: float = TUCK_TORSO) -> np.ndarray:
    """The configuration (11,) with the arm folded and its axis at ``x``, ``y`` (m), heading ``yaw`` (rad)."""
    return np.concatenate([[x, y, yaw, torso], TUCK_ARM])
