"""The closed form of the mobile Panda's kinematics; `remac_env.robots.tracking` has the rest.

Poses are those of the grip site in the world: position (3,) in m and rotation (3, 3). Configurations are (11,),
see :mod:`remac_env.robots.panda.measures`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from remac_env.robots.body import Body
from remac_env.robots.panda import measures as panda
from remac_env.robots.panda.measures import TORSO_HEIGHTS
from remac_env.robots.rotation import Array
from remac_env.robots.tracking import ModelKinematics

WRIST_TURNS = np.linspace(panda.LOWER[10], panda.UPPER[10], 36)
_HAND = panda.FLANGE + panda.GRIP_DEPTH


class Kinematics(ModelKinematics):
    """The body's model, and the closed form of its arm, whose first link is at ``mount_height`` (m)."""

    def __init__(self, body: Body, mount_height: float = panda.MOUNT_HEIGHT) -> None:
        super().__init__(body)
        self._mount_height = mount_height

    def solutions(self, position: Array, rotation: Array, base: Array, *, lifts: Array = TORSO_HEIGHTS) -> Array:
        """See `remac_env.robots.body.Kinematics`."""
        return solutions(position, rotation, base, torsos=lifts, mount_height=self._mount_height)


def solutions(
    position: Array, rotation: Array, base: Array, *, torsos: NDArray[np.float64] = TORSO_HEIGHTS,
    wrist_turns: NDArray[np.float64] = WRIST_TURNS, mount_height: float = panda.MOUNT_HEIGHT,
) -> Array:
    """All configurations (n, 11) within limits that reach a pose, over a grid of joint 7 and torso heights.

    ``base`` is (x, y, yaw). Closed form: with joint 7 given, the wrist centre follows; its distance from the
    shoulder gives joint 4, its direction joint 6, then 5, and the shoulder's three joints are an Euler triple.
    """
    c, s = math.cos(base[2]), math.sin(base[2])
    to_base = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    r = to_base @ rotation
    p = to_base @ np.array([position[0] - base[0], position[1] - base[1], position[2] - mount_height])
    torso, q7 = (g.ravel() for g in np.meshgrid(np.atleast_1d(torsos), np.atleast_1d(wrist_turns), indexing="ij"))
    x6, y6, z6 = _wrist_axes(r, q7)
    u = -(p - _HAND * r[:, 2] - panda.WRIST_OFFSET * x6)
    u[:, 2] += panda.SHOULDER_HEIGHT + torso
    distance = np.sqrt(np.einsum("ij,ij->i", u, u)) + 1e-12
    u = u / distance[:, None]
    cases = _elbow_and_wrist(u, distance, x6, y6)
    if cases is None:
        return np.empty((0, 11))
    index, q4, q6, sx, sy = cases
    arm = _shoulder(index, q4, q6, sx, sy, u, x6, y6, z6)
    which, q1, q2, q3, q4, q5, q6 = arm
    found = np.empty((len(which), 11))
    found[:, :3] = base
    found[:, 3] = torso[which]
    for column, values in enumerate((q1, q2, q3, q4, q5, q6, q7[which])):
        found[:, 4 + column] = values
    return found


def _wrist_axes(r: Array, q7: Array) -> tuple[Array, Array, Array]:
    """Axes (n, 3) of link 6's frame for grip rotation ``r`` in the arm's base frame and joint angles ``q7``."""
    c, s = math.cos(panda.GRIP_TURN), -math.sin(panda.GRIP_TURN)
    m0, m1, m2 = r[:, 0] * c + r[:, 1] * s, -r[:, 0] * s + r[:, 1] * c, r[:, 2]
    c7, s7 = np.cos(q7)[:, None], np.sin(q7)[:, None]
    return m0 * c7 - m1 * s7, np.broadcast_to(-m2, (len(q7), 3)), m0 * s7 + m1 * c7


def _within(q: Array, joint: int) -> NDArray[np.bool_]:
    return (q >= panda.LOWER[4 + joint]) & (q <= panda.UPPER[4 + joint])


def _wrapped(q: Array) -> Array:
    return (q + math.pi) % (2.0 * math.pi) - math.pi


def _elbow_and_wrist(
    u: Array, distance: Array, x6: Array, y6: Array
) -> tuple[NDArray[np.intp], Array, Array, Array, Array] | None:
    """Joints 4 and 6, both branches of each: (row, q4, q6, sx, sy) of the cases within limits."""
    a, d3, d5 = panda.ELBOW_OFFSET, panda.UPPER_ARM, panda.FOREARM
    k1, k2 = a * a - d5 * d3, a * (d3 + d5)
    cosine = 0.5 * (2.0 * a * a + d3 * d3 + d5 * d5 - distance**2) / math.hypot(k1, k2)
    rows = np.flatnonzero(np.abs(cosine) <= 1.0)
    if not len(rows):
        return None
    bend = np.arccos(cosine[rows])
    q4 = _wrapped(math.atan2(k2, k1) + np.concatenate([bend, -bend]))
    rows = np.concatenate([rows, rows])
    keep = _within(q4, 3)
    rows, q4 = rows[keep], q4[keep]
    c, s, length = np.cos(q4), np.sin(q4), distance[rows]
    sx, sy = (a - a * c - d3 * s) / length, (a * s - d3 * c - d5) / length
    ux, uy = np.einsum("ij,ij->i", x6[rows], u[rows]), np.einsum("ij,ij->i", y6[rows], u[rows])
    h = np.hypot(ux, uy)
    keep = (h > 1e-9) & (np.abs(sy) <= h) & (np.abs(sx) > 1e-9)
    rows, q4, sx, sy, ux, uy, h = rows[keep], q4[keep], sx[keep], sy[keep], ux[keep], uy[keep], h[keep]
    side, middle = np.arccos(sy / h), np.arctan2(ux, uy)
    q6 = _wrapped(np.concatenate([middle + side, middle - side]))
    q6 = np.where(q6 < panda.LOWER[9], q6 + 2.0 * math.pi, q6)
    twice = np.concatenate([np.arange(len(rows))] * 2)
    keep = _within(q6, 5)
    twice, q6 = twice[keep], q6[keep]
    return rows[twice], q4[twice], q6, sx[twice], sy[twice]


def _shoulder(
    rows: NDArray[np.intp], q4: Array, q6: Array, sx: Array, sy: Array, u: Array, x6: Array, y6: Array, z6: Array
) -> tuple[NDArray[np.intp], Array, Array, Array, Array, Array, Array]:
    """Joints 5 and then 1 to 3 (both branches): (row, q1, q2, q3, q4, q5, q6) within limits."""
    x, y = x6[rows], y6[rows]
    c6, s6 = np.cos(q6)[:, None], np.sin(q6)[:, None]
    x5, y4 = x * c6 - y * s6, x * s6 + y * c6
    x4 = (u[rows] - sy[:, None] * y4) / sx[:, None]
    z4 = np.cross(x4, y4)
    q5 = np.arctan2(-np.einsum("ij,ij->i", z4, x5), np.einsum("ij,ij->i", x4, x5))
    c4, s4 = np.cos(q4)[:, None], np.sin(q4)[:, None]
    r3x, r3y, r3z = x4 * c4 - y4 * s4, -z4, x4 * s4 + y4 * c4
    swing = np.hypot(r3z[:, 0], r3z[:, 1])
    parts = []
    for sign in (1.0, -1.0):
        q2 = np.arctan2(sign * swing, r3z[:, 2])
        q1 = np.arctan2(sign * r3z[:, 1], sign * r3z[:, 0])
        q3 = np.arctan2(sign * r3y[:, 2], -sign * r3x[:, 2])
        ok = _within(q5, 4) & _within(q2, 1) & _within(q1, 0) & _within(q3, 2)
        parts.append((rows[ok], q1[ok], q2[ok], q3[ok], q4[ok], q5[ok], q6[ok]))
    which, q1, q2, q3, q4, q5, q6 = (np.concatenate(column) for column in zip(*parts, strict=True))
    return which, q1, q2, q3, q4, q5, q6
