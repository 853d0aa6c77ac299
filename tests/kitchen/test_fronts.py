"""Fronts of every variant can be drawn however narrow or low they are."""

from __future__ import annotations

import pytest

from remac_env.kitchen import layout as layouts
from remac_env.kitchen import style as styles
from remac_env.kitchen.builder import build_spec
from remac_env.kitchen.fixtures.fronts import THICKNESS, draw_front


class Paper:
    """A part that notes the boxes drawn on it and refuses those without an extent."""

    visual = True

    def __init__(self, panel: str, pull: str) -> None:
        self.fronts, self.boxes = (panel, pull), []

    def visual_box(self, low, high, material, **_) -> None:
        if min(b - a for a, b in zip(low, high, strict=True)) <= 0:
            raise ValueError(f"no extent: {low}, {high}")
        self.boxes.append((low, high))

    def visual_cylinder(self, *_, **__) -> None:
        pass

    visual_capsule = visual_cylinder


@pytest.mark.parametrize("panel", ["shaker", "slab", "raised", "beaded"])
@pytest.mark.parametrize(("wide", "high"), [(0.10, 0.10), (0.10, 0.70), (0.12, 0.30), (0.60, 0.12), (0.45, 0.70)])
def test_fronts_of_any_size(panel: str, wide: float, high: float) -> None:
    paper = Paper(panel, "bar")
    draw_front(paper, (0.0, wide), (0.0, high), 0.0, "front", handle="level")
    for low, top in paper.boxes:
        assert low[0] >= 0 and low[2] >= 0 and top[0] <= wide and top[2] <= high and top[1] <= THICKNESS + 1e-9


def test_a_wide_raised_panel_has_its_field() -> None:
    wide, narrow = Paper("raised", "bar"), Paper("raised", "bar")
    draw_front(wide, (0.0, 0.45), (0.0, 0.7), 0.0, "front")
    draw_front(narrow, (0.0, 0.12), (0.0, 0.7), 0.0, "front")
    assert len(wide.boxes) == len(narrow.boxes) + 1


@pytest.mark.long
@pytest.mark.parametrize("name", layouts.names())
def test_every_layout_is_drawn_in_every_style(name: str) -> None:
    for look in styles.names():
        style = styles.load(look)
        spec = build_spec(layouts.load(name, style.models), robots=[], objects={}, style=style, visual=True)
        assert len(spec.materials) > 10
