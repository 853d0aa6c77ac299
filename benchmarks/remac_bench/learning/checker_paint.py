"""Kitchens painted as no style has them, so that what is learnt in few styles holds in others.

Each surface has its finish from one of the styles, a little off its colours; fixtures are of the variants that these
styles have. What styles have in common - water, flames, lamps - stays as it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from remac_env.frozen import FrozenMap
from remac_env.kitchen import layout as layouts
from remac_env.kitchen import style as styles
from remac_env.kitchen.floor_plan import Layout
from remac_env.kitchen.style import Finish, Style
from remac_env.kitchen.textures import Color
from remac_env.kitchen.worlds import TaskWorlds
from remac_env.tasks.spec import TaskSpec

_BRIGHTER, _TINTED = 0.25, 0.1  # by which colours may be off, all of one together and each by itself


class PaintedWorlds(TaskWorlds):
    """Those of a task in one style, whatever style is asked for."""

    def __init__(self, spec: TaskSpec, style: Style) -> None:
        super().__init__(spec)
        self._style = style

    def layout(self, name: str, style: str) -> Layout:
        """A layout of the package with this style's variants of fixtures."""
        return layouts.load(name, self._style.models)


def painted(names: Sequence[str], chance: np.random.Generator) -> Style:
    """A mixture of these styles."""
    mixed = [styles.load(name) for name in names]

    def one() -> Style:
        return mixed[int(chance.integers(len(mixed)))]

    finishes = {role: one()[role] for role in mixed[0].finishes}
    differ = (role for role in finishes if any(style[role] != mixed[0][role] for style in mixed))
    finishes |= {role: _off(finishes[role], chance) for role in differ}
    kinds = sorted({kind for style in mixed for kind in style.models})
    models = FrozenMap({kind: found for kind in kinds if (found := one().models.get(kind)) is not None})
    return replace(
        one(), lamp=one().lamp, finishes=MappingProxyType(finishes), panel=one().panel, pull=one().pull, models=models
    )


def _off(finish: Finish, chance: np.random.Generator) -> Finish:
    light = 1.0 + float(chance.uniform(-_BRIGHTER, _BRIGHTER))
    tint = [1.0 + float(value) for value in chance.uniform(-_TINTED, _TINTED, 3)]

    def moved(color: Color) -> Color:
        red, green, blue = (min(1.0, part * light * each) for part, each in zip(color, tint, strict=True))
        return red, green, blue

    return replace(finish, color=moved(finish.color), accent=moved(finish.accent))
