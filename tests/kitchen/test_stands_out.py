"""Objects have colours by which they stand out from what they lie on, in every style: by the data, nothing is drawn."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import cv2
import numpy as np
import pytest

from remac_env.kitchen import style as styles
from remac_env.kitchen.mesh import Mesh
from remac_env.kitchen.objects import catalogue
from remac_env.kitchen.objects.part import DrawnPart
from remac_env.kitchen.objects.shapes import shape
from remac_env.kitchen.textures import texture

LEAST = 12.0
"""Mean distance in CIE Lab of an object's colours from the mean of what it lies on; about 2 can just be told apart."""

SURFACES = {
    "counter": "counter", "sink": "basin", "stove": "appliance_dark", "cabinet": "interior", "microwave": "cavity",
}  # fmt: skip
"""Kind of fixture -> the role of the finish that is around what lies there."""

_VIEW = np.array([0.38, -0.64, 0.67])
"""Towards the camera, a unit: as side cameras look on to worktops."""

_INSIDE = np.random.default_rng(1).dirichlet(np.ones(3), 6)
"""Points of a face, as shares of its corners."""

Parts = tuple[DrawnPart, ...]


def lab(colors: np.ndarray) -> np.ndarray:
    """Colours (n, 3) in 0..1 in CIE Lab."""
    found: np.ndarray = cv2.cvtColor(colors.astype(np.float32)[None], cv2.COLOR_RGB2LAB)[0]
    return found


def seen(parts: Parts) -> tuple[np.ndarray, np.ndarray]:
    """Colours (n, 3) in CIE Lab of what faces the camera, and how much of it each is (n,)."""
    colors, weights = [], []
    for part in parts:
        mesh: Mesh = part.mesh
        corners = mesh.vertices[mesh.faces]
        facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) @ _VIEW
        faces = mesh.faces[facing > 0]
        weights.append(np.repeat(facing[facing > 0], len(_INSIDE)))
        if part.picture is None or mesh.uv is None:
            colors.append(np.tile(part.finish.color, (len(weights[-1]), 1)))
            continue
        places = np.einsum("pc,fcx->fpx", _INSIDE, mesh.uv[faces]).reshape(-1, 2) % 1.0
        high, wide, _ = part.picture.shape
        colors.append(part.picture[(places[:, 1] * high).astype(int), (places[:, 0] * wide).astype(int)] / 255.0)
    return lab(np.concatenate(colors)), np.concatenate(weights)


@cache
def ground(style: str, role: str) -> np.ndarray:
    """The mean colour of a finish of a style, in CIE Lab."""
    finish = styles.load(style)[role]
    colors = np.array([finish.color])
    if finish.pattern:
        colors = finish.tint * texture(finish.pattern, 128, finish.color, finish.accent).reshape(-1, 3) / 255.0
    found: np.ndarray = lab(np.clip(colors.mean(axis=0, keepdims=True), 0.0, 1.0))[0]
    return found


def standing_out(parts: Parts, category: catalogue.Category) -> dict[tuple[str, str], float]:
    """How far an object's colours are from what is around it, by style and kind of fixture."""
    colors, weights = seen(parts)
    kinds = [kind for kind in SURFACES if kind not in category.too_big_for and (kind != "stove" or category.vessel)]
    return {
        (style, kind): float(weights @ np.linalg.norm(colors - ground(style, SURFACES[kind]), axis=1) / weights.sum())
        for style in styles.names()
        for kind in kinds
    }


@pytest.mark.parametrize("name", [name for name, category in catalogue.load().items() if category.look])
def test_an_object_stands_out_wherever_it_lies_in_every_style(name: str) -> None:
    category = catalogue.get(name)
    found = standing_out(shape(category.look), category)
    least = min(found, key=lambda key: found[key])
    assert found[least] >= LEAST, (least, round(found[least], 1))


def test_a_plate_all_white_and_an_egg_like_wood_do_not_stand_out() -> None:
    for name, color, kind in (("plate", (0.96, 0.96, 0.94), "counter"), ("egg", (0.84, 0.72, 0.54), "cabinet")):
        parts = shape(catalogue.get(name).look)
        plain = tuple(replace(each, picture=None, finish=replace(each.finish, color=color)) for each in parts)
        found = standing_out(plain, catalogue.get(name))
        assert min(far for (_, where), far in found.items() if where == kind) < LEAST
