"""Small plots: an interval in a cell, and success against money."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from remac_bench.board import Cell, Sheet
from remac_bench.columns import Footnotes
from remac_bench.metrics import ALL_TASKS

INTERVAL = 84.0
"""Width of an interval's plot from 0 to 1, in pixels."""

BOX = (720.0, 270.0)
"""Width and height of the plot of success against money."""

MARGINS = (66.0, 20.0, 20.0, 52.0)
"""Left, right, top, bottom."""

LETTER, LINE = 7.6, 15.0
"""Width of a letter of a name in that plot, and height of its line."""


@dataclass(frozen=True, kw_only=True)
class Interval:
    """A rate with its interval as x positions in 0..INTERVAL."""

    low: float
    value: float | None
    high: float


@dataclass(frozen=True, kw_only=True)
class Dot:
    """An entry of the plot. `label_y`: where its name stands, clear of the others'."""

    name: str
    agent: str
    x: float
    y: float
    low: float
    high: float
    label_x: float
    label_y: float
    side: str


@dataclass(frozen=True, kw_only=True)
class Scatter:
    """Success against `cost`, "money" or "time". `axis`: what x is; `note`: why, where it is not money, and long names.
    """

    key: str
    setting: str
    cost: str
    title: str
    axis: str
    note: str
    dots: tuple[Dot, ...]
    x_ticks: tuple[tuple[float, str], ...]
    y_ticks: tuple[tuple[float, str], ...]
    width: float = BOX[0]
    height: float = BOX[1]
    margins: tuple[float, float, float, float] = MARGINS


def interval(cell: Cell) -> Interval | None:
    """The plot of a rate's cell; None where it has no interval within 0..1."""
    if cell.low is None or cell.high is None or not 0 <= cell.low <= cell.high <= 1:
        return None
    inner = INTERVAL - 8
    value = None if cell.value is None else round(4 + inner * cell.value, 1)
    return Interval(low=round(4 + inner * cell.low, 1), value=value, high=round(4 + inner * cell.high, 1))


def scatter(sheet: Sheet) -> Scatter | None:
    """Success against money of a sheet of results: over all tasks, or of the one task there is.

    Where no entry is known to have spent any, against simulated time with failures at the cap. An entry whose cost
    is not known in full is left out of a plot of money, and the note says so.
    """
    tasks = list(dict.fromkeys(row["task"].text for row in sheet.rows))
    task = ALL_TASKS if ALL_TASKS in tasks else tasks[0] if tasks else ""
    rows = [row for row in sheet.rows if row["task"].text == task and row.get("tsr", Cell(text="-")).value is not None]
    paid = any(row["money"].value for row in rows if "money" in row)
    key = "money" if paid else "seconds_all"
    known = [row for row in rows if key in row and row[key].value is not None]
    if not known:
        return None
    axis = "US dollars a job" if paid else "simulated seconds an episode, failures at the cap"
    note = _scatter_note(rows, paid=paid)
    top = max(row[key].value or 0.0 for row in known)
    marks = _ticks(top)
    points = [(row["agent"].text, row[key].value or 0.0, row["tsr"]) for row in known]
    notes = Footnotes()
    dots = tuple(_dots(points, marks[-1], notes))
    return Scatter(
        key=sheet.key,
        setting=sheet.facts[0].get("setting", "") if sheet.facts else "",
        cost="money" if paid else "time",
        title=f"Success against {'money' if paid else 'time'}: {task}",
        axis=axis,
        note=" ".join([note, *(line.plain for line in notes.told())]).strip(),
        dots=dots,
        x_ticks=tuple((_x(mark, marks[-1]), f"{mark:g}") for mark in marks),
        y_ticks=tuple((_y(share / 4), f"{25 * share}%") for share in range(5)),
    )


def _scatter_note(rows: Sequence[Mapping[str, Cell]], *, paid: bool) -> str:
    unknown = [row["agent"].text for row in rows if "money" in row and row["money"].value is None]
    told = f"The cost of {', '.join(unknown)} is not known in full" if unknown else ""
    if paid:
        return f"{told}: left out." if told else ""
    told = told or "No entry spent money on a language model"
    return f"{told}, so time stands in its place."


def _dots(points: Sequence[tuple[str, float, Cell]], most: float, notes: Footnotes) -> list[Dot]:
    """Names stand beside their dots where no other dot is, one under the other where they would overlap; long ones as
    numbers of notes."""
    dots: list[Dot] = []
    taken: list[tuple[float, float, float]] = []
    places = [_x(cost, most) for _, cost, _ in points]
    for name, cost, cell in sorted(points, key=lambda point: (-(point[2].value or 0.0), point[1])):
        short = notes.short(name)
        x, y, width = _x(cost, most), _y(cell.value or 0.0), LETTER * len(short) + 9
        room = x + width < BOX[0] - MARGINS[1]
        right = room and (x - width < MARGINS[0] or not any(0 < other - x < width for other in places))
        left, label = (x if right else x - width), y + (LINE if y < BOX[1] / 2 else -8)
        while any(abs(label - line) < LINE - 1 and left < end and begin < left + width for begin, end, line in taken):
            label += LINE if y < BOX[1] / 2 else -LINE
        taken.append((left, left + width, label))
        dots.append(
            Dot(
                name=short,
                agent=name,
                x=x,
                y=y,
                low=_y(cell.low or 0.0),
                high=_y(cell.high if cell.high is not None else 1.0),
                label_x=x + 9 if right else x - 9,
                label_y=label,
                side="start" if right else "end",
            )
        )
    return dots


def _x(value: float, most: float) -> float:
    return round(MARGINS[0] + (BOX[0] - MARGINS[0] - MARGINS[1]) * value / most, 1)


def _y(share: float) -> float:
    return round(BOX[1] - MARGINS[3] - (BOX[1] - MARGINS[2] - MARGINS[3]) * share, 1)


def _ticks(top: float) -> list[float]:
    """From 0 in round steps to at least the top."""
    if top <= 0:
        return [0.0, 1.0]
    size = 10.0 ** math.floor(math.log10(top / 5))
    step = size * next(each for each in (1, 2, 5, 10) if top / (size * each) <= 5.0)
    return [round(number * step, 12) for number in range(math.ceil(top / step - 1e-9) + 1)]
