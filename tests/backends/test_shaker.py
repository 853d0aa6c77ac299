"""A shaker stays where a hand has it: its sides lie flat on the pads, and a hand that holds it turns slowly."""

from __future__ import annotations

from math import hypot

import mujoco
import numpy as np
import pytest

import remac_env
from remac_env.backends.physics.backend import PhysicsBackend
from remac_env.generator import make
from remac_env.kitchen.objects import catalogue
from remac_env.kitchen.objects.colliders import add_colliders

SHAKERS = [category for category in catalogue.load().values() if category.seasons]

PAD = 0.0095
"""m, half of a pad's width: what is further off its middle is squeezed out."""


@pytest.mark.parametrize("category", SHAKERS, ids=lambda category: category.name)
def test_its_sides_are_flat_and_as_far_out_as_those_of_what_is_drawn(category: catalogue.Category) -> None:
    spec = mujoco.MjSpec()
    add_colliders(spec.worldbody.add_body(name="shaker"), category)
    model = spec.compile()
    boxes = [geom for geom in range(model.ngeom) if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_BOX]
    sides, radius = model.geom_size[boxes], category.body["radius"]
    assert len(boxes) == 4 and np.allclose(sides, sides[0])
    assert 0.95 * radius < sides[0, 0] < radius < hypot(*sides[0, :2]) < 1.07 * radius
    assert float(model.body("shaker").mass[0]) == pytest.approx(category.mass, abs=0.01)


@pytest.mark.long
def test_it_is_still_between_the_pads_when_an_oven_was_seasoned_into() -> None:
    env = remac_env.parallel_env(make(grade=2, seed=175058, template="physics", robots=2).spec, robots=2)
    env.reset(seed=175058)
    for pair in (
        ("navigate to carrot", "navigate to oven"), ("pick up carrot", "open oven door"),
        ("navigate to oven", "navigate to seasoning"), ("place to oven", "pick up seasoning"),
        ("navigate aside", "navigate to carrot"), ("wait", "season carrot"),
    ):
        infos = env.step({name: env.vocabulary.encode(text) for name, text in zip(env.agents, pair, strict=True)})[4]
        assert not any(info["outcome"]["reason"] for info in infos.values()), pair
    assert isinstance(env._backend, PhysicsBackend)
    simulation = env._backend._begun().simulation
    body, (finger, _) = simulation.data.body("seasoning"), simulation.robots["robot_1"].fingers
    pads = simulation.data.body(finger)
    aside = pads.xmat.reshape(3, 3).T @ (body.xpos - pads.xpos)
    upright = pads.xmat.reshape(3, 3).T @ body.xmat.reshape(3, 3)[:, 2]
    # The shaker's frame is at its foot: where its axis crosses the pads is what counts.
    assert abs(aside[0] - upright[0] / upright[2] * aside[2]) < PAD
