"""Where a policy wants its hand: told beside the joints, as errors of an arm's joints add up at the hand.

Nine numbers in the frame of the stand: the position, m, and the first and last column of the rotation of the grip.
"""

from __future__ import annotations

import math

import numpy as np

from remac_env.backends.physics.controllers.learned.network import Numbers, commanded
from remac_env.backends.physics.controllers.learned.stand import Stand
from remac_env.robots.body import Body, Kinematics
from remac_env.robots.rotation import Array

_LARGEST = 0.15  # rad by which the arm leaves what the joints were told to be
_AHEAD = 0.5 * math.pi  # rad: a robot that faces the wall of its stand heads along y there


def hands(commands: Numbers, body: Body) -> Numbers:
    """The hands (n, HAND) of commands (n, commanded(body)), all told from the stand."""
    kinematics = body.kinematics()
    return np.array([_hand_at(kinematics, command[:-1]) for command in commands], np.float32)


def _hand_at(kinematics: Kinematics, q: Array) -> Array:
    turned = np.array(q, float)
    turned[2] += _AHEAD
    position, rotation = kinematics.forward(turned)
    return np.concatenate([position, rotation[:, 0], rotation[:, 2]])


def towards_hand(kinematics: Kinematics, stand: Stand, q: Array, hand: Array, command: Array) -> Array:
    """The configuration (n,) near ``q`` in which the hand is where a command wants it; ``hand``: where it is now."""
    way, opening, approach = np.split(command[commanded(kinematics.body) :], 3)
    if (length := float(np.linalg.norm(approach))) < _SHORT:
        return q
    last = approach / length
    first = opening - last * float(opening @ last)
    if (length := float(np.linalg.norm(first))) < _SHORT:
        return q
    first /= length
    rotation = stand.axes @ np.stack([first, np.cross(last, first), last], axis=1)
    goal, largest = hand + stand.axes @ way, np.full(len(q), _LARGEST)
    arm_alone = np.array([0.0] * 4 + [1.0] * (len(q) - 4))  # base and lift go where they are told
    return kinematics.track(q, goal, rotation, weights=arm_alone, iterations=3, largest=largest).q


_SHORT = 1e-3  # of an axis: it says no direction
