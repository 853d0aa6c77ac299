"""Numbers as cells of a table."""

from __future__ import annotations

from collections.abc import Mapping

from remac_bench.board import Cell
from remac_bench.judging.statistics import wilson
from remac_bench.prices import digits, dollars

DASH = Cell(text="-")
Cells = dict[str, Cell]


def percent(value: float | None, *, note: str = "", digits: int = 0) -> Cell:
    """A fraction as a percentage."""
    return DASH if value is None else Cell(text=f"{100 * value:.{digits}f}%", value=value, note=note)


def number(value: float | None, digits: int = 1, *, note: str = "") -> Cell:
    """A number with that many digits behind the point."""
    return DASH if value is None else Cell(text=f"{value:.{digits}f}", value=float(value), note=note)


def count(value: int | None, *, note: str = "") -> Cell:
    """A whole number."""
    return DASH if value is None else Cell(text=str(value), value=float(value), note=note)


def word(text: str, *, note: str = "") -> Cell:
    """Text that stands for itself."""
    return Cell(text=text, note=note)


def rate(successes: int, n: int, *, note: str = "") -> Cell:
    """A rate with Wilson's 95% interval; a dash of nothing."""
    if not n:
        return DASH
    low, high = wilson(successes, n)
    return Cell(text=f"{100 * successes / n:.0f}%", value=successes / n, low=low, high=high, note=note)


def interval(low: float | None, high: float | None) -> Cell:
    """The ends of an interval of a rate, in percent."""
    if low is None or high is None:
        return DASH
    return Cell(text=f"{100 * low:.0f}-{100 * high:.0f}%", low=low, high=high)


def signed_interval(low: float, high: float) -> Cell:
    """The ends of an interval of a difference, in percentage points."""
    return Cell(text=f"{100 * low:+.0f} to {100 * high:+.0f}", low=low, high=high)


def money(value: float | None, *, unpriced: int = 0) -> Cell:
    """US dollars; where calls have no known price there is no value, and the text says so.

    Args:
        value: of the calls whose price is known; None: nothing was measured, or no price is known.
        unpriced: calls without one.
    """
    if unpriced:
        text = dollars(value, unpriced).removeprefix("$")
        return Cell(text=text, note=f"{unpriced} calls without a known price are left out")
    return DASH if value is None else Cell(text=digits(value), value=value)


def probability(value: float) -> Cell:
    """A p value; below 0.001 its size alone matters."""
    return Cell(text="<0.001" if value < 0.001 else f"{value:.3f}", value=value)


def only_known(cells: Mapping[str, Cell]) -> Cells:
    """Without dashes: a key that is missing is one."""
    return {key: cell for key, cell in cells.items() if cell is not DASH}
