"""Where a policy wants its hand: told beside the joints, as errors of seven joints add up at the hand.

Nine numbers in the frame of the stand: the position, m, and the first and last column of the rotation of the grip.
"""

from __future__ import annotations

import math

import numpy as np

from remac_env.backends.physics.controllers.learned.network import COMMANDED, Numbers
from remac_env.backends.physics.controllers.learned.stand import Stand
from remac_env.robots import bodies
from remac_env.robots.body import Kinematics
from remac_env.robots.rotation import Array

_BODY = bodies.get()
_ARM_ALONE = np.array([0.0] * 4 + [1.0] * 7)  # base and lift go where they are told
_LARGEST = np.full(11, 0.15)  # rad by which the arm leaves what the joints were told to be
_AHEAD = 0.5 * math.pi  # rad: a robot that faces the wall of its stand heads along y there


def hands(commands: Numbers) -> Numbers:
    """The hands (n, 9) of commands (n, COMMANDED), all told from the stand."""
    kinematics = _BODY.kinematics()
    return np.array([_hand_at(kinematics, command[:-1]) for command in commands], np.float32)


def _hand_at(kinematics: Kinematics, q: Array) -> Array:
    turned = np.array(q, float)
    turned[2] += _AHEAD
    position, rotation = kinematics.forward(turned)
    return np.concatenate([position, rotation[:, 0], rotation[:, 2]])


def towards_hand(kinematics: Kinematics, stand: Stand, q: Array, hand: Array, command: Array) -> Array:
    """The configuration (n,) near ``q`` in which the hand is where a command wants it; ``hand``: where it is now."""
    way, opening, approach = np.split(command[COMMANDED:], 3)
    if (length := float(np.linalg.norm(approach))) < _SHORT:
        return q
    last = approach / length
    first = opening - last * float(opening @ last)
    if (length := float(np.linalg.norm(first))) < _SHORT:
        return q
    first /= length
    rotation = stand.axes @ np.stack([first, np.cross(last, first), last], axis=1)
    goal = hand + stand.axes @ way
    return kinematics.track(q, goal, rotation, weights=_ARM_ALONE, iterations=3, largest=_LARGEST).q


_SHORT = 1e-3  # of an axis: it says no direction
