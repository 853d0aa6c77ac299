"""Small rotation helpers on 3x3 matrices (columns are the axes of the rotated frame)."""

from __future__ import annotations

import math

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def about_x(angle: float) -> Array:
    """Rotation by ``angle`` (rad) about x."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def about_y(angle: float) -> Array:
    """Rotation by ``angle`` (rad) about y."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def about_z(angle: float) -> Array:
    """Rotation by ``angle`` (rad) about z."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def grip_frame(approach: ArrayLike, finger: ArrayLike) -> Array:
    """Orientation of the grip site: z along ``approach``, x as near to ``finger`` (opening axis) as possible."""
    z = np.asarray(approach, float)
    z = z / np.linalg.norm(z)
    x = np.asarray(finger, float)
    x = x - z * (x @ z)
    x = x / np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)


def rotation_vector(rotation: Array) -> Array:
    """Axis times angle (rad, at most pi) of a rotation matrix."""
    quat, vector = np.empty(4), np.empty(3)
    mujoco.mju_mat2Quat(quat, rotation.ravel())
    mujoco.mju_quat2Vel(vector, quat, 1.0)
    return vector


def from_rotation_vector(vector: ArrayLike) -> Array:
    """Rotation matrix of axis times angle (rad), by Rodrigues' formula."""
    v = np.asarray(vector, float)
    angle = math.sqrt(float(v @ v))
    if angle < 1e-9:
        return np.eye(3)
    x, y, z = v / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * (cross @ cross)


def quaternion(rotation: Array) -> Array:
    """Unit quaternion (w, x, y, z) of a rotation matrix."""
    quat = np.empty(4)
    mujoco.mju_mat2Quat(quat, rotation.ravel())
    return quat
