"""Motion primitives: generators that yield a command for each control period (0.05 s)."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Generator, Sequence

import numpy as np

from remac_env.backends.physics.controllers.base import Command
from remac_env.backends.physics.controllers.scripted.robot import Robot
from remac_env.backends.physics.simulation import CONTROL_PERIOD
from remac_env.robots.body import Body
from remac_env.robots.rotation import Array

Steps = Generator[Command, None, None]

LAG_LIMIT = 0.08  # rad or m by which a joint may miss all of the latest commands
LAG_PERIODS = 6  # the servos follow 0.1 s late at steady speed, and later while they accelerate
SERVO_LAG = 2  # periods by which the servos follow late at steady speed (damping over stiffness: 0.1 s)
LAG_PATIENCE = 12  # control periods


def periods_between(start: Array, corner: Array, body: Body, speed: float = 1.0) -> int:
    """Control periods in which a motion from ``start`` to ``corner`` keeps to ``speed`` (share of the usual speeds).

    The motion is a smooth step, whose greatest speed is 1.5 and greatest acceleration 6 times its mean: the base, which
    is heavy, keeps to an acceleration too.
    """
    change = np.abs(corner - start)
    longest = 1.5 * float(np.max(change / (body.speed * speed)))
    pull = math.sqrt(6.0 * float(np.hypot(change[0], change[1])) / body.acceleration)
    return int(np.ceil(max(longest, pull) / CONTROL_PERIOD))


def smooth(count: int) -> Array:
    """Shares (count,) of a way that starts and ends at rest, after each of so many control periods."""
    u = np.arange(1, count + 1) / max(1, count)
    return np.asarray(u * u * (3 - 2 * u))


class StuckError(Exception):
    """The robot has been held off its command for too long; caught by the skill runner, never by users."""


class Mover:
    """Plays back motions on one robot and watches that it follows."""

    def __init__(self, robot: Robot) -> None:
        self.robot, self._kinematics = robot, robot.kinematics
        self._late = 0
        self._commands: deque[Array] = deque(maxlen=LAG_PERIODS)

    def step(self, q: Array) -> Steps:
        """Command ``q`` for one period. Raises StuckError when the robot has long been held off its command."""
        self.robot.q = np.array(q, float)
        yield self.robot.command
        self._commands.append(self.robot.q)
        now = self.robot.measured
        lag = max(np.abs(self.robot.q - now).tolist())
        if lag > LAG_LIMIT:
            recent = np.array(self._commands)
            lag = float(np.maximum(recent.min(axis=0) - now, now - recent.max(axis=0)).max())
        self._late = self._late + 1 if lag > LAG_LIMIT else 0
        if self._late > LAG_PATIENCE:
            self._late = 0
            raise StuckError(f"the robot is {lag:.2f} off its command")

    def deflection(self) -> Array:
        """How far (3,) forces hold the hand off its way (m): off where the command of two periods ago would have it."""
        if len(self._commands) < LAG_PERIODS:
            return np.zeros(3)
        wanted, _ = self._kinematics.forward(self._commands[-1 - SERVO_LAG])
        return np.asarray(self.robot.grip_pose().position - wanted)

    def go(self, corners: Sequence[Array], speed: float = 1.0) -> Steps:
        """Through joint way points, slowing down at each; ``speed`` scales the usual speeds."""
        for corner in corners:
            start = self.robot.q.copy()
            count = max(2, periods_between(start, corner, self.robot.body, speed))
            for share in smooth(count):
                yield from self.step(start + share * (corner - start))
        yield from self.settle(0.004, 8)

    def play(self, path: Sequence[Array]) -> Steps:
        """One configuration per period, then wait until the hand has caught up."""
        for q in path:
            yield from self.step(q)
        yield from self.settle()

    def settle(self, tolerance: float = 0.003, most: int = 12) -> Steps:
        """Hold until the hand is within ``tolerance`` (m) of its command, at most ``most`` periods."""
        for _ in range(most):
            yield from self.step(self.robot.q)
            wanted, _ = self._kinematics.forward(self.robot.q)
            if np.linalg.norm(wanted - self.robot.grip_pose().position) < tolerance:
                return

    def grasp(self, force: float | None) -> Steps:
        """Close the hand; once it has closed ease off to ``force`` (N a finger), or, where None, hold on hard."""
        yield from self.fingers(0.0, 11)
        if force is not None and self.robot.opening > 2 * force / self.robot.body.finger_stiffness:
            yield from self.fingers(self.squeezed(force), 2)

    def squeezed(self, force: float) -> float:
        """The finger opening to command (m) so that each finger presses with ``force`` (N) on what it touches."""
        return max(0.0, 0.5 * self.robot.opening - force / self.robot.body.finger_stiffness)

    def fingers(self, opening: float, periods: int) -> Steps:
        """Move each finger to ``opening`` (m) from the middle and wait, ``periods`` in all."""
        start, ramp = self.robot.grip, max(1, periods - 3)
        for k in range(1, periods + 1):
            # A finger that snaps shut would pass through the thin wall of a cup within one step.
            self.robot.grip = start + min(1.0, k / ramp) * (opening - start)
            yield from self.step(self.robot.q)
