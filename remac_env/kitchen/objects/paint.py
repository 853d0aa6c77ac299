"""Pictures on objects, painted by lists of strokes: `["band", 0.2, 0.4, "#ffffff"]`. No simulator needed.

Places are shares of the picture: u to the right, v upwards, both 0..1. On a solid of revolution u goes around and v
along the profile; on a box each side shows the whole picture.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from inspect import signature
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from remac_env.errors import KitchenFileError
from remac_env.kitchen.objects.part import PICTURE_SIZE
from remac_env.kitchen.style import hex_color
from remac_env.kitchen.textures import Image, blend, noise
from remac_env.simulator import load_opencv

Sheet = NDArray[np.float64]

_FONT_HEIGHT = 22.0  # pixels of a capital of FONT_HERSHEY_DUPLEX at scale 1 (measured with getTextSize)


def paint(ground: str, strokes: Sequence[Sequence[Any]], *, source: object, where: str) -> Image:
    """A picture (size, size, 3) of strokes over a ground colour.

    Raises:
        KitchenFileError: for an unknown stroke or one with other values than it takes.
    """
    sheet = np.empty((PICTURE_SIZE, PICTURE_SIZE, 3))
    sheet[:] = hex_color(source, f"{where}.color", ground)
    for stroke in strokes:
        name = stroke[0] if stroke else ""
        if name not in STROKES:
            raise KitchenFileError(source, f"{where}.paint", f"got {name!r}", list(STROKES))
        takes = list(signature(STROKES[name]).parameters)[1:]
        values = [
            np.array(hex_color(source, f"{where}.paint.{name}", v)) if isinstance(v, str) and v[:1] == "#" else v
            for v in stroke[1:]
        ]
        if len(values) != len(takes):
            raise KitchenFileError(source, f"{where}.paint.{name}", f"has {len(values)} values", takes)
        sheet = STROKES[name](sheet, *values)
    # Row 0 of a picture is v = 0, at the bottom; strokes are painted as a person looks at them.
    return np.clip(sheet[::-1] * 255, 0, 255).astype(np.uint8)


def _band(sheet: Sheet, low: float, high: float, color: Sheet) -> Sheet:
    return _rect(sheet, 0.0, low, 1.0, high, color)


def _rect(sheet: Sheet, left: float, low: float, right: float, high: float, color: Sheet) -> Sheet:
    size = len(sheet)
    sheet[round((1 - high) * size) : round((1 - low) * size), round(left * size) : round(right * size)] = color
    return sheet


def _disc(sheet: Sheet, u: float, v: float, across: float, up: float, color: Sheet) -> Sheet:
    rows, columns = _places(sheet)
    sheet[np.hypot((columns - u) / across, (rows - v) / up) < 1] = color
    return sheet


def _dots(sheet: Sheet, columns: int, rows: int, across: float, up: float, color: Sheet) -> Sheet:
    """Spots in rows that are shifted by half against one another; their radii are shares of their cells."""
    v, u = _places(sheet)
    shift = 0.5 * (np.floor(rows * v) % 2)
    sheet[np.hypot(((columns * u + shift) % 1 - 0.5) / across, ((rows * v) % 1 - 0.5) / up) < 1] = color
    return sheet


def _lines(sheet: Sheet, count: int, share: float, lean: float, color: Sheet) -> Sheet:
    """Stripes along v, `count` of them, each as wide as a share of its room, leaning by a share of the picture."""
    v, u = _places(sheet)
    sheet[(count * (u + lean * v)) % 1 < share] = color
    return sheet


def _fade(sheet: Sheet, low: float, high: float, color: Sheet) -> Sheet:
    """From what is there at `low` to the colour at `high` and beyond; downwards if `high` lies below `low`."""
    rows, _ = _places(sheet)
    return blend(sheet, color, np.clip((rows - low) / (high - low), 0, 1))


def _clouds(sheet: Sheet, scale: int, least: float, strength: float, seed: int, color: Sheet) -> Sheet:
    """Noise of about `scale` spots a side, over what exceeds `least` (0..1)."""
    cloud = noise(len(sheet), seed=seed, base=(scale, scale), octaves=3)
    return blend(sheet, color, np.clip((cloud - least) * strength, 0, 1))


def _text(sheet: Sheet, words: str, u: float, v: float, height: float, stretch: float, color: Sheet) -> Sheet:
    """Words around (u, v), as high as a share of the picture, widened by a factor."""
    cv2 = load_opencv()

    font, scale = cv2.FONT_HERSHEY_DUPLEX, 4 * height * len(sheet) / _FONT_HEIGHT
    (wide, tall), below = cv2.getTextSize(words, font, scale, 8)
    ink = np.zeros((tall + below + 8, wide + 8), np.uint8)
    cv2.putText(ink, words, (4, tall + 4), font, scale, 255, 8, cv2.LINE_AA)
    small = cv2.resize(ink, (max(1, round(wide * stretch / 4)), (tall + below + 8) // 4), interpolation=cv2.INTER_AREA)
    size, (rows, columns) = len(sheet), small.shape
    top, left = round((1 - v) * size - rows / 2), round(u * size - columns / 2)
    stamp = np.zeros((size + 2 * rows, size + 2 * columns))
    at_row, at_column = np.clip(top + rows, 0, size + rows), np.clip(left + columns, 0, size + columns)
    stamp[at_row : at_row + rows, at_column : at_column + columns] = small / 255
    return blend(sheet, color, stamp[rows : rows + size, columns : columns + size])


def _shape(sheet: Sheet, corners: Sequence[Sequence[float]], color: Sheet) -> Sheet:
    """A filled outline of (u, v) corners."""
    cv2, mask = load_opencv(), np.zeros(sheet.shape[:2], np.uint8)
    points = [[round(u * len(sheet)), round((1 - v) * len(sheet))] for u, v in corners]
    cv2.fillPoly(mask, [np.array(points, np.int32)], 255, cv2.LINE_AA)
    return blend(sheet, color, mask / 255)


def _places(sheet: Sheet) -> tuple[Sheet, Sheet]:
    """(v, u) of the sheet's pixels as they are painted, the top row first."""
    rows, columns = (np.mgrid[0 : len(sheet), 0 : len(sheet)] + 0.5) / len(sheet)
    return 1 - rows, columns


STROKES: Mapping[str, Callable[..., Sheet]] = MappingProxyType(
    {
        "band": _band, "rect": _rect, "disc": _disc, "dots": _dots, "lines": _lines, "fade": _fade, "clouds": _clouds,
        "text": _text, "shape": _shape,
    }
)  # fmt: skip
"""Strokes by name; their values are the parameters of the functions."""
