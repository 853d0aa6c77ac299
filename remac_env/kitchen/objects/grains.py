"""Grains of seasoning on an object, seen only while it has been seasoned, and stains: one drawn mesh each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from remac_env.kitchen.mesh import Floats, Mesh, merge
from remac_env.kitchen.objects.part import DrawnPart
from remac_env.kitchen.style import Finish
from remac_env.seeding import generator

SEASONED_GEOM = "/seasoned"
"""After an object's name, in the name of the geom of its grains."""

STAINED_GEOM = "/stained"
"""The same of the geom of its stains."""

STAIN = Finish(color=(0.34, 0.19, 0.07), specular=0.3, shininess=0.4)
"""Dried sauce."""

_PEPPER = Finish(color=(0.10, 0.07, 0.05), specular=0.1, shininess=0.2)
_SALT = Finish(color=(0.97, 0.95, 0.88), specular=0.1, shininess=0.2)
_PALE = 0.35  # mean brightness of an object, 0..1, from which on pepper stands out better than salt

_COUNT = 110
_SIZE = (0.0025, 0.0055)  # m, half a flake: large enough to be recognised in a picture of 128 pixels
_STAINS, _STAIN_SIZE = 26, (0.008, 0.016)  # the same of stains
_CORNERS = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(3.0)
_SIDES = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])


def finish(parts: Sequence[DrawnPart]) -> Finish:
    """Pepper or salt, whichever stands out on an object."""
    means = [
        np.mean(part.finish.color) if part.picture is None else np.mean(part.picture) / 255.0 for part in parts
    ]
    weights = [len(part.mesh.faces) for part in parts]
    return _PEPPER if np.average(means, weights=weights) > _PALE else _SALT


def grains(name: str, parts: Sequence[DrawnPart]) -> Mesh:
    """Grains scattered over the surface of an object (frame of its body); ``name`` seeds the draw.

    They lie on all sides, as nobody knows which side will be up.
    """
    return _scattered(parts, generator(0, "grains", name), _COUNT, _SIZE)


def stains(name: str, parts: Sequence[DrawnPart]) -> Mesh:
    """Stains scattered likewise: larger, and of one colour, so that nobody takes them for pepper."""
    return _scattered(parts, generator(0, "stains", name), _STAINS, _STAIN_SIZE)


def _scattered(
    parts: Sequence[DrawnPart], chance: np.random.Generator, count: int, size: tuple[float, float]
) -> Mesh:
    whole = merge(*(Mesh(part.mesh.vertices, part.mesh.faces) for part in parts))
    corners = whole.vertices[whole.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    picks = chance.choice(len(areas), count, p=areas / areas.sum())
    shares = chance.dirichlet((1.0, 1.0, 1.0), count)
    places: Floats = np.einsum("nk,nkj->nj", shares, corners[picks])
    sizes = chance.uniform(*size, count)
    return merge(*(Mesh(place + half * _CORNERS, _SIDES) for place, half in zip(places, sizes, strict=True)))
