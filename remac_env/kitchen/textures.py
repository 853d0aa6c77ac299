"""Procedural textures: wood, stone, tiles, brick, brushed steel, plaster and the view from the window.

Pure numpy. Every texture is a square uint8 image (size, size, 3) that stands for one metre by one metre of surface
and tiles without a seam, so that a mesh whose texture coordinates are metres shows it in its true scale. Colours are
(red, green, blue) in 0..1. Each pattern draws its own random numbers from a fixed seed: the same arguments always
give the same image. Images are cached for the life of the process and read-only.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

Color = tuple[float, float, float]
Image = NDArray[np.uint8]
Floats = NDArray[np.float64]
Pattern = Callable[[int, Color, Color], Floats]


@lru_cache(maxsize=128)
def texture(pattern: str, size: int, color: Color, accent: Color) -> Image:
    """The image of a named pattern in a main colour and an accent (grain, veins, grout …).

    Raises ValueError for an unknown pattern, naming the known ones.
    """
    if pattern not in PATTERNS:
        raise ValueError(f"unknown pattern {pattern!r}; choose one of {', '.join(sorted(PATTERNS))}")
    image = np.clip(PATTERNS[pattern](size, color, accent) * 255.0, 0, 255).astype(np.uint8)
    image.flags.writeable = False
    return image


def noise(size: int, *, seed: int, base: tuple[int, int], octaves: int = 5, persistence: float = 0.5) -> Floats:
    """(size, size) fractal value noise in 0..1 that tiles; base is the (rows, columns) of the first octave."""
    generator = np.random.default_rng(seed)
    total, weight_sum, weight = np.zeros((size, size)), 0.0, 1.0
    for octave in range(octaves):
        rows, columns = base[0] * 2**octave, base[1] * 2**octave
        if octave and max(rows, columns) > size:
            break
        total += weight * _stretch(generator.random((min(rows, size), min(columns, size))), size)
        weight_sum += weight
        weight *= persistence
    return total / weight_sum


def _stretch(grid: Floats, size: int) -> Floats:
    """A (rows, columns) grid of values smoothly interpolated, and wrapped, to (size, size)."""
    rows, columns = grid.shape
    y, x = np.arange(size) * rows / size, np.arange(size) * columns / size
    top, left = y.astype(int), x.astype(int)
    fall, run = y - top, x - left
    fall, run = (fall * fall * (3 - 2 * fall))[:, None], run * run * (3 - 2 * run)
    wide = grid[:, left] * (1 - run) + grid[:, (left + 1) % columns] * run
    return wide[top] * (1 - fall) + wide[(top + 1) % rows] * fall


def blend(first: ArrayLike, second: ArrayLike, amount: Floats) -> Floats:
    """(size, size, 3): from the first colour (amount 0) to the second (amount 1)."""
    share = np.clip(amount, 0, 1)[..., None]
    return np.asarray(first) * (1 - share) + np.asarray(second) * share


def wood(size: int, color: Color, accent: Color) -> Floats:
    """Boards of one piece, the grain running up the image."""
    warp = noise(size, seed=1, base=(2, 8), octaves=4)
    grain = 0.5 + 0.5 * np.sin(2 * np.pi * (6 * _grid(size)[1] + 1.6 * warp))
    fine = noise(size, seed=2, base=(4, 96), octaves=3)
    return blend(accent, color, 0.45 * grain + 0.55 * fine) + (fine - 0.5)[..., None] * 0.08


def _grid(size: int) -> tuple[Floats, Floats]:
    rows, columns = np.mgrid[0:size, 0:size] / size
    return rows, columns


def planks(size: int, color: Color, accent: Color) -> Floats:
    """Floor boards 1/7 m wide and half a metre long, staggered, each with its own tint and piece of grain."""
    across, generator = 7, np.random.default_rng(11)
    y, x = _grid(size)
    column = (x * across).astype(int)
    along = (y + generator.random(across)[column]) % 1
    row = (along * 2).astype(int)
    tint = generator.normal(0, 0.055, (2, across))[row, column]
    shift = (generator.random((2, across)) * size).astype(int)[row, column]
    boards = wood(size, color, accent)[((along * size).astype(int) + shift) % size, (x * size).astype(int)]
    side, end = (x * across) % 1, (along * 2) % 1
    gap = np.clip(1 - np.minimum(side, 1 - side) / 0.03, 0, 1) + np.clip(1 - np.minimum(end, 1 - end) / 0.008, 0, 1)
    return (boards + tint[..., None]) * (1 - 0.55 * np.clip(gap, 0, 1))[..., None]


def marble(size: int, color: Color, accent: Color) -> Floats:
    """Polished stone with broad veins in the accent colour and finer ones across."""
    broad, thin = noise(size, seed=3, base=(3, 3), octaves=6), noise(size, seed=12, base=(3, 3), octaves=6)
    veins = 0.75 * np.clip(1 - np.abs(broad - 0.5) * 9 - 0.35 * thin, 0, 1) ** 1.5
    veins = veins + 0.3 * np.clip(1 - np.abs(thin - 0.5) * 14, 0, 1) ** 2
    return blend(color, accent, veins) + (noise(size, seed=7, base=(16, 16), octaves=3) - 0.5)[..., None] * 0.05


def granite(size: int, color: Color, accent: Color) -> Floats:
    """Speckled stone: grains between the colour and the accent."""
    coarse = noise(size, seed=6, base=(24, 24), octaves=2)
    fine = noise(size, seed=5, base=(64, 64), octaves=2, persistence=0.8)
    return blend(color, accent, 0.5 + 1.6 * (fine - 0.5) + 0.6 * (coarse - 0.5))


def concrete(size: int, color: Color, accent: Color) -> Floats:
    """Cast concrete: broad clouds, fine grain and a few pores in the accent colour."""
    clouds = noise(size, seed=31, base=(3, 3), octaves=6, persistence=0.6)
    pores = np.clip((noise(size, seed=32, base=(60, 60), octaves=2) - 0.78) * 9, 0, 1)
    return blend(color, accent, np.clip((clouds - 0.45) * 1.1, 0, 0.6) + 0.5 * pores)


def tiles(size: int, color: Color, accent: Color) -> Floats:
    """Square floor tiles, three to the metre, with grout in the accent colour."""
    return _laid(size, color, accent, across=3, rows=3, joint=0.005, shift=0, tint=0.027, clouds=0.10)


def _laid(
    size: int,
    color: Color,
    grout: Color,
    *,
    across: int,
    rows: int,
    joint: float,
    shift: float,
    tint: float,
    clouds: float,
) -> Floats:
    """Tiles in rows with joints of width `joint` (m), every other row shifted by a share of a tile."""
    y, x = _grid(size)
    row = (y * rows).astype(int)
    place = x * across + (row % 2) * shift
    u, v = place % 1, (y * rows) % 1
    tints = np.random.default_rng(7).normal(0, tint, (rows, across))[row, np.floor(place).astype(int) % across]
    face = np.asarray(color) + tints[..., None] + (noise(size, seed=8, base=(6, 6)) - 0.5)[..., None] * clouds
    edge = np.minimum(np.minimum(u, 1 - u) / across, np.minimum(v, 1 - v) / rows) / joint
    rim = np.clip(1 - np.abs(edge - 1.1) / 0.6, 0, 1)[..., None]
    face = face + rim * np.where(v < u, 0.045, -0.035)[..., None]
    return blend(face, grout, (0.9 - edge) / 0.4)


def checker(size: int, color: Color, accent: Color) -> Floats:
    """Square floor tiles, four to the metre, in two colours like a chess board."""
    y, x = _grid(size)
    second = ((x * 4).astype(int) + (y * 4).astype(int)) % 2
    dull = tuple(0.6 * a + 0.4 * b for a, b in zip(color, accent, strict=True))
    plain = _laid(size, (0, 0, 0), (0, 0, 0), across=4, rows=4, joint=0.003, shift=0, tint=0.012, clouds=0.05)
    edge = np.minimum((x * 4) % 1, (y * 4) % 1)
    return blend(blend(color, accent, second.astype(float)) + plain, dull, (edge < 0.02).astype(float))


def subway(size: int, color: Color, accent: Color) -> Floats:
    """Glazed wall tiles, 1/6 m by 1/12 m in running bond, with grout in the accent colour."""
    return _laid(size, color, accent, across=6, rows=12, joint=0.0035, shift=0.5, tint=0.014, clouds=0.06)


def mosaic(size: int, color: Color, accent: Color) -> Floats:
    """Small square glazed tiles, twelve to the metre, each of its own shade."""
    return _laid(size, color, accent, across=12, rows=12, joint=0.0035, shift=0, tint=0.05, clouds=0.05)


def brick(size: int, color: Color, accent: Color) -> Floats:
    """Bricks, 1/4 m by 1/12 m in running bond, rough, with mortar in the accent colour."""
    rough = (noise(size, seed=41, base=(40, 40), octaves=3) - 0.5)[..., None] * 0.16
    return _laid(size, color, accent, across=4, rows=12, joint=0.006, shift=0.5, tint=0.045, clouds=0.12) + rough


def panelling(size: int, color: Color, accent: Color) -> Floats:
    """Painted boards standing side by side, ten to the metre, the grooves in the accent colour."""
    u = (_grid(size)[1] * 10) % 1
    groove = np.clip(1 - np.minimum(u, 1 - u) / 0.05, 0, 1)
    return blend(color, accent, groove) + (noise(size, seed=51, base=(4, 32), octaves=3) - 0.5)[..., None] * 0.02


def brushed(size: int, color: Color, accent: Color) -> Floats:
    """Brushed metal: faint horizontal streaks between the two colours."""
    return blend(accent, color, 0.5 + 0.9 * (noise(size, seed=13, base=(64, 2), octaves=3, persistence=0.8) - 0.5))


def plaster(size: int, color: Color, accent: Color) -> Floats:
    """A painted wall with a barely visible unevenness towards the accent colour."""
    return blend(color, accent, 0.5 * noise(size, seed=15, base=(6, 6)))


def view(size: int, color: Color, accent: Color) -> Floats:
    """What is seen through a window: a sky of the main colour with clouds, above hills of the accent colour."""
    y, x = _grid(size)
    sky = blend(color, (0.88, 0.93, 0.97), y * 1.3)
    clouds = np.clip((noise(size, seed=21, base=(3, 3)) - 0.5) * 4, 0, 1) * (1 - y)
    sky = blend(sky, (1.0, 1.0, 1.0), clouds)
    hills = 0.72 + 0.06 * np.sin(2 * np.pi * x) + 0.03 * np.sin(6 * np.pi * x + 1)
    bright = tuple(min(1.0, 1.35 * part) for part in accent)
    return np.where((y > hills)[..., None], blend(accent, bright, noise(size, seed=22, base=(8, 8))), sky)


PATTERNS: Mapping[str, Pattern] = MappingProxyType(
    {
        "wood": wood, "planks": planks, "marble": marble, "granite": granite, "concrete": concrete, "tiles": tiles,
        "checker": checker, "subway": subway, "mosaic": mosaic, "brick": brick, "panelling": panelling,
        "brushed": brushed, "plaster": plaster, "view": view,
    }
)  # fmt: skip
