"""Pale objects on pale worktops stand out in side pictures."""

from __future__ import annotations

import cv2
import mujoco
import numpy as np
import pytest
from what_is_seen import contrasts

from remac_env.kitchen import layout as layouts
from remac_env.kitchen import style as styles
from remac_env.kitchen.builder import build_spec
from remac_env.kitchen.objects import catalogue
from remac_env.rendering import cameras, gl
from remac_env.rendering.rays import RayPainter
from remac_env.rendering.renderer import CLOSE, Renderer

SIZE = 256
LEAST_CONTRAST = 30.0
"""Mean distance (red, green, blue, 0..255) of an object's pixels from the mean colour around it."""

PALEST = ("garlic", "plate", "ramekin", "glass")
"""Of all categories those that stand out least from marble and pale granite."""


def contrast(picture: np.ndarray, mask: np.ndarray) -> float:
    """How far the pixels of an object, but for its outline, are from what lies around it."""
    bits, near, far = mask.astype(np.uint8), np.ones((3, 3)), np.ones((9, 9))
    ring = (cv2.dilate(bits, far) > 0) & (cv2.dilate(bits, near) == 0)
    return float(np.linalg.norm(picture[cv2.erode(bits, near) > 0] - picture[ring].mean(axis=0), axis=1).mean())


@pytest.mark.few(1)
@pytest.mark.parametrize("look", ["transitional_2", "modern_2", "coastal"])
def test_pale_things_stand_out_from_the_worktop(look: str) -> None:
    if gl.probe() is None:
        pytest.skip("no OpenGL platform works here: rays know mean colours only, not the line on a plate")
    style = styles.load(look)
    layout = layouts.load("one_wall_large", style.models)
    slot = next(slot for slot in layout.slots.values() if slot.fixture == "counter")
    spec = build_spec(layout, robots=[], objects={name: name for name in PALEST}, style=style, visual=True)
    cameras.add_cameras(spec, layout, [])
    model = spec.compile()
    data = mujoco.MjData(model)
    camera, found = model.camera(cameras.SIDE.format(station=slot.station)).id, {}
    painter = RayPainter(model, SIZE, SIZE, groups=CLOSE.groups)
    with Renderer(model, SIZE, SIZE, quality=CLOSE) as renderer:
        for name in PALEST:
            for other in PALEST:
                data.joint(other).qpos[:3] = (0, 0, -9)
            data.joint(name).qpos[:3] = np.array(layout.middle(slot.name)) + [0, 0, catalogue.get(name).rest_height]
            mujoco.mj_kinematics(model, data)
            mujoco.mj_camlight(model, data)
            hidden = painter._geom_colors()[0][:, 3] <= 0
            geoms = painter._cast(data, *painter._rays(data, camera), hidden)[0].reshape(SIZE, SIZE)
            mask = (model.geom_bodyid[geoms] == model.body(name).id) & (geoms >= 0)
            found[name] = contrast(renderer.render(data, camera).astype(float), mask)
    assert min(found.values()) >= LEAST_CONTRAST, found


LEAST_LAB = 12.0
"""The same in CIE Lab, of all objects wherever they may lie, as `benchmarks/what_is_seen.py` prints it."""

LEAST_SEEN = {"fish": "microwave", "pan": "stove", "kiwi": "cabinet", "sausage": "cabinet"}
"""Of all objects those that stood out least, and where."""


@pytest.mark.long
@pytest.mark.parametrize("look", styles.names())
def test_what_stands_out_least_can_be_told_from_what_it_lies_in(look: str) -> None:
    if gl.probe() is None:
        pytest.skip("no OpenGL platform works here")
    found = contrasts(look, names=LEAST_SEEN)
    assert all(found[where, name] >= LEAST_LAB for name, where in LEAST_SEEN.items()), found


def test_a_thing_of_the_colour_around_it_does_not_stand_out() -> None:
    picture, mask = np.full((32, 32, 3), 230.0), np.zeros((32, 32), bool)
    mask[10:20, 10:20] = True
    assert contrast(picture, mask) < LEAST_CONTRAST
    picture[mask] = (140.0, 90.0, 120.0)
    assert contrast(picture, mask) > LEAST_CONTRAST
