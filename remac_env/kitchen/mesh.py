"""Triangle meshes as values: joining, moving and turning them, and handing them to the simulator.

Pure numpy; only `add_mesh` touches the simulator. Lengths are metres, angles radians, right-handed frames with z up.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    import mujoco

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Mesh:
    """A triangle mesh.

    vertices: (n, 3) m. faces: (m, 3) indices. uv: (n, 2) or None. normals: (n, 3) unit vectors, or None to let the
    renderer compute them. Raises ValueError when the shapes do not fit together.
    """

    vertices: Floats
    faces: Ints
    uv: Floats | None = None
    normals: Floats | None = None

    def __post_init__(self) -> None:
        count = len(self.vertices)
        if self.vertices.shape != (count, 3) or count == 0:
            raise ValueError(f"vertices must have shape (n, 3), got {self.vertices.shape}")
        if self.faces.ndim != 2 or self.faces.shape[1] != 3 or len(self.faces) == 0:
            raise ValueError(f"faces must have shape (m, 3), got {self.faces.shape}")
        if self.faces.min() < 0 or self.faces.max() >= count:
            raise ValueError(f"faces must index the {count} vertices, got {self.faces.min()}..{self.faces.max()}")
        if self.uv is not None and self.uv.shape != (count, 2):
            raise ValueError(f"uv must have shape ({count}, 2), got {self.uv.shape}")
        if self.normals is not None and self.normals.shape != (count, 3):
            raise ValueError(f"normals must have shape ({count}, 3), got {self.normals.shape}")

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lowest and highest corner of the axis-aligned box around the mesh, each (3,) m."""
        return self.vertices.min(axis=0), self.vertices.max(axis=0)


def merge(*parts: Mesh) -> Mesh:
    """One mesh of several. uv is kept where all parts have it, else dropped; likewise normals."""
    if not parts:
        raise ValueError("merge needs at least one mesh")
    starts = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])])
    uvs = [part.uv for part in parts if part.uv is not None]
    normals = [part.normals for part in parts if part.normals is not None]
    return Mesh(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.faces + start for part, start in zip(parts, starts, strict=True)]),
        np.concatenate(uvs) if len(uvs) == len(parts) else None,
        np.concatenate(normals) if len(normals) == len(parts) else None,
    )


def transform(
    mesh: Mesh,
    *,
    position: ArrayLike = (0.0, 0.0, 0.0),
    scale: ArrayLike = 1.0,
    rotation: ArrayLike | None = None,
) -> Mesh:
    """Scale about the origin, then rotate by a (3, 3) matrix, then move. Mirroring is refused (it would turn faces)."""
    factors = np.broadcast_to(np.asarray(scale, dtype=float), (3,))
    if factors.min() <= 0:
        raise ValueError(f"scale must be positive, got {scale!r}")
    matrix = np.eye(3) if rotation is None else np.asarray(rotation, dtype=float)
    normals = mesh.normals
    if normals is not None:
        normals = normals / factors
        normals = (normals / np.linalg.norm(normals, axis=1, keepdims=True)) @ matrix.T
    vertices = (mesh.vertices * factors) @ matrix.T + np.asarray(position, dtype=float)
    return Mesh(vertices, mesh.faces, mesh.uv, normals)


def rotation(axis: ArrayLike, angle: float) -> Floats:
    """(3, 3) matrix of the right-handed rotation by `angle` (rad) about `axis`."""
    x, y, z = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def add_mesh(spec: mujoco.MjSpec, name: str, mesh: Mesh) -> None:
    """Put the mesh into an MjSpec under `name`. Its inertia is that of a thin shell, which also flat meshes have."""
    import mujoco

    added = spec.add_mesh(
        name=name,
        uservert=mesh.vertices.astype(np.float32).ravel(),
        userface=mesh.faces.astype(np.int32).ravel(),
        inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
    )
    if mesh.uv is not None:
        added.usertexcoord = mesh.uv.astype(np.float32).ravel()
    if mesh.normals is not None:
        added.usernormal = mesh.normals.astype(np.float32).ravel()
