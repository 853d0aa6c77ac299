"""What actions do: each a vector in -1..1 of changes to the command, for one control period of 0.05 s."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from remac_env.backends.physics.controllers.learned.seen import Entry
from remac_env.backends.physics.manual import Manual
from remac_env.backends.physics.simulation import CONTROL_PERIOD
from remac_env.robots.body import Body
from remac_env.robots.rotation import Array, about_z, from_rotation_vector, rotation_vector

_AHEAD = 3.0  # control periods of motion by which a command may be ahead of the robot; its servos are 2 behind
_HAND_STEP, _HAND_TURN = 0.025, 0.075  # m and rad that the hand goes in a control period at most: 0.5 m/s and 1.5 rad/s
_HAND_AHEAD, _TURN_AHEAD = 0.05, 0.2  # m and rad by which the hand's commanded pose may be ahead of what joints can do
_HAND = (
    *(Entry(f"hand_{axis}", "m", -_HAND_STEP, _HAND_STEP) for axis in ("forward", "left", "up")),
    *(Entry(f"hand_turn_{axis}", "rad", -_HAND_TURN, _HAND_TURN) for axis in ("forward", "left", "up")),
)
_BASE = (("base_forward", "m"), ("base_left", "m"), ("base_turn", "rad"), ("torso", "m"))


class Control(ABC):
    """Turns actions of a robot with this body into commands.

    -1 and 1 mean the ends of the range, 0 its middle: no change, and for the fingers half open.

    Attributes:
        names: what the numbers of an action are, with units and ranges.
    """

    names: tuple[Entry, ...]

    def __init__(self, body: Body) -> None:
        self._body = body
        self._step = body.speed * CONTROL_PERIOD  # m or rad that a joint goes in a control period at most
        steps = [float(step) for step in self._step]
        self._base = tuple(Entry(name, unit, -step, step) for (name, unit), step in zip(_BASE, steps[:4], strict=True))
        self._arm = tuple(Entry(f"joint{number}", "rad", -step, step) for number, step in enumerate(steps[4:], 1))
        self._fingers = Entry("fingers", "m", 0.0, body.finger_travel)

    def begin(self, manual: Manual) -> None:
        """A new episode."""
        self._manual = manual

    def apply(self, action: NDArray[np.float32]) -> tuple[Array, float]:
        """The configuration (n,) and the finger travel (m) to command."""
        low, high = (np.array([getattr(entry, end) for entry in self.names]) for end in ("low", "high"))
        values = low + (np.clip(action, -1.0, 1.0).astype(float) + 1.0) * 0.5 * (high - low)
        q = self._moved(values)
        now = self._manual.sensing.body.q
        q = np.clip(q, now - _AHEAD * self._step, now + _AHEAD * self._step)
        q[3:] = np.clip(q[3:], self._body.lower[3:], self._body.upper[3:])
        return q, float(values[-1])

    @abstractmethod
    def _moved(self, values: Array) -> Array:
        """The command (n,) after a change."""

    def _base_moved(self, forward: float, left: float, turn: float, lift: float) -> Array:
        q = self._manual.q
        c, s = math.cos(q[2]), math.sin(q[2])
        q[:4] += [c * forward - s * left, s * forward + c * left, turn, lift]
        return q


class Joints(Control):
    """Base, torso and arm joints, and the fingers: a number for each joint, and one."""

    def __init__(self, body: Body) -> None:
        super().__init__(body)
        self.names = (*self._base, *self._arm, self._fingers)

    def action(self, before: Array, q: Array, opening: float) -> Array:
        """The action (n + 1,) that leads from set-points ``before`` (n,) to these, as near as the ranges allow."""
        c, s = math.cos(before[2]), math.sin(before[2])
        dx, dy = q[:2] - before[:2]
        change = np.concatenate([[c * dx + s * dy, c * dy - s * dx], (q - before)[2:]])
        fingers = 2.0 * opening / self._body.finger_travel - 1.0
        return np.clip(np.append(change / self._step, fingers), -1.0, 1.0)

    def _moved(self, values: Array) -> Array:
        q = self._base_moved(*values[:4])
        q[4:] += values[4:-1]
        return q


class Hand(Control):
    """The hand, along and about the axes of the base, by inverse kinematics of the arm; base, torso, fingers: 11."""

    def __init__(self, body: Body) -> None:
        super().__init__(body)
        self.names = (*_HAND, *self._base, self._fingers)
        self._arm_alone = np.array([0.0] * 4 + [1.0] * len(self._arm))

    def begin(self, manual: Manual) -> None:
        """The hand is commanded to be where it is."""
        super().begin(manual)
        self._kinematics = self._body.kinematics()
        self._pose = self._in_base(manual.q)

    def _moved(self, values: Array) -> Array:
        place, turn = self._in_base(self._manual.q)
        ahead = self._pose[0] + values[:3] - place
        ahead *= min(1.0, _HAND_AHEAD / max(1e-9, float(np.linalg.norm(ahead))))
        turned = rotation_vector(from_rotation_vector(values[3:6]) @ self._pose[1] @ turn.T)
        turned *= min(1.0, _TURN_AHEAD / max(1e-9, float(np.linalg.norm(turned))))
        self._pose = place + ahead, from_rotation_vector(turned) @ turn
        q = self._base_moved(*values[6:10])
        axes = about_z(float(q[2]))
        goal, rotation = q[[0, 1, 3]] + axes @ self._pose[0], axes @ self._pose[1]
        return self._kinematics.track(q, goal, rotation, weights=self._arm_alone, iterations=3, largest=self._step).q

    def _in_base(self, q: Array) -> tuple[Array, Array]:
        """The hand's pose at ``q`` from where the arm is mounted, along the axes of the base."""
        position, rotation = self._kinematics.forward(q)
        inward = about_z(-float(q[2]))
        return inward @ (position - q[[0, 1, 3]]), inward @ rotation
