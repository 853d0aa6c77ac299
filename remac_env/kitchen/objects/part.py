"""One coloured mesh of a drawn object, and small helpers for its picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from remac_env.kitchen.mesh import Mesh
from remac_env.kitchen.style import Finish
from remac_env.kitchen.textures import Image

PICTURE_SIZE = 128
"""Pixels of the square picture on an object: enough for something that is rarely larger than 100 pixels on screen."""


@dataclass(frozen=True, eq=False)
class DrawnPart:
    """A mesh in the frame of the object's body, its finish, and a picture (rows, columns, 3) in place of its colour."""

    mesh: Mesh
    finish: Finish
    picture: Image | None = None


def glossy(red: float, green: float, blue: float, *, specular: float = 0.2, shininess: float = 0.5) -> Finish:
    """A plain finish of a colour in 0..1."""
    return Finish(color=(red, green, blue), specular=specular, shininess=shininess)


def picture(colors: NDArray[np.float64]) -> Image:
    """Colours (height, width, 3) in 0..1 as a picture."""
    return np.clip(colors * 255.0, 0, 255).astype(np.uint8)


def grid(size: int = PICTURE_SIZE) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Texture coordinates (v, u), each (size, size), of a picture's pixels."""
    v, u = np.mgrid[0:size, 0:size] / size
    return v, u


def bands(*stripes: tuple[float, tuple[float, float, float]]) -> Image:
    """A picture of stripes along v: each (start, colour), sorted by start, the first from 0."""
    v, _ = grid()
    colors = np.zeros((*v.shape, 3))
    for start, color in stripes:
        colors[v >= start] = color
    return picture(colors)
