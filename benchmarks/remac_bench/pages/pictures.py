"""A table as a picture for papers: SVG from a template, PNG from the same layout through OpenCV."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from remac_bench.board import Cell, Sheet
from remac_bench.console import plain
from remac_bench.errors import StorageError
from remac_bench.pages.rendering import render
from remac_env.errors import RenderingError
from remac_env.simulator import load_opencv

_log = logging.getLogger(__name__)

LETTER, LINE, GAP, MARGIN = 8.2, 26.0, 22.0, 20.0
"""Width of a letter at 14 pixels, heights of a line, room between columns and around, in pixels."""

SCALE = 2.0
"""Pixels of the PNG for one of the SVG: sharp in print."""

SIDE_MAX = 16_000
"""Pixels of the longest side of a PNG; a larger table is drawn smaller."""

_WORD_MAX = 60
_DASH = Cell(text="-")


@dataclass(frozen=True, kw_only=True)
class Word:
    """Text at a place: `x` is its left end, or its right end with `right`; `y` is its base line."""

    text: str
    x: float
    y: float
    right: bool = False
    bold: bool = False


@dataclass(frozen=True, kw_only=True)
class Drawing:
    """Words, and the heights of horizontal lines, in a box."""

    title: str
    width: float
    height: float
    words: tuple[Word, ...]
    lines: tuple[float, ...]
    margin: float = MARGIN


def lay_out(sheet: Sheet) -> Drawing:
    """A sheet with the columns that hold something, in the style of printed tables: three rules and no others."""
    columns = [column for column in sheet.columns if any(column.key in row for row in sheet.rows)]
    texts = [[_short(row.get(column.key, _DASH).text) for column in columns] for row in sheet.rows]
    longest = [max(len(column.title), *(len(line[at]) for line in texts), 1) for at, column in enumerate(columns)]
    widths = [LETTER * letters for letters in longest]
    lefts = [MARGIN + sum(widths[:index]) + GAP * index for index in range(len(columns))]
    title = _short(sheet.title, 110)
    width = max(MARGIN + sum(widths) + GAP * max(0, len(columns) - 1), MARGIN + LETTER * len(title)) + MARGIN
    head = MARGIN + LINE * 2
    words = [Word(text=title, x=MARGIN, y=MARGIN + 14, bold=True)]
    for index, column in enumerate(columns):
        at = lefts[index] + (widths[index] if column.numeric else 0.0)
        words.append(Word(text=column.title, x=at, y=head, right=column.numeric, bold=True))
        words += [
            Word(text=line[index], x=at, y=head + 10 + LINE * (number + 0.75), right=column.numeric)
            for number, line in enumerate(texts)
        ]
    end = head + 14 + LINE * len(texts)
    rules = (head - LINE + 6, head + 9, end)
    return Drawing(title=title, width=width, height=end + MARGIN, words=tuple(words), lines=rules)


def write_pictures(sheets: Sequence[Sheet], folder: Path) -> None:
    """Write folder/<key>.svg and .png for each sheet; without OpenCV the former alone, and say so in the log."""
    folder.mkdir(parents=True, exist_ok=True)
    for sheet in sheets:
        (folder / f"{sheet.key}.svg").write_text(svg(sheet), "utf-8", errors="replace")
    try:
        load_opencv()
    except RenderingError as error:
        _log.warning("tables are written as SVG alone: %s", error)
        return
    for sheet in sheets:
        (folder / f"{sheet.key}.png").write_bytes(png(sheet))


def svg(sheet: Sheet) -> str:
    """A sheet as a drawing."""
    return render("table.svg", drawing=lay_out(sheet))


def png(sheet: Sheet) -> bytes:
    """A sheet as a picture file; StorageError where OpenCV cannot make one."""
    cv2 = load_opencv()
    done, data = cv2.imencode(".png", paint(lay_out(sheet)))
    if not done:
        raise StorageError(f"{sheet.key}.png: OpenCV cannot encode a PNG here")
    return bytes(data)


def paint(drawing: Drawing) -> NDArray[np.uint8]:
    """The drawing as pixels, uint8 (height, width, 3), black on white."""
    cv2 = load_opencv()
    scale = min(SCALE, SIDE_MAX / max(drawing.width, drawing.height))
    size = (int(drawing.height * scale), int(drawing.width * scale), 3)
    picture = np.full(size, 255, np.uint8)
    for y in drawing.lines:
        ends = (int(drawing.margin * scale), int((drawing.width - drawing.margin) * scale))
        cv2.line(picture, (ends[0], int(y * scale)), (ends[1], int(y * scale)), (40, 40, 40), 1)
    for word in drawing.words:
        _put(picture, word, scale)
    return picture


def _put(picture: NDArray[np.uint8], word: Word, scale: float) -> None:
    """OpenCV 5 sets type; OpenCV 4 has only letters of strokes, and only ASCII."""
    cv2 = load_opencv()
    size, spot, ink = max(6, int(14 * scale)), (int(word.x * scale), int(word.y * scale)), (20, 20, 20)
    if hasattr(cv2, "FontFace"):
        face, weight = cv2.FontFace("sans"), 600 if word.bold else 400
        width = cv2.getTextSize((0, 0), word.text, (0, 0), face, size, weight)[2]
        at = (spot[0] - width, spot[1]) if word.right else spot
        cv2.putText(picture, word.text, at, ink, face, size, weight)
        return
    text, height = word.text.encode("ascii", "replace").decode(), size / 32
    thick = 2 if word.bold else 1
    width = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, height, thick)[0][0]
    at = (spot[0] - width, spot[1]) if word.right else spot
    cv2.putText(picture, text, at, cv2.FONT_HERSHEY_SIMPLEX, height, ink, thick, cv2.LINE_AA)


def _short(text: str, longest: int = _WORD_MAX) -> str:
    text = plain(text)
    return text if len(text) <= longest else f"{text[: longest - 1]}\u2026"
