"""Kitchens in which skills are recorded and measured: those of the tasks' table, some of them kept for measuring."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from remac_bench.errors import UsageError
from remac_env.errors import check_choice
from remac_env.kitchen import layout as layouts
from remac_env.kitchen import style as styles
from remac_env.seeding import generator
from remac_env.tasks import BUILT_IN, get

HELD_OUT = ("galley", "g_shaped_small", "coastal", "modern_2", "transitional_1")
"""Layouts and styles that demonstrations leave out, so that what is learnt can be measured in them."""


@dataclass(frozen=True)
class Cells:
    """Styles and layouts of which a seed picks one each."""

    styles: tuple[str, ...]
    layouts: tuple[str, ...]

    def narrowed(self, style: str | None, layout: str | None) -> Cells:
        """These with one style or layout alone; raises UnknownNameError for one that is not among them."""
        for kind, name, known in (("style", style, self.styles), ("layout", layout, self.layouts)):
            if name is not None:
                check_choice(f"{kind} to learn in", name, known)
        return Cells((style,) if style else self.styles, (layout,) if layout else self.layouts)

    def of(self, seed: int, skill: str) -> tuple[str, str]:
        """The style and layout of a seed."""
        chance = generator(seed, "cell", skill)
        return str(chance.choice(self.styles)), str(chance.choice(self.layouts))


def cells(kind: str, held_out: Sequence[str]) -> tuple[Cells, Cells]:
    """The cells to learn in, and those held out.

    Args:
        kind: "table": the styles and layouts of the tasks' table; "all": every one there is.
        held_out: names of layouts and styles.

    Raises:
        UnknownNameError: for a name that is no layout or style, or another kind.
        UsageError: where nothing is left to learn in.
    """
    check_choice("cells", kind, ("table", "all"))
    specs = [spec for spec in map(get, BUILT_IN) if spec.in_table]
    every: list[Sequence[str]] = [styles.names(), layouts.names()]
    if kind == "table":
        every = [sorted({n for spec in specs for n in getattr(spec, part)}) for part in ("styles", "layouts")]
    for name in held_out:
        check_choice("layout or style", name, (*layouts.names(), *styles.names()))
    left = [tuple(name for name in names if name not in held_out) for names in every]
    # Where no style is held out, what is held out is measured in all of them, and layouts likewise.
    held = [tuple(name for name in names if name in held_out) or tuple(names) for names in every]
    seen, kept = Cells(*left), Cells(*held)
    if not seen.styles or not seen.layouts:
        raise UsageError(f"nothing is left to learn in without {', '.join(held_out)}; hold out less")
    return seen, kept
